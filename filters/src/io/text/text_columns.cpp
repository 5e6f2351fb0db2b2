// SPDX-License-Identifier: BSD-3-Clause
// Which column is what: by the names that programs write, or by the numbers.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "io/point_formats.h"
#include "io/text/text.h"

namespace pcl_slim {

std::string plainColumnName(const std::string& written) {
  std::string name;
  for (const char c : written.substr(0, written.find_first_of("[("))) {
    const auto byte = static_cast<unsigned char>(c);
    name += byte <= ' ' ? '_' : static_cast<char>(std::tolower(byte));
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  return name.empty() ? "column" : name;
}

namespace {

using Names = std::vector<std::string>;

/** A field and the names that columns of its values have in other programs' files, the likeliest first. */
struct Known {
  const char* field;
  std::initializer_list<const char*> written;
};

// Columns like "points:0" are ParaView's, point_x is of geographic information systems.
const Known kPlaces[] = {
    {"x",
     {"x", "easting", "east", "point_x", "points:0", "points_0", "x_coord", "coord_x", "xcoord",
      "x_coordinate", "pos_x", "position_x", "utm_x", "px", "rechtswert"}},
    {"y",
     {"y", "northing", "north", "point_y", "points:1", "points_1", "y_coord", "coord_y", "ycoord",
      "y_coordinate", "pos_y", "position_y", "utm_y", "py", "hochwert"}},
    {"z",
     {"z",          "elevation", "elev",    "height",      "altitude", "alt",          "point_z",
      "points:2",   "points_2",  "z_coord", "coord_z",     "zcoord",   "z_coordinate", "pos_z",
      "position_z", "utm_z",     "pz",      "h\xc3\xb6he", "h\xf6he",  "hoehe",        "up",
      "h",          "u"}}};
const Known kDegrees[] = {{"x", {"longitude", "lon", "long", "lng"}}, {"y", {"latitude", "lat"}}};
const Known kLetters[] = {{"x", {"e"}}, {"y", {"n"}}};
const Known kOthers[] = {
    {"red", {"r", "rf", "color_r", "colors:0", "rgb:0"}},
    {"green", {"g", "gf", "color_g", "colors:1", "rgb:1"}},
    {"blue", {"b", "bf", "color_b", "colors:2", "rgb:2"}},
    {"alpha", {"a"}},
    {"normal_x", {"nx", "normalx", "n_x", "normals:0", "normal:0", "normals_0"}},
    {"normal_y", {"ny", "normaly", "n_y", "normals:1", "normal:1", "normals_1"}},
    {"normal_z", {"nz", "normalz", "n_z", "normals:2", "normal:2", "normals_2"}},
    {"intensity", {"i"}}};

bool has(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/** Gives a column the name of the field, unless one has it. false: there is none. */
bool adopt(const Known& known, Names& names) {
  if (has(names, known.field)) return true;
  for (const char* written : known.written) {
    const auto at = std::find(names.begin(), names.end(), written);
    if (at == names.end()) continue;
    *at = known.field;
    return true;
  }
  return false;
}

/** The same of a pair: both, or none. */
bool adoptPair(const Known (&pair)[2], Names& names) {
  Names made = names;
  if (has(names, "x") || has(names, "y") || !adopt(pair[0], made) || !adopt(pair[1], made))
    return false;
  names = std::move(made);
  return true;
}

/** Gives the columns of places their fields' names. \param[out] degrees whether they are longitude and
 * latitude. */
bool adoptPlaces(Names& names, bool& degrees) {
  Names made = names;
  if (adopt(kPlaces[0], made) && adopt(kPlaces[1], made)) names = std::move(made);
  adoptPair(kLetters, names);
  degrees = adoptPair(kDegrees, names);
  adopt(kPlaces[2], names);
  return has(names, "x") && has(names, "y") && has(names, "z");
}

/** Gives columns of one name different ones. */
void makeUnique(Names& names) {
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::string name = names[k];
    const auto before = names.begin() + static_cast<std::ptrdiff_t>(k);
    for (int copy = 2; !name.empty() && std::find(names.begin(), before, names[k]) != before;
         ++copy)
      names[k] = name + "_" + std::to_string(copy);
  }
}

Result<FieldNames> knownNames(const TextTable& table) {
  FieldNames made;
  Names numbers;  // a column of text is no coordinate
  std::string written;
  for (std::size_t k = 0; k < table.columns.size(); ++k) {
    const TextColumn& column = table.columns[k];
    const bool left_out = column.name == "-" || (k == 0 && table.row_names);
    made.names.push_back(left_out ? "" : plainColumnName(column.name));
    written += (k == 0 ? "" : ", ") + column.name;
    numbers.push_back(column.numeric ? made.names[k] : "");
  }
  const bool placed = adoptPlaces(numbers, made.degrees);
  if (!placed) {
    return badInput("its columns are named " + written.substr(0, 200) +
                    "; name three of numbers x, y and z, or say what they are: -columns x,y,z,...");
  }
  for (const Known& known : kOthers) adopt(known, numbers);
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    if (!numbers[k].empty()) made.names[k] = numbers[k];
  }
  makeUnique(made.names);
  return made;
}

}  // namespace

bool namePlaces(const std::vector<std::string>& written) {
  Names names;
  for (const std::string& name : written) names.push_back(plainColumnName(name));
  bool degrees = false;
  return adoptPlaces(names, degrees);
}

namespace {

constexpr std::size_t kSample = 1000;  ///< rows that decide what a column is

/** Columns of numbers that have no names, without those that are left out. */
class NumberColumns {
 public:
  explicit NumberColumns(const TextTable& table) : table_(table) {
    for (std::size_t k = 0; k < table.columns.size(); ++k) {
      if (table.columns[k].numeric) used_.push_back(k);
    }
    step_ = std::max<std::size_t>(1, table.rows() / kSample);
  }

  std::size_t size() const { return used_.size(); }
  std::size_t place(std::size_t k) const { return used_[k]; }
  void dropFirst() { used_.erase(used_.begin()); }

  /** Whether the first column counts the points: it ascends, nearly always by 1. */
  bool countsRows() const {
    constexpr std::size_t kLeastRows = 5;
    constexpr double kLeastSteps = 0.9;  // lists from which points were deleted have gaps
    const std::size_t rows = table_.rows();
    if (size() < 4 || used_[0] != 0 || !at(0).whole || rows < kLeastRows) return false;
    std::size_t ones = 0;
    for (std::size_t row = 1; row < rows; ++row) {
      const double step = table_.at(row, 0) - table_.at(row - 1, 0);
      if (!(step >= 1)) return false;
      ones += step == 1;
    }
    return at(0).least >= 0 &&
           static_cast<double>(ones) >= kLeastSteps * static_cast<double>(rows - 1);
  }

  /** Whether three columns are unit vectors, or zero, in a sample of the rows. */
  bool areNormals(std::size_t first) const {
    constexpr double kTolerance = 0.02;  // of the length: three decimals and their rounding
    if (first + 3 > size()) return false;
    std::size_t unit = 0, others = 0;
    for (std::size_t row = 0; row < table_.rows(); row += step_) {
      const double length =
          std::hypot(value(row, first), value(row, first + 1), value(row, first + 2));
      if (std::abs(length - 1.0) < kTolerance)
        ++unit;
      else if (length != 0.0 && std::isfinite(length))
        ++others;
    }
    return unit > 0 && others == 0;
  }

  /** Whether three columns are whole numbers from 0 to 255, or fractions from 0 to 1. */
  bool areColors(std::size_t first) const {
    if (first + 3 > size()) return false;
    bool whole = true;
    double least = 0, most = 0;
    for (std::size_t k = first; k < first + 3; ++k) {
      whole = whole && at(k).whole;
      least = std::min(least, at(k).least);
      most = std::max(most, at(k).most);
    }
    return least >= 0 && (whole ? most <= 255 : most <= 1);
  }

  /** Of four columns, of which either the first three or the last three may be colours: whether the last
   * one varies with those between clearly less than the first, as an intensity or a label does. */
  bool lastIsNoColor(std::size_t first) const {
    constexpr std::size_t kLeastRows = 20;
    constexpr double kClearly = 0.2;
    return table_.rows() >= kLeastRows &&
           correlation(first, first + 1) > correlation(first + 3, first + 1) + kClearly;
  }

 private:
  const TextColumn& at(std::size_t k) const { return table_.columns[used_[k]]; }
  double value(std::size_t row, std::size_t k) const { return table_.at(row, used_[k]); }

  /** Of one column with the sum of two; 0 where either is constant. */
  double correlation(std::size_t k, std::size_t pair) const {
    double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    for (std::size_t row = 0; row < table_.rows(); row += step_) {
      const double u = value(row, k), v = value(row, pair) + value(row, pair + 1);
      if (!std::isfinite(u) || !std::isfinite(v)) continue;
      n += 1;
      a += u;
      b += v;
      aa += u * u;
      bb += v * v;
      ab += u * v;
    }
    const double spread = (n * aa - a * a) * (n * bb - b * b);
    return spread > 0 ? (n * ab - a * b) / std::sqrt(spread) : 0;
  }

  const TextTable& table_;
  std::vector<std::size_t> used_;
  std::size_t step_ = 1;
};

FieldNames guessedNames(const TextTable& table, NumberColumns& numbers, bool intensity_first) {
  FieldNames made;
  made.numbers_rows = numbers.countsRows();
  if (made.numbers_rows) numbers.dropFirst();
  Names names = {"x", "y", "z"};
  const auto add = [&names](std::initializer_list<const char*> more) {
    names.insert(names.end(), more.begin(), more.end());
  };
  while (names.size() < numbers.size()) {
    const std::size_t k = names.size();
    const bool has_intensity = has(names, "intensity"), has_colors = has(names, "red");
    const bool colors = !has_colors && numbers.areColors(k);
    const bool colors_behind = !has_colors && !has_intensity && numbers.areColors(k + 1);
    const bool colors_first = colors && colors_behind && !intensity_first &&
                              (numbers.areNormals(k + 3) || numbers.lastIsNoColor(k));
    if (!has(names, "normal_x") && numbers.areNormals(k))
      add({"normal_x", "normal_y", "normal_z"});
    else if (colors_behind && !colors_first)
      add({"intensity"});
    else if (colors)
      add({"red", "green", "blue"});
    else if (!has_intensity)
      add({"intensity"});
    else
      names.push_back("column_" + std::to_string(numbers.place(k) + 1));
  }
  made.names.resize(table.columns.size());
  for (std::size_t k = 0; k < names.size(); ++k) made.names[numbers.place(k)] = names[k];
  return made;
}

}  // namespace

Result<FieldNames> fieldNames(const TextTable& table, bool intensity_first) {
  if (table.named_by != ColumnNames::kNobody) return knownNames(table);
  NumberColumns numbers(table);
  if (numbers.size() < 3)
    return badInput("its lines have fewer than 3 numbers: give x, y and z of a point");
  return guessedNames(table, numbers, intensity_first);
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "io/ply_file.h"
#include "io/point_formats.h"
#include "io/text_file.h"

namespace pcl_slim {

namespace {

constexpr int kMostDecimals = 40;  ///< a float with more has them all or is zero

/** Half a unit of the last decimal. */
double halfUnit(int decimals) {
  static const auto table = [] {
    struct {
      double of[kMostDecimals + 1];
    } made{};
    for (int k = 0; k <= kMostDecimals; ++k) made.of[k] = 0.5 * std::pow(10.0, -k);
    return made;
  }();
  return table.of[std::clamp(decimals, 0, kMostDecimals)];
}

/** Digits behind the point, less the exponent. */
int decimalsOf(const char* begin, const char* end) {
  const char* point = std::find(begin, end, '.');
  const char* power = std::find_if(begin, end, [](char c) { return c == 'e' || c == 'E'; });
  const auto digits = point < power ? static_cast<int>(power - point) - 1 : 0;
  if (power == end) return digits;
  int exponent = 0;
  const char* from = power + 1;
  if (from != end && *from == '+') ++from;
  std::from_chars(from, end, exponent);
  return digits - std::clamp(exponent, -400, 400);
}

constexpr std::size_t kMostColumns = 4096;

using Word = std::pair<const char*, const char*>;

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

Word trimmed(const char* begin, const char* end) {
  while (begin != end && isBlank(*begin)) ++begin;
  while (begin != end && isBlank(end[-1])) --end;
  if (end - begin > 1 && *begin == '"' && end[-1] == '"') return {begin + 1, end - 1};
  return {begin, end};
}

bool isNumber(const Word& word) {
  double value = 0;
  bool in_float = false;
  return parseDecimal(word.first, word.second, value, in_float);
}

/** Names of columns do not start as numbers do. */
bool startsNumber(const Word& word) {
  return word.first != word.second && std::strchr("+-.0123456789", *word.first) != nullptr;
}

std::string textOf(const Word& word) {
  constexpr std::ptrdiff_t kMost = 40;
  return {word.first, word.first + std::min(kMost, word.second - word.first)};
}

class TableReader {
 public:
  explicit TableReader(const std::vector<unsigned char>& bytes)
      : at_(reinterpret_cast<const char*>(bytes.data())),
        end_(at_ + bytes.size()),
        line_end_(lineEndOf(at_, end_)) {
    if (bytes.size() >= 3 && std::memcmp(at_, "\xef\xbb\xbf", 3) == 0) at_ += 3;
  }

  Result<TextTable> read() {
    if (std::memchr(at_, 0, static_cast<std::size_t>(end_ - at_)))
      return badInput(
          "it is no text: it holds bytes of 0; name a file of the format that its "
          "extension says");
    while (at_ != end_) {
      const char* stop = static_cast<const char*>(
          std::memchr(at_, line_end_, static_cast<std::size_t>(end_ - at_)));
      const Word line = trimmed(at_, stop ? stop : end_);
      at_ = stop ? stop + 1 : end_;
      ++line_;
      if (line.first == line.second) continue;
      if (Error error = takeLine(line)) return error;
    }
    if (table_.columns.empty()) return badInput("it has no points: give one a line, as x y z");
    if (expected_.value_or(0) > table_.rows()) {
      return badInput("the file is truncated: " + std::to_string(table_.rows()) + " of " +
                      std::to_string(*expected_) + " points; copy it again");
    }
    return std::move(table_);
  }

 private:
  static bool isComment(const Word& line) {
    const char c = *line.first;
    const bool slashes = line.second - line.first > 1 && c == '/' && line.first[1] == '/';
    return c == '#' || c == '%' || slashes;
  }

  Error takeLine(const Word& line) {
    if (isComment(line)) {
      takeComment(line);
      return {};
    }
    if (!begun_) chooseSeparator(line);
    split(line);
    if (words_.empty()) return {};  // nothing but blanks between quotes
    if (words_.size() == 1 && takeCount(words_[0])) return {};
    if (!begun_) {
      begun_ = true;
      if (!isNumber(words_[0])) {
        if (startsNumber(words_[0])) return noNumber(words_[0]);
        names_.clear();
        for (const Word& word : words_) names_.push_back(textOf(word));
        return {};
      }
    }
    if (table_.columns.empty()) {
      if (Error error = beginRows()) return error;
    }
    if (expected_ && table_.rows() >= *expected_) {
      return badInput("line " + std::to_string(line_) + " is one point more than the " +
                      std::to_string(*expected_) +
                      " that a line before announces; correct that number, or copy the file again");
    }
    return takeRow();
  }

  void takeComment(const Word& line) {
    const char* from = line.first;
    while (from != line.second && (*from == '#' || *from == '/' || *from == '%' || isBlank(*from)))
      ++from;
    table_.comments.emplace_back(from, line.second);
    if (!table_.columns.empty() || from == line.second) return;
    chooseSeparator({from, line.second});
    split({from, line.second});
    std::vector<std::string> names;
    for (const Word& word : words_) names.push_back(textOf(word));
    const auto has = [&names](char low, char high) {
      return std::any_of(names.begin(), names.end(), [=](const std::string& name) {
        return name.size() == 1 && (name[0] == low || name[0] == high);
      });
    };
    if (has('x', 'X') && has('y', 'Y') && has('z', 'Z')) names_ = names;
  }

  void chooseSeparator(const Word& line) {
    for (const char separator : {';', ','}) {
      separator_ = separator;
      if (std::find(line.first, line.second, separator) != line.second) return;
    }
    separator_ = ' ';
  }

  void split(const Word& line) {
    words_.clear();
    const char* at = line.first;
    while (at != line.second) {
      const auto ends = [this](char c) { return separator_ == ' ' ? isBlank(c) : c == separator_; };
      const char* stop = std::find_if(at, line.second, ends);
      if (separator_ != ' ' || stop != at) words_.push_back(trimmed(at, stop));
      at = stop == line.second ? stop : stop + 1;
    }
    // A separator at the end is followed by an empty field only where one is missing.
    const std::size_t wanted = std::max(table_.columns.size(), names_.size());
    if (separator_ != ' ' && line.second[-1] == separator_ && words_.size() < wanted)
      words_.emplace_back(line.second, line.second);
  }

  /** A line with the number of rows that follow. */
  bool takeCount(const Word& word) {
    double count = 0;
    bool in_float = false;
    if (!parseDecimal(word.first, word.second, count, in_float)) return false;
    if (!(count >= 0 && count < 1e15 && count == std::floor(count))) return false;
    expected_ = table_.rows() + static_cast<std::size_t>(count);
    return true;
  }

  Error beginRows() {
    if (words_.size() > kMostColumns)
      return badInput("line " + std::to_string(line_) + " has more than 4096 columns; split them");
    table_.columns.resize(words_.size());
    table_.named = names_.size() == words_.size();
    if (!table_.named && !names_.empty()) {
      return badInput("line " + std::to_string(line_) + " has " + std::to_string(words_.size()) +
                      " columns where " + std::to_string(names_.size()) + " are named; mend it");
    }
    for (std::size_t k = 0; k < words_.size(); ++k) {
      if (table_.named) table_.columns[k].name = names_[k];
      const bool empty = words_[k].first == words_[k].second;
      table_.columns[k].numeric = !table_.named || empty || isNumber(words_[k]);
    }
    first_row_ = line_;
    return {};
  }

  Error takeRow() {
    if (words_.size() != table_.columns.size()) {
      return badInput("line " + std::to_string(line_) + " has " + std::to_string(words_.size()) +
                      " columns, line " + std::to_string(first_row_) + " has " +
                      std::to_string(table_.columns.size()) + "; mend it");
    }
    for (std::size_t k = 0; k < words_.size(); ++k) {
      TextColumn& column = table_.columns[k];
      double value = std::numeric_limits<double>::quiet_NaN();
      const auto [begin, end] = words_[k];
      if (column.numeric && begin != end && !parseDecimal(begin, end, value, column.in_float)) {
        return noNumber(words_[k]);
      }
      note(value, column);
      table_.values.push_back(value);
    }
    return {};
  }

  Error noNumber(const Word& word) const {
    return badInput("line " + std::to_string(line_) + ": '" + textOf(word) +
                    "' is no number; mend it (decimals have a point)");
  }

  static void note(double value, TextColumn& column) {
    if (!std::isfinite(value)) return;
    column.whole = column.whole && value == std::floor(value);
    column.least = std::min(column.least, value);
    column.most = std::max(column.most, value);
  }

  const char* at_;
  const char* end_;
  char line_end_;
  char separator_ = ' ';
  bool begun_ = false;
  std::size_t line_ = 0, first_row_ = 0;
  std::optional<std::size_t> expected_;  ///< rows, after the last line with their number
  std::vector<std::string> names_;
  std::vector<Word> words_;
  TextTable table_;
};

}  // namespace

bool parseDecimal(const char* begin, const char* end, double& value, bool& in_float) {
  if (begin != end && *begin == '+') ++begin;
  const auto [stop, code] = std::from_chars(begin, end, value);
  if (code == std::errc::result_out_of_range) {  // beyond doubles: infinite, or zero
    if (stop != end) return false;
    value = decimalsOf(begin, end) > 0 ? 0.0 : std::numeric_limits<double>::infinity();
    return true;
  }
  if (code != std::errc() || stop != end || begin == end) return false;
  if (!in_float || !std::isfinite(value)) return true;
  const auto narrow = static_cast<float>(value);
  in_float = std::abs(narrow - value) < halfUnit(decimalsOf(begin, end));
  return true;
}

Result<TextTable> parseTextTable(const std::vector<unsigned char>& bytes) {
  return TableReader(bytes).read();
}

namespace {

struct Alias {
  const char *written, *name;
};

constexpr Alias kAliases[] = {
    {"easting", "x"},        {"northing", "y"},       {"elevation", "z"},
    {"height", "z"},         {"altitude", "z"},       {"r", "red"},
    {"g", "green"},          {"b", "blue"},           {"a", "alpha"},
    {"nx", "normal_x"},      {"ny", "normal_y"},      {"nz", "normal_z"},
    {"normalx", "normal_x"}, {"normaly", "normal_y"}, {"normalz", "normal_z"},
    {"i", "intensity"}};

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/** Gives columns of one name different ones. */
void makeUnique(std::vector<std::string>& names) {
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::string name = names[k];
    const auto before = names.begin() + static_cast<std::ptrdiff_t>(k);
    for (int copy = 2; std::find(names.begin(), before, names[k]) != before; ++copy)
      names[k] = name + "_" + std::to_string(copy);
  }
}

Result<std::vector<std::string>> knownNames(const TextTable& table) {
  std::vector<std::string> names;
  std::string written;
  for (const TextColumn& column : table.columns) {
    names.push_back(plainColumnName(column.name));
    written += (written.empty() ? "" : ", ") + column.name;
  }
  for (const Alias& alias : kAliases) {
    const auto at = std::find(names.begin(), names.end(), alias.written);
    if (at != names.end() && !has(names, alias.name)) *at = alias.name;
  }
  makeUnique(names);
  for (const char* axis : {"x", "y", "z"}) {
    const auto at = std::find(names.begin(), names.end(), axis);
    if (at == names.end() || !table.columns[static_cast<std::size_t>(at - names.begin())].numeric)
      return badInput("its columns are named " + written.substr(0, 200) +
                      "; name three of numbers x, y and z");
  }
  return names;
}

/** Whether three columns are unit vectors, or zero, in a sample of the rows. */
bool areNormals(const TextTable& table, std::size_t first) {
  constexpr std::size_t kSample = 1000;
  constexpr double kTolerance = 0.02;  // of the length: three decimals and their rounding
  if (first + 3 > table.columns.size()) return false;
  const std::size_t step = std::max<std::size_t>(1, table.rows() / kSample);
  std::size_t unit = 0, others = 0;
  for (std::size_t row = 0; row < table.rows(); row += step) {
    const double length =
        std::hypot(table.at(row, first), table.at(row, first + 1), table.at(row, first + 2));
    if (std::abs(length - 1.0) < kTolerance)
      ++unit;
    else if (length != 0.0 && std::isfinite(length))
      ++others;
  }
  return unit > 0 && others == 0;
}

bool areColors(const TextTable& table, std::size_t first) {
  if (first + 3 > table.columns.size()) return false;
  for (std::size_t k = first; k < first + 3; ++k) {
    const TextColumn& column = table.columns[k];
    if (!column.whole || !(column.least >= 0 && column.most <= 255)) return false;
  }
  return true;
}

std::vector<std::string> guessedNames(const TextTable& table, bool intensity_first) {
  const std::size_t count = table.columns.size();
  std::vector<std::string> names = {"x", "y", "z"};
  const auto add = [&names](std::initializer_list<const char*> more) {
    names.insert(names.end(), more.begin(), more.end());
  };
  while (names.size() < count) {
    const std::size_t k = names.size();
    const bool has_intensity = has(names, "intensity");
    if (!has(names, "normal_x") && areNormals(table, k))
      add({"normal_x", "normal_y", "normal_z"});
    else if (intensity_first && !has_intensity && areColors(table, k + 1))
      add({"intensity"});
    else if (!has(names, "red") && areColors(table, k))
      add({"red", "green", "blue"});
    else if (!has_intensity)
      add({"intensity"});
    else
      names.push_back("column_" + std::to_string(k + 1));
  }
  return names;
}

}  // namespace

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

/** Names of fields for a table's columns: x y z, normal_x normal_y normal_z, red green blue alpha,
 * intensity where they are such, others as the file names them or column_4 and so on.
 *
 * With names in the file: those of common programs are known, in any case and with units in
 * brackets. Without: x y z come first; behind them three columns of unit length are normals, three
 * of whole numbers from 0 to 255 are colours, and one more is the intensity. \param[in]
 * intensity_first of four columns that may be colours and an intensity, as in .pts files. \return
 * an error for a table without x y z. */
Result<std::vector<std::string>> columnNames(const TextTable& table, bool intensity_first) {
  if (table.named) return knownNames(table);
  if (table.columns.size() < 3)
    return badInput("its lines have fewer than 3 numbers: give x, y and z of a point");
  return guessedNames(table, intensity_first);
}

bool isChannel(const std::string& name) {
  return name == "red" || name == "green" || name == "blue" || name == "alpha";
}

/** Bytes of colours are bytes, larger whole numbers 16 bits, others as other numbers. */
std::uint8_t colorType(const TextTable& table, const std::vector<std::string>& names) {
  double most = 0;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const TextColumn& column = table.columns[k];
    if (!isChannel(names[k])) continue;
    if (!column.whole || column.least < 0) return 0;
    most = std::max(most, column.most);
  }
  return most <= 255     ? std::uint8_t{kUInt8}
         : most <= 65535 ? std::uint8_t{kUInt16}
                         : std::uint8_t{0};
}

/** Types of the columns, 0 for those that are left out. */
std::vector<std::uint8_t> columnTypes(const TextTable& table,
                                      const std::vector<std::string>& names) {
  const auto realType = [](bool in_float) {
    return in_float ? std::uint8_t{kFloat32} : std::uint8_t{kFloat64};
  };
  const std::uint8_t color = colorType(table, names);
  bool near = true;  // the three coordinates are of one type
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (names[k] == "x" || names[k] == "y" || names[k] == "z") near &= table.columns[k].in_float;
  }
  std::vector<std::uint8_t> types;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::string& name = names[k];
    if (!table.columns[k].numeric)
      types.push_back(0);
    else if (name == "x" || name == "y" || name == "z")
      types.push_back(realType(near));
    else if (name.rfind("normal_", 0) == 0)
      types.push_back(kFloat32);
    else if (isChannel(name) && color != 0)
      types.push_back(color);
    else
      types.push_back(realType(table.columns[k].in_float));
  }
  return types;
}

void store(double value, std::uint8_t type, std::uint8_t* at) {
  const auto put = [at](auto number) { std::memcpy(at, &number, sizeof(number)); };
  if (type == kFloat64) return put(value);
  if (type == kFloat32) return put(static_cast<float>(value));
  const double number = std::isfinite(value) ? value : 0.0;  // an empty field of a colour
  if (type == kUInt16) return put(static_cast<std::uint16_t>(number));
  put(static_cast<std::uint8_t>(number));
}

}  // namespace

Result<PointFile> parseText(const std::vector<unsigned char>& bytes, bool pts) {
  const Result<TextTable> table = parseTextTable(bytes);
  if (!table) return table.error();
  const Result<std::vector<std::string>> names = columnNames(*table, pts);
  if (!names) return names.error();
  const std::vector<std::uint8_t> types = columnTypes(*table, *names);
  PointFile file;
  file.comments = table->comments;
  for (std::size_t k = 0; k < names->size(); ++k) {
    file.columns += (k == 0 ? "" : " ") + (*names)[k];
    if (types[k] == 0)
      file.left_out.push_back("'" + (*names)[k] + "', a column of text,");
    else
      addField(file.cloud, (*names)[k], types[k]);
  }
  file.columns += table->named ? ", as the file names them" : ", guessed from the numbers";
  PointTable& cloud = file.cloud;
  const std::size_t n = table->rows();
  if (n > 0xfffffffeu) return badInput("the file has more than 2^32 - 2 points; split it");
  cloud.resize(n);
  std::uint8_t* at = cloud.data.data();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < types.size(); ++k) {
      if (types[k] == 0) continue;
      store(table->at(i, k), types[k], at);
      at += scalarSize(types[k]);
    }
  }
  adoptPclFields(cloud);
  return file;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// From a table of numbers to points.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

#include "io/ply_file.h"
#include "io/point_formats.h"
#include "io/text/text.h"

namespace pcl_slim {

namespace {

bool isChannel(const std::string& name) {
  return name == "red" || name == "green" || name == "blue" || name == "alpha";
}

/** How colours are stored: type 0 as other numbers are. */
struct ColorStorage {
  std::uint8_t type = 0;
  double scale = 1;  ///< of the file's numbers
};

/** Whether fractions are bytes divided by 255, as written with three decimals or more. */
bool areBytes(const TextTable& table, std::size_t column) {
  constexpr double kRounding = 0.15;  // 255 times half a unit of the third decimal
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double byte = 255 * table.at(row, column);
    if (std::isfinite(byte) && std::abs(byte - std::round(byte)) > kRounding) return false;
  }
  return true;
}

/** Bytes of colours are bytes, larger whole numbers 16 bits, fractions of 255 bytes. */
ColorStorage colorStorage(const TextTable& table, const std::vector<std::string>& names) {
  double most = 0;
  bool whole = true, bytes = true;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const TextColumn& column = table.columns[k];
    if (!isChannel(names[k]) || !column.numeric) continue;
    if (column.least < 0) return {};
    whole = whole && column.whole;
    most = std::max(most, column.most);
  }
  if (whole) {
    if (most <= 255) return {kUInt8};
    return most <= 65535 ? ColorStorage{kUInt16} : ColorStorage{};
  }
  if (most > 1) return {};
  for (std::size_t k = 0; k < names.size() && bytes; ++k)
    bytes = !isChannel(names[k]) || !table.columns[k].numeric || areBytes(table, k);
  return bytes ? ColorStorage{kUInt8, 255} : ColorStorage{};
}

bool isPlace(const std::string& name) {
  return name == "x" || name == "y" || name == "z";
}

/** A column that becomes a field. */
struct Source {
  std::size_t column = 0;
  std::uint8_t type = 0;
  double scale = 1;
};

std::vector<Source> fieldSources(const TextTable& table, const std::vector<std::string>& names) {
  const auto realType = [](bool in_float) {
    return in_float ? std::uint8_t{kFloat32} : std::uint8_t{kFloat64};
  };
  const ColorStorage color = colorStorage(table, names);
  bool near = true;  // the three coordinates are of one type
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (isPlace(names[k])) near &= table.columns[k].in_float;
  }
  std::vector<Source> sources;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::string& name = names[k];
    if (name.empty() || !table.columns[k].numeric) continue;
    if (isPlace(name))
      sources.push_back({k, realType(near)});
    else if (name.rfind("normal_", 0) == 0)
      sources.push_back({k, kFloat32});
    else if (isChannel(name) && color.type != 0)
      sources.push_back({k, color.type, color.scale});
    else
      sources.push_back({k, realType(table.columns[k].in_float)});
  }
  return sources;
}

void store(double value, std::uint8_t type, std::uint8_t* at) {
  const auto put = [at](auto number) { std::memcpy(at, &number, sizeof(number)); };
  if (type == kFloat64) return put(value);
  if (type == kFloat32) return put(static_cast<float>(value));
  const double number = std::isfinite(value) ? std::round(value) : 0.0;  // an empty colour
  if (type == kUInt16) return put(static_cast<std::uint16_t>(number));
  put(static_cast<std::uint8_t>(number));
}

/** What the file's columns are, and what of them is left out. */
void describe(const TextTable& table, const FieldNames& fields, PointFile& file) {
  for (std::size_t k = 0; k < fields.names.size(); ++k) {
    const bool asked = table.columns[k].name == "-" || (k == 0 && table.row_names);
    const bool counted = k == 0 && fields.numbers_rows;
    const bool text = !table.columns[k].numeric && !asked;
    file.columns += k == 0 ? "" : " ";
    file.columns += fields.names[k].empty() || text ? "-" : fields.names[k];
    if (text && fields.names[k].empty())
      file.left_out.push_back("column " + std::to_string(k + 1) + ", which is text,");
    else if (text)
      file.left_out.push_back("'" + fields.names[k] + "', a column of text,");
    if (counted) {
      file.warnings.push_back(
          "column 1 counts the points and is left out; if it is a coordinate, name the columns: "
          "-columns x,y,z,...");
    }
  }
  file.columns += table.named_by == ColumnNames::kFile     ? ", as the file names them"
                  : table.named_by == ColumnNames::kCaller ? ", as -columns names them"
                                                           : ", guessed from the numbers";
}

/** The names for a file whose format has them fixed, if it has this number of columns. */
std::vector<std::string> fixedNames(TextKind kind, std::size_t columns) {
  if (columns != 6) return {};
  if (kind == TextKind::kXyzRgb) return {"x", "y", "z", "red", "green", "blue"};
  if (kind == TextKind::kXyzNormal) return {"x", "y", "z", "normal_x", "normal_y", "normal_z"};
  return {};
}

Result<FieldNames> namesFor(TextKind kind, const TextTable& table) {
  const std::vector<std::string> fixed = fixedNames(kind, table.columns.size());
  if (!fixed.empty() && table.named_by == ColumnNames::kNobody) {
    FieldNames names;
    names.names = fixed;
    return names;
  }
  return fieldNames(table, kind == TextKind::kPts);
}

std::vector<std::string> columnList(const std::string& columns) {
  std::vector<std::string> names;
  std::istringstream list(columns);
  for (std::string name; std::getline(list, name, ',');) names.push_back(name);
  return names;
}

}  // namespace

Error checkColumns(const std::string& columns) {
  if (columns.empty()) return {};
  const std::vector<std::string> names = columnList(columns);
  if (columns.back() != ',' && namePlaces(names) &&
      std::find(names.begin(), names.end(), "") == names.end())
    return {};
  return {ErrorCode::kBadArgument,
          "-columns " + columns +
              ": name every column, with x, y and z among them and - for one to leave out, as in "
              "x,y,z,i,r,g,b,-"};
}

Result<PointFile> parseText(const std::vector<unsigned char>& bytes, TextKind kind,
                            const std::string& columns) {
  if (Error error = checkColumns(columns)) return error;
  const Result<TextTable> table = parseTextTable(bytes, columnList(columns));
  if (!table) return table.error();
  const Result<FieldNames> fields = namesFor(kind, *table);
  if (!fields) return fields.error();
  PointFile file;
  file.comments = table->comments;
  file.left_out = table->left_out;
  file.degrees = fields->degrees;
  describe(*table, *fields, file);
  const std::vector<Source> sources = fieldSources(*table, fields->names);
  PointTable& cloud = file.cloud;
  for (const Source& source : sources) addField(cloud, fields->names[source.column], source.type);
  const std::size_t n = table->rows();
  if (n > 0xfffffffeu) return badInput("the file has more than 2^32 - 2 points; split it");
  cloud.resize(n);
  std::uint8_t* at = cloud.data.data();
  for (std::size_t i = 0; i < n; ++i) {
    for (const Source& source : sources) {
      store(source.scale * table->at(i, source.column), source.type, at);
      at += scalarSize(source.type);
    }
  }
  adoptPclFields(cloud);
  return file;
}

}  // namespace pcl_slim

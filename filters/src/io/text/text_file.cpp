// SPDX-License-Identifier: BSD-3-Clause
#include "io/point_formats.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "io/ply/ply_header.h"
#include "io/scalar_type.h"
#include "io/text/column_names.h"

namespace pcl_slim {

namespace {

bool
isChannel(const std::string& name)
{
  return name == "red" || name == "green" || name == "blue" || name == "alpha";
}

/** Bytes of colours are bytes, larger whole numbers 16 bits, others as other numbers. */
std::uint8_t
colorType(const TextTable& table, const std::vector<std::string>& names)
{
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
std::vector<std::uint8_t>
columnTypes(const TextTable& table, const std::vector<std::string>& names)
{
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

void
store(double value, std::uint8_t type, std::uint8_t* at)
{
  const auto put = [at](auto number) { std::memcpy(at, &number, sizeof(number)); };
  if (type == kFloat64) return put(value);
  if (type == kFloat32) return put(static_cast<float>(value));
  const double number = std::isfinite(value) ? value : 0.0;  // an empty field of a colour
  if (type == kUInt16) return put(static_cast<std::uint16_t>(number));
  put(static_cast<std::uint8_t>(number));
}

}  // namespace

Result<PointFile>
parseText(const std::vector<unsigned char>& bytes, bool pts)
{
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
  pcl::PCLPointCloud2& cloud = file.cloud;
  const std::size_t n = table->rows();
  if (n > 0xfffffffeu) return badInput("the file has more than 2^32 - 2 points; split it");
  cloud.width = static_cast<pcl::uindex_t>(n);
  cloud.height = 1;
  cloud.row_step = static_cast<pcl::uindex_t>(cloud.point_step * n);
  cloud.data.resize(cloud.point_step * n);
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

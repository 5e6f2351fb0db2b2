// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "pcl_slim/core/scalar_type.h"
#include "pcl_slim/filters/io/point_table.h"

namespace pcl_slim_test {

/** A point's layout as a driver publishes it. */
struct Layout {
  const char* name;
  std::vector<pcl_slim::PointField> fields;
  std::uint32_t point_step;
};

/** Layouts of drivers: padded coordinates, times and rings between other fields, packed colours, and
 * types that CloudView does not read in place. */
inline std::vector<Layout> driverLayouts() {
  using namespace pcl_slim;
  return {
      {"packed", {{"x", 0, kFloat32, 1}, {"y", 4, kFloat32, 1}, {"z", 8, kFloat32, 1}}, 12},
      {"xyzi of PCL",
       {{"x", 0, kFloat32, 1},
        {"y", 4, kFloat32, 1},
        {"z", 8, kFloat32, 1},
        {"intensity", 16, kFloat32, 1}},
       32},
      {"velodyne",
       {{"x", 0, kFloat32, 1},
        {"y", 4, kFloat32, 1},
        {"z", 8, kFloat32, 1},
        {"intensity", 12, kFloat32, 1},
        {"ring", 16, kUInt16, 1},
        {"time", 18, kFloat32, 1}},
       22},
      {"ouster",
       {{"x", 0, kFloat32, 1},
        {"y", 4, kFloat32, 1},
        {"z", 8, kFloat32, 1},
        {"intensity", 16, kFloat32, 1},
        {"t", 20, kUInt32, 1},
        {"reflectivity", 24, kUInt16, 1},
        {"ring", 26, kUInt16, 1},
        {"ambient", 28, kUInt16, 1},
        {"range", 32, kUInt32, 1}},
       48},
      {"realsense",
       {{"x", 0, kFloat32, 1},
        {"y", 4, kFloat32, 1},
        {"z", 8, kFloat32, 1},
        {"rgb", 16, kFloat32, 1}},
       20},
      {"livox, times first",
       {{"timestamp", 0, kFloat64, 1},
        {"x", 8, kFloat32, 1},
        {"y", 12, kFloat32, 1},
        {"z", 16, kFloat32, 1},
        {"tag", 20, kUInt8, 1},
        {"line", 21, kUInt8, 1}},
       22},
      {"double",
       {{"x", 0, kFloat64, 1},
        {"y", 8, kFloat64, 1},
        {"z", 16, kFloat64, 1},
        {"label", 24, kInt32, 3}},
       40},
      {"z y x of whole numbers",
       {{"z", 1, kInt16, 1}, {"y", 3, kInt16, 1}, {"x", 5, kInt16, 1}, {"echo", 0, kUInt8, 1}},
       7},
  };
}

/** Writes a value of a field's type. */
inline void store(pcl_slim::PointTable& table, std::size_t point, const std::string& name,
                  double value) {
  using namespace pcl_slim;
  const PointField& field = table.fields[static_cast<std::size_t>(findField(table, name))];
  std::uint8_t* at = table.data.data() + point * table.point_step + field.offset;
  const auto put = [at](auto typed) { std::memcpy(at, &typed, sizeof(typed)); };
  if (field.datatype == kFloat32) put(static_cast<float>(value));
  if (field.datatype == kFloat64) put(value);
  if (field.datatype == kInt16) put(static_cast<std::int16_t>(std::lround(value)));
}

/** Points on a noisy sphere of radius 1000 about (0, 0, 3000); all other bytes are random. */
inline pcl_slim::PointTable sphereTable(const Layout& layout, std::size_t points,
                                        std::uint32_t rows = 1) {
  pcl_slim::PointTable table;
  table.fields = layout.fields;
  table.point_step = layout.point_step;
  table.resize(points);
  table.height = rows;
  table.width = static_cast<std::uint32_t>(points / rows);
  std::mt19937 random(7);
  for (std::uint8_t& byte : table.data) byte = static_cast<std::uint8_t>(random() & 0xff);
  const auto uniform = [&random] { return static_cast<double>(random()) / 4294967296.0; };
  for (std::size_t i = 0; i < points; ++i) {
    const double z = 2 * uniform() - 1, angle = 6.283185307 * uniform();
    const double flat = std::sqrt(1 - z * z), radius = 1000 + 4 * (uniform() - .5);
    store(table, i, "x", radius * flat * std::cos(angle));
    store(table, i, "y", radius * flat * std::sin(angle));
    store(table, i, "z", 3000 + radius * z);
  }
  return table;
}

/** The bytes of a field, point by point. */
inline std::vector<std::uint8_t> bytesOf(const pcl_slim::PointTable& table,
                                         const std::string& name) {
  const auto& field = table.fields[static_cast<std::size_t>(pcl_slim::findField(table, name))];
  const std::size_t bytes = pcl_slim::scalarSize(field.datatype) * field.count;
  std::vector<std::uint8_t> values;
  for (std::size_t i = 0; i < pcl_slim::numPoints(table); ++i) {
    const std::uint8_t* at = table.data.data() + i * table.point_step + field.offset;
    values.insert(values.end(), at, at + bytes);
  }
  return values;
}

/** A message of these points with bytes of another value behind each row. */
template <typename Message>
Message messageOf(const pcl_slim::PointTable& table, std::uint32_t padding = 0) {
  Message message;
  for (const pcl_slim::PointField& field : table.fields) {
    auto& made = message.fields.emplace_back();
    made.name = field.name;
    made.offset = field.offset;
    made.datatype = field.datatype;
    made.count = field.count;
  }
  message.height = table.height;
  message.width = table.width;
  message.point_step = table.point_step;
  message.is_bigendian = false;
  const std::size_t row = std::size_t{table.point_step} * table.width;
  message.row_step = static_cast<std::uint32_t>(row + padding);
  for (std::size_t i = 0; i < table.height; ++i) {
    const auto first = table.data.begin() + static_cast<std::ptrdiff_t>(i * row);
    message.data.insert(message.data.end(), first, first + static_cast<std::ptrdiff_t>(row));
    message.data.insert(message.data.end(), padding, 0xee);
  }
  return message;
}

}  // namespace pcl_slim_test

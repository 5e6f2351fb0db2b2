// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/scalar_type.h"

namespace pcl_slim {

/** \brief A value that each point of a table has, as pcl::PCLPointField describes it. */
struct PointField {
  std::string name;
  std::uint32_t offset = 0;   ///< bytes from the begin of the point
  std::uint8_t datatype = 0;  ///< ScalarType; the numbers are PCL's
  std::uint32_t count = 1;    ///< elements
};

/** \brief Points with fields of any type, as pcl::PCLPointCloud2 has them; toPCL() and
 * toPointTable() of pcl_conversion.h convert. Values are in this machine's byte order. */
struct PointTable {
  std::uint32_t height = 1, width = 0;  ///< rows and columns of an organised cloud, or one row
  std::vector<PointField> fields;
  std::uint32_t point_step = 0;    ///< bytes of a point
  std::vector<std::uint8_t> data;  ///< point by point, row by row

  /** \brief Makes the table one row of this number of points; new ones are 0. */
  void resize(std::size_t points) {
    height = 1;
    width = static_cast<std::uint32_t>(points);
    data.resize(point_step * points);
  }
};

/** \brief Appends a field; points that are appended later have it. */
inline void addField(PointTable& table, const std::string& name, std::uint8_t type,
                     std::size_t count = 1) {
  table.fields.push_back({name, table.point_step, type, static_cast<std::uint32_t>(count)});
  table.point_step += static_cast<std::uint32_t>(scalarSize(type) * count);
}

/** \brief Number of points: width times height. Table, here and below: a PointTable or a
 * pcl::PCLPointCloud2. */
template <typename Table>
std::size_t numPoints(const Table& cloud) {
  return static_cast<std::size_t>(cloud.width) * cloud.height;
}

/** \brief Index of a field by name in cloud.fields, or -1. */
template <typename Table>
int findField(const Table& cloud, const std::string& name) {
  for (std::size_t i = 0; i < cloud.fields.size(); ++i) {
    if (cloud.fields[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

/** \brief Value of the first element of a field of one point, whatever its type, as double. */
template <typename Table, typename Field>
double fieldValue(const Table& cloud, std::size_t point, const Field& field) {
  return readScalar(cloud.data.data() + point * cloud.point_step + field.offset, field.datatype);
}

/** \brief Names what contradicts itself in a table: its bytes of data and its number of points, a
 * field's name, type or place in a point. O(fields). */
PCL_SLIM_EXPORT Error checkPointTable(const PointTable& table);

}  // namespace pcl_slim

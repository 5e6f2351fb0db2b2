// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/io/point_table.h"

namespace pcl_slim {

/** \brief Whether these fields exist and can be written as real numbers. */
PCL_SLIM_EXPORT bool hasRealFields(const PointTable& points, const std::vector<std::string>& names);

/** \brief A copy of the points in which these fields can be written as real numbers.
 *
 * Fields keep their order, bytes and types; a named one of a whole-number type becomes type,
 * one that is not there is added at the end as type, with zeros. Where a field changes, fields
 * follow each other without gaps. \param[in] type kFloat32 or kFloat64. O(bytes of the points).
 */
PCL_SLIM_EXPORT PointTable withRealFields(const PointTable& points,
                                          const std::vector<std::string>& names, std::uint8_t type);

/** \brief The same without a copy where no field changes. */
PCL_SLIM_EXPORT PointTable withRealFields(PointTable&& points,
                                          const std::vector<std::string>& names, std::uint8_t type);

/** \brief Writes one field of type FLOAT32 or FLOAT64, point by point; from several threads if
 * they write different points. */
class PCL_SLIM_EXPORT FieldWriter {
 public:
  /** \param[in,out] points must have the field and outlive this object. */
  FieldWriter(PointTable& points, const std::string& name);

  void set(std::size_t point, double value) const;

 private:
  unsigned char* first_;
  std::size_t step_;
  bool double_;
};

}  // namespace pcl_slim

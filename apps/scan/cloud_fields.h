// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** \brief A copy of a point file in which these fields can be written as real numbers.
 *
 * Fields keep their order, bytes and types; a named one of a whole-number type becomes type,
 * one that is not there is added at the end as type, with zeros. \param[in] type
 * pcl::PCLPointField::FLOAT32 or FLOAT64. O(bytes of the cloud).
 */
PointFile
withRealFields(const PointFile& file, const std::vector<std::string>& names, std::uint8_t type);

/** \brief Writes one field of type FLOAT32 or FLOAT64, point by point; from several threads if
 * they write different points. */
class FieldWriter {
 public:
  /** \param[in,out] cloud must have the field and outlive this object. */
  FieldWriter(pcl::PCLPointCloud2& cloud, const std::string& name);

  void set(std::size_t point, double value) const;

 private:
  unsigned char* first_;
  std::size_t step_;
  bool double_;
};

}  // namespace pcl_slim

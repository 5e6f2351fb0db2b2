// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "io/las/las_header.h"
#include "io/las/las_layout.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** A value of the record that takes a field's bytes as they are. */
struct LasCopy {
  std::size_t from = 0, to = 0, bytes = 0;
  int shift = 0, bits = 0;  ///< of a byte that several values share
};

/** A value of the record that takes a field's number in another type. */
struct LasConversion {
  const pcl::PCLPointField* field = nullptr;
  LasItem item;
};

/** Which value of a point record each field of a cloud becomes. */
struct LasPlan {
  std::vector<unsigned char> head;  ///< the file's bytes before its points
  LasHeader header;                 ///< of that head
  std::size_t record_bytes = 0;
  std::vector<LasCopy> copies;
  std::vector<LasConversion> conversions;
  const pcl::PCLPointField* packed_color = nullptr;  ///< bytes that red, green and blue come from
  bool single_returns = false;                       ///< of points that say nothing of returns
};

/** Plans the file: fields of a value's name and type become that value, others extra bytes that a VLR
 * describes. \return an error for fields that do not fit. The cloud must outlive the plan. */
Result<LasPlan>
planLas(const PointFile& file);

}  // namespace pcl_slim

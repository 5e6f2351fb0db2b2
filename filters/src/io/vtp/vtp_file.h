// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** No error where this build has VTK's reader and writer; otherwise says what to name instead of
 * path. The functions below give the same error then. */
Error
checkVtp(const std::string& path);

/** Writes points as VTK's XML PolyData, bit for bit: "Normals" for the normals, "RGB" (and "alpha", unless
 * it is 0 in a field rgb) for a packed colour, for each other field an array of its name, type and
 * count, comments as strings of the field data. Faces become polygons; without faces each point that
 * has finite coordinates is a vertex cell. Rows of an organised cloud and the sensor are not kept. */
Error
saveVtp(const std::string& path, const PointFile& file);

/** An array of points as saveVtp() writes it. */
struct VtpColumn {
  std::string name;
  std::uint8_t type;  ///< ScalarType
  std::size_t components;
};

/** The arrays that saveVtp() writes for points, without their coordinates. */
Result<std::vector<VtpColumn>>
vtpColumns(const PointFile& file);

/** Reads what saveVtp() or VTK has written: points, their arrays as fields, and polygons. */
Result<PointFile>
parseVtp(const std::vector<unsigned char>& bytes);

}  // namespace pcl_slim

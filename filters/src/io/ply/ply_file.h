// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** The vertices and faces of a PLY file of any of the three data forms. */
Result<PointFile>
parsePly(const std::vector<unsigned char>& bytes);

/** The bytes of a binary_little_endian PLY file, or why the fields do not fit the format. */
Result<std::vector<unsigned char>>
formatPly(const PointFile& file);

}  // namespace pcl_slim

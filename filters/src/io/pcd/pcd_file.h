// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** The content of a PCD file, versions 0.5 to 0.7, in all three of its data forms. */
Result<PointFile>
parsePcd(const std::vector<unsigned char>& bytes);

/** The bytes of a binary PCD 0.7 file. */
std::vector<unsigned char>
formatPcd(const PointFile& file);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** The points of a LAS file, versions 1.0 to 1.4, point formats 0 to 10 (ASPRS, LAS 1.4 R15). */
Result<PointFile>
parseLas(const std::vector<unsigned char>& bytes);

/** The bytes of a LAS file: those of the one read where a file comes from one, and else of version
 * 1.4, format 6, or 7 where there are colours. \return an error for coordinates that are not finite. */
Result<std::vector<unsigned char>>
formatLas(const PointFile& file);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** The points of a text file, one a line; text_table.h and column_names.h say how it is read.
 *
 * Coordinates and other numbers are floats where those hold every digit written, else doubles.
 * \param[in] pts whether it is a .pts file, whose intensity stands before the colours. */
Result<PointFile>
parseText(const std::vector<unsigned char>& bytes, bool pts);

}  // namespace pcl_slim

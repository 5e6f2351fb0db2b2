// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace pcl_slim::detail {

/** Linear RGB to CIELAB in place; columns have room for whole vectors of 16.
 * \param[in] to_xyz rows of RGB -> XYZ over the white point. */
void labOfLinear(const float to_xyz[9], float* r, float* g, float* b, std::size_t n);

}  // namespace pcl_slim::detail

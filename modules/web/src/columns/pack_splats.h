// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/splat/splat_set.h"

namespace pcl_slim::detail {

/** \brief Coloured discs for a page, before they are deflated: 16 bits a coordinate, normals of 12 bits a
 * coordinate, radii as 8-bit logarithms, colours as they are and their change over the disc in steps of 4. */
std::vector<unsigned char>
packSplats(const SplatSet& splats);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "topology/fans.h"

namespace pcl_slim::detail {

/** Border loops of a mesh: vertices in the order in which a face that closes the gap has them. Loops that meet
 * a vertex twice are left out. O(T log T). */
std::vector<std::vector<std::uint32_t>>
borderLoops(const std::vector<Triangle>& triangles, std::size_t num_vertices, int threads);

}  // namespace pcl_slim::detail

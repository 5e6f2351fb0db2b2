// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/render/bounding_spheres.h"

namespace pcl_slim::detail {

/** \brief The spheres a view of the whole object has to show, without strays.
 *
 * Left out are centres beyond a whole extent past the 1st and 99th percentile, then pieces that have
 * less than 1 % of the area (by r^2) and are apart: by at least a 64th of the longest extent. O(n).
 */
std::vector<BoundingSphere>
bulkOf(const std::vector<BoundingSphere>& spheres);

}  // namespace pcl_slim::detail

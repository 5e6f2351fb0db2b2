// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/surface/surface.h"
#include "pcl_slim/visualization/display_mode.h"

namespace pcl_slim::detail {

/** \brief Values of the first and last colour of a mode that shows numbers, world units.
 *
 * Taken from the leaves, not from a picture, so that colours stay as the object turns. Curvatures,
 * at the leaves' centres: -r ... r where r holds 95 % of the area; radii: their 2nd to 98th
 * percentile by area; levels: lowest and highest. O(leaves log leaves).
 */
std::array<double, 2>
surfaceRange(const SLIMSurface& surface, DisplayMode mode);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "octree/color_octree.h"
#include "points/point_window.h"

namespace pcl_slim::detail {

/** Noise of colours and normals from points against their nearest neighbours.
 *
 * Some hundred samples; neighbours are taken from the samples' surroundings in Morton order, so a
 * few are farther than the nearest. The median over samples ignores edges of colour and shape as
 * long as most samples have none. 0 for fewer than 32 points. Constant time.
 */
SampleNoise
estimateSampleNoise(const OctreeCloud& cloud, const OctreeSource& source, int threads);

}  // namespace pcl_slim::detail

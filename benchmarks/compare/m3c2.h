// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "compare/change_scene.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::change {

/** \brief Scales of M3C2, world units. */
struct M3C2Scales {
  double normal = 0;      ///< radius of the ball whose points give the normal
  double projection = 0;  ///< radius of the cylinder whose points are averaged
  double depth = 0;       ///< half length of the cylinder
};

/** \brief Distances at core points of a scan from another one by M3C2 (Lague, Brodu, Leroux 2013):
 * the means, along the normal of the first scan, of both scans' points in a cylinder; the level of
 * detection is 1.96 sqrt(s1^2 / n1 + s2^2 / n2) by the spreads s along the normal. A core point has no
 * distance where a scan has fewer than 4 points in the cylinder. Normals are turned to the side of
 * the exact ones. */
Estimate m3c2(const Scan& scan, const Scan& reference, const std::vector<std::size_t>& cores,
              const M3C2Scales& scales);

}  // namespace pcl_slim::change

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "pcl_slim/splat/octree_cloud.h"

namespace pcl_slim::detail {

/** Variances that a cell shows without any structure in it. */
struct SampleNoise {
  double color = 0;   ///< squared Delta E
  double normal = 0;  ///< squared deviation of unit normals, whatever their signs
};

/** When a cell of the octree is divided: a deviation above its tolerance by more than noise
 * explains. */
struct SplitRule {
  double geometric_error = 0.2;  ///< standard deviation of unit normals
  double color_error =
      10.0;               ///< standard deviation of CIELAB, Delta E; infinite: colour is ignored
  bool oriented = false;  ///< deviation of signed normals; false: of the lines along them
  SampleNoise noise;
  double noise_z = 2.0;                ///< noise counts as its variance times 1 + z / sqrt(n - 1)
  std::uint32_t min_points = 2;        ///< cells of fewer points stay whole
  int max_depth = OctreeCloud::kBits;  ///< halvings of a root cell at most
};

/** One cell: the points [begin, end) of the cloud. */
struct OctreeCell {
  std::uint32_t begin = 0, end = 0;
  float spacing = 0;       ///< mean distance between points around here, in root cells; 0: unknown
  std::int32_t shift = 0;  ///< its size, for OctreeCloud::edge
};

/** The target of an optimal cut; one of the two. */
struct CutBudget {
  std::uint64_t max_cells = 0;  ///< most cells; 0: no limit
  double target_error = 0;      ///< mean Delta E between points and their cells; 0: none
};

}  // namespace pcl_slim::detail

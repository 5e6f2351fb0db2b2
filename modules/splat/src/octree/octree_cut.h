// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "octree/color_octree.h"
#include "points/point_window.h"

namespace pcl_slim::detail {

/** A cut through the whole octree. */
struct OctreeCut {
  std::vector<OctreeCell> cells;
  double error = 0;         ///< mean Delta E between points and their cells, noise taken off
  std::uint64_t nodes = 0;  ///< cells of the whole tree
};

/** The cells that keep most of shape and colour for their number.
 *
 * Minimises sum D + lambda * cells over all cuts of the octree, D = points^(1/2) * d^(3/2) *
 * edge^(5/4) with d^2 = c / 100^2 + v / 20 + v^2 / 2, c the variance of colours and v that of
 * normals, and solves for lambda: as many cells as max_cells allows (within 1 %, where the cloud
 * has that many), or as few as meet target_error (else the finest cut). Roots are grown where max_cells is below their number. The tolerances of rule
 * are not used; its noise, least points and depth are. O(N) time, 40 bytes a cell of the tree.
 */
OctreeCut
cutOptimally(const OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule,
             const CutBudget& budget, int threads);

}  // namespace pcl_slim::detail

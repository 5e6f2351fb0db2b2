// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/splat/octree_cloud.h"

namespace pcl_slim {

/** \brief Variances that a cell shows without any structure in it. */
struct SampleNoise {
  double color = 0;   ///< squared Delta E
  double normal = 0;  ///< squared deviation of unit normals, whatever their signs
};

/** \brief Noise of colours and normals from points against their nearest neighbours.
 *
 * Some thousand samples; neighbours are taken from the samples' surroundings in Morton order, so a
 * few lie farther than the nearest. The median over samples ignores edges of colour and shape as
 * long as most samples have none. 0 for fewer than 32 points. Constant time.
 */
SampleNoise
estimateSampleNoise(const OctreeCloud& cloud);

/** \brief When a cell of the octree is divided: a deviation above its tolerance by more than noise
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

/** \brief One cell: the points [begin, end) of the cloud. */
struct OctreeCell {
  std::uint32_t begin = 0, end = 0;
  float spacing = 0;       ///< mean distance between points around here, in root cells; 0: unknown
  std::int32_t shift = 0;  ///< its size, for OctreeCloud::edge
};

/** \brief Divides every occupied root cell until no rule asks for more. Cells in Morton order.
 *
 * Chains of cells that hold the same points are skipped. O(N) per level that is divided; the same
 * cells for any number of threads.
 */
std::vector<OctreeCell>
divideByTolerance(const OctreeCloud& cloud, const SplitRule& rule, int threads = 0);

/** \brief What an optimal cut is asked for; one of the two. */
struct CutBudget {
  std::uint64_t max_cells = 0;  ///< most cells; 0: no limit
  double target_error = 0;      ///< mean Delta E between points and their cells; 0: none
};

/** \brief A cut through the whole octree. */
struct OctreeCut {
  std::vector<OctreeCell> cells;
  double error = 0;         ///< mean Delta E between points and their cells, noise taken off
  std::uint64_t nodes = 0;  ///< cells of the whole tree
};

/** \brief The cells that keep most of shape and colour for their number.
 *
 * Minimises sum D + lambda * cells over all cuts of the octree, D = points * sqrt(colour variance
 * / 100^2 + normal variance / 20) * sqrt(edge), and solves for lambda: as many cells as max_cells
 * allows (within 1 %, where the cloud has that many), or as few as meet target_error (else the
 * finest cut). Roots are grown where max_cells asks for fewer than exist. The tolerances of rule
 * are not used; its noise, least points and depth are. O(N) time, 40 bytes a cell of the tree.
 */
OctreeCut
cutOptimally(const OctreeCloud& cloud, const SplitRule& rule, const CutBudget& budget,
             int threads = 0);

}  // namespace pcl_slim

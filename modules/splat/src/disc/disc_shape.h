// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "octree/cell_batch.h"
#include "pcl_slim/splat/splat_set.h"

namespace pcl_slim::detail {

/** What a cell's points say about its disc. */
struct DiscNormal {
  std::array<double, 3> normal;
  double variance;  ///< 1 - share of the normals' common line, in [0, 2/3]; 0 without normals
};

/** Axes along which cells' normals agree, on the side of their sum; those of the planes through the
 * points around where none has one. */
std::vector<DiscNormal>
discNormals(const PointWindow& window, const CellBatch& batch);

/** Of a cell's points, the one nearest to a place and the distance of the farthest from it, in root
 * cells. */
struct DiscReach {
  std::size_t nearest;
  float farthest;
};

DiscReach
discReach(const PointWindow& window, const OctreeCell& cell, const std::array<float, 3>& center);

/** How colour changes across a disc: least squares of Lab over its plane, less the share that noise
 * alone explains, as differences of display colours from one rim of the points to the other.
 * edge: world units of a root cell. */
SplatSet::Gradient
discGradient(const PointWindow& window, const OctreeCell& cell, const CellSums& sums,
             const std::array<double, 3>& normal, const LabTable& table, double noise, double edge);

}  // namespace pcl_slim::detail

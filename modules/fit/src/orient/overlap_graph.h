// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fit_constants.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief An edge of the graph of overlapping leaves: light where two are clearly on one sheet. */
struct OverlapEdge {
  float weight;
  std::uint32_t a, b;  ///< surfels
  bool opposed;        ///< the normals point to different sides

  bool operator<(const OverlapEdge& other) const
  {
    if (weight != other.weight) return weight < other.weight;
    return a != other.a ? a < other.a : b < other.b;
  }
};

/** \brief Edges between leaves and their eight nearest neighbours on each level that is not finer,
 * in lists of no particular order.
 *
 * The weight is 1 - |n . n'| plus how far each leaf passes the other's centre over their distance.
 * O(M log M) for M leaves alike in size on each level. */
std::vector<std::vector<OverlapEdge>>
overlapGraph(const SLIMSurface& surface, const std::vector<std::uint32_t>& leaves, int threads,
             const OrientConstants& constants = {});

}  // namespace pcl_slim::detail

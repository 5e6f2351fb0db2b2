// SPDX-License-Identifier: BSD-3-Clause
// Common sides of surfels fitted without normals (docs/theory.md, "Sides").
#pragma once

#include <cstdint>
#include <vector>

#include "fit_constants.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief An edge of the graph of overlapping leaves: light where two are clearly on one sheet. */
struct OverlapEdge {
  float weight;
  std::uint32_t a, b;  ///< surfels
  bool opposed;        ///< the normals point to different sides

  bool operator<(const OverlapEdge& other) const {
    if (weight != other.weight) return weight < other.weight;
    return a != other.a ? a < other.a : b < other.b;
  }
};

/** \brief Edges between leaves and their eight nearest neighbours on each level that is not finer,
 * in lists of no particular order.
 *
 * The weight is 1 - |n . n'| plus how far each leaf passes the other's centre over their distance.
 * O(M log M) for M leaves alike in size on each level. */
std::vector<std::vector<OverlapEdge>> overlapGraph(const SLIMSurface& surface,
                                                   const std::vector<std::uint32_t>& leaves,
                                                   int threads,
                                                   const OrientConstants& constants = {});

/** \brief How surfels got their sides. */
struct Orientation {
  SideSource source = SideSource::kNone;
  std::uint64_t overlap_edges = 0;  ///< of the graph that kOverlaps searches
};

/** \brief Gives surfels fitted without normals a common side; flips them in place.
 *
 * Towards FitParams' viewpoint; or, where the store's points have sensors, towards those of each
 * leaf's points; or by the graph of overlapping leaves: Kruskal's spanning forest with parity,
 * edges weighted by 1 - |n . n'| and by how far each leaf passes the other's centre; each connected
 * part then turns outward as seen from its centroid. Internal surfels follow the leaves below them.
 * SurfaceInfo::oriented stays false: near sheets and creases a sign can be wrong, so blending
 * aligns signs point by point.
 * \param[in] store the points fitted, or null
 */
Orientation orientSurface(const PointStore* store, const FitParams& params,
                          const OrientConstants& constants, int threads, SLIMSurface& surface);

/** \brief Turns surfels to the sides of the points about them. \param[in] store the points fitted,
 * with sides */
void turnToSides(const PointStore& store, const OrientConstants& constants, int threads,
                 SLIMSurface& surface);

}  // namespace pcl_slim::detail

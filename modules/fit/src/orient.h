// SPDX-License-Identifier: BSD-3-Clause
// Common sides of surfels fitted without normals (docs/sides.md, "Which side is out").
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "fit_constants.h"
#include "pcl_slim/cloud/detail/signed_graph.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/cloud/side_evidence.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief The leaves' places on the surface, the normals of their frames, and squared radii as areas.
 */
std::vector<SidePatch> patchesOf(const SLIMSurface& surface,
                                 const std::vector<std::uint32_t>& leaves);

/** \brief Edges between leaves and their eight nearest neighbours on each level that is not finer, by
 * edgeBetween(); nodes are places in leaves.
 *
 * O(M log M) for M leaves alike in size on each level. */
std::vector<SignedEdge> overlapGraph(const SLIMSurface& surface,
                                     const std::vector<std::uint32_t>& leaves,
                                     const std::vector<SidePatch>& patches, int threads,
                                     const OrientConstants& constants = {});

/** \brief How surfels got their sides. */
struct Orientation {
  SideSource source = SideSource::kNone;
  std::uint64_t overlap_edges = 0;  ///< of the graph of leaves
  std::optional<double> facing;     ///< share of the points whose leaves face the evidence
};

/** \brief Gives surfels fitted without normals a common side; flips them in place.
 *
 * Neighbouring leaves agree as far as the evidence allows: their beams, towards a viewpoint or the
 * sensors of their points, vote on the same graph (signsByVotes()). Without evidence each connected
 * part turns outward (signsOutward()). Internal surfels follow the leaves below them.
 * SurfaceInfo::oriented stays false: near sheets and creases a sign can be wrong, so blending
 * aligns signs point by point.
 * \param[in] store the points fitted; null: only their evidence is known
 */
Orientation orientSurface(const PointStore* store, const SideEvidence& evidence,
                          const OrientConstants& constants, int threads, SLIMSurface& surface);

/** \brief Fills in the shares of the points on leaves that face the origin and outward. O(leaves). */
void measureFacing(const SLIMSurface& surface, SideStatistics& sides);

/** \brief Turns surfels to the sides of the points about them. \param[in] store the points fitted,
 * with sides */
void turnToSides(const PointStore& store, const OrientConstants& constants, int threads,
                 SLIMSurface& surface);

/** \brief Turns leaves whose found sides contradict those around them on the same sheet, and the
 * points on them.
 *
 * Two leaves are certainly of one sheet if each contains the other's middle on its polynomial, to a
 * tenth of the radius and two residuals, and their normals agree within 25 degrees up to the sign:
 * thin parts have none such. Leaves that agree are one region, and regions turn by signsByVotes(), so
 * that the larger one keeps its side. \return how many leaves turned. O(leaves). */
std::uint64_t turnContradicted(const OrientConstants& constants, int threads, PointStore& store,
                               SLIMSurface& surface);

}  // namespace pcl_slim::detail

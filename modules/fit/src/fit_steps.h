// SPDX-License-Identifier: BSD-3-Clause
// The steps before and after the cover, which the fit of a store and that of a tile share.
#pragma once

#include "fit_plan.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

class LevelCover;

/** \brief First level whose median ball contains a small share of the points: the box's size gives
 * no size of the object, as one far point can stretch it. 1 in paper mode. */
int
startLevel(const PointStore& store, const FitPlan& plan);

/** \brief Gives surfels fitted without normals a common side; flips them in place.
 *
 * Towards FitParams' viewpoint; or, where the store's points have sensors, towards those of each leaf's
 * points; or by the graph of overlapping leaves: Kruskal's spanning forest
 * with parity, edges weighted by 1 - |n . n'| and by how far each leaf passes the other's centre;
 * each connected part then turns outward as seen from its centroid. Internal surfels follow the
 * leaves below them. SurfaceInfo::oriented stays false: near sheets and creases a sign can be
 * wrong, so blending aligns signs point by point.
 * \param[in] store the points fitted, or null \param[out] stats side_source and overlap_edges
 */
void
orientSurface(const PointStore* store, const FitParams& params, const OrientConstants& constants,
              SLIMSurface& surface, FitStatistics& stats);

/** \brief Turns surfels to the sides of the points about them. \param[in] store the points fitted, with
 * sides */
void
turnToSides(const PointStore& store, const OrientConstants& constants, int threads,
            SLIMSurface& surface);

/** \brief Writes a finished cover's surfels into a surface's columns, and how it was made into its
 * info; links are still to be built. O(surfels). */
void
fillSurface(const PointStore& store, const FitPlan& plan, const LevelCover& cover, int threads,
            SLIMSurface& surface);

/** \brief Gives the surfels that data do not fill their trim maps (docs/theory.md, "Borders").
 *
 * Every surfel's ball is gathered once more, and searched for gaps; those that may have one are
 * measured. Internal surfels, which level of detail draws small, get coarse maps. Surfels in
 * parallel; the same bytes for any number of threads.
 * \param[in] hole_size diameter of the smallest hole kept, in spacings of a surfel's points
 * \param[in,out] stats its threads are used, trim_candidates counted
 */
void
makeTrimMaps(const PointStore& store, const FitPlan& plan, double hole_size, FitStatistics& stats,
             SLIMSurface& surface);

/** \brief Counts a finished fit's points and surfels, and what its cover did. The times and
 * what was measured of the cloud are the fit's own to write. O(points + surfels). */
void
countFit(const PointStore& store, const LevelCover& cover, const SLIMSurface& surface,
         FitStatistics& stats);

/** \brief Why a fit has no leaf, and what helps; no error where it has some. */
Error
checkLeaves(const PointStore& store, const FitStatistics& stats);

}  // namespace pcl_slim::detail

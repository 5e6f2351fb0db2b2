// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fit_constants.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief Gives surfels fitted without normals a common side; flips them in place.
 *
 * Towards FitParams' viewpoint; or, where the store's points have sensors, towards those of each leaf's
 * points; or by the graph of overlapping leaves: Kruskal's spanning forest
 * with parity, edges weighted by 1 - |n . n'| and by how far each leaf passes the other's centre;
 * each connected part then turns outward as seen from its centroid. Internal surfels follow the
 * leaves below them. SurfaceInfo::oriented stays false: near sheets and creases a sign can be
 * wrong, so blending goes on aligning signs point by point.
 * \param[in] store the points fitted, or null \param[out] stats side_source and overlap_edges
 */
void
orientSurface(const PointStore* store, const FitParams& params, const OrientConstants& constants,
              SLIMSurface& surface, FitStatistics& stats);

}  // namespace pcl_slim::detail

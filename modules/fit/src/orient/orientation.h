// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fit_constants.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief Gives surfels fitted without normals a common side; flips them in place.
 *
 * Towards FitParams' viewpoint, or by the graph of overlapping leaves: Kruskal's spanning forest
 * with parity, edges weighted by 1 - |n . n'| and by how far each leaf passes the other's centre;
 * each connected part then turns outward as seen from its centroid. Internal surfels follow the
 * leaves below them. SurfaceInfo::oriented stays false: near sheets and creases a sign can be
 * wrong, so blending goes on aligning signs point by point.
 */
void
orientSurface(const FitParams& params, const OrientConstants& constants, SLIMSurface& surface);

}  // namespace pcl_slim::detail

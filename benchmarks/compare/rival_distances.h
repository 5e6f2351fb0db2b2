// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "compare/change_scene.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/mesh/triangle_mesh.h"

namespace pcl_slim::change {

/** \brief Distances from the nearest points of the reference, with the sign of their component along
 * the exact normal. */
Estimate nearestPoints(const Scan& scan, const Scan& reference,
                       const std::vector<std::size_t>& chosen);

/** \brief Signed distances of points from a mesh of the reference. \param[in] seconds that it took to
 * make the mesh */
Estimate distancesToMesh(const Scan& scan, const TriangleMesh& mesh, double seconds,
                         const std::vector<std::size_t>& chosen);

/** \brief Distances of a scan's smoothed points from the surface of the reference, with their levels
 * of detection. Both are fitted without normals, with default parameters. \param[out] mesh of the
 * reference's surface \param[out] mesh_seconds CPU time of the reference's fit and mesh */
Result<Estimate> surfaceDistances(const Scan& scan, const Scan& reference,
                                  const std::vector<std::size_t>& chosen, TriangleMesh& mesh,
                                  double& mesh_seconds);

}  // namespace pcl_slim::change

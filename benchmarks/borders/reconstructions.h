// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "borders/open_scenes.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/mesh/triangle_mesh.h"

/** \brief Other methods' meshes of open scenes, made for their holes to stay open. */
namespace pcl_slim::borders {

/** \brief pcl::Poisson of the points with their true normals, its cells no wider than a spacing;
 * without the triangles whose middles are farther than 2 spacings from every point. */
Error trimmedPoisson(const OpenScene& scene, TriangleMesh& mesh);

/** \brief Whether this build has CGAL's methods. */
bool hasFront();

/** \brief CGAL's advancing front, without triangles whose longest edge exceeds 5 spacings. */
Error advancingFront(const OpenScene& scene, TriangleMesh& mesh);

}  // namespace pcl_slim::borders

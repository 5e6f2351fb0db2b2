// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "borders/open_scenes.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/mesh/triangle_mesh.h"

/** \brief Other meshes of open scenes. */
namespace pcl_slim::borders {

/** \brief The truth itself in squares of .4 spacings: what is measured of it is the instrument's own
 * error. */
void trueMesh(const OpenScene& scene, TriangleMesh& mesh);

/** \brief pcl::Poisson of the points with their true normals, its cells no wider than a spacing;
 * without the triangles whose middles are farther than trim spacings from every point. */
Error trimmedPoisson(const OpenScene& scene, double trim, TriangleMesh& mesh);

/** \brief CGAL's advancing front, without triangles whose longest edge exceeds 5 spacings. */
Error advancingFront(const OpenScene& scene, TriangleMesh& mesh);

}  // namespace pcl_slim::borders

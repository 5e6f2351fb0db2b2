// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PolygonMesh.h>
#include <pcl/Vertices.h>

#include <vector>

#include "pcl_slim/core/export.h"
#include "pcl_slim/mesh/triangle_mesh.h"

namespace pcl_slim {

/** \brief A mesh as PCL has it: fields x y z and normal_x normal_y normal_z of type float, k1 and
 * k2 if requested, rgb if the mesh has colours. Coordinates are rounded to float. O(triangles). */
PCL_SLIM_EXPORT pcl::PolygonMesh toPolygonMesh(const TriangleMesh& mesh, bool curvature = true);

/** \brief Its triangles alone. */
PCL_SLIM_EXPORT std::vector<pcl::Vertices> polygonsOf(const TriangleMesh& mesh);

}  // namespace pcl_slim

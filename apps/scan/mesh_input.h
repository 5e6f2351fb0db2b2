// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/core/error.h"
#include "pcl_slim/mesh/triangle_mesh.h"
#include "scan/cloud_file.h"

namespace pcl_slim {

/** \brief The vertices of a file with faces, with normals of the file or of its faces, colours,
 * curvatures and standard errors (sigma_position) where there are any, and the faces cut to triangles from their first corners.
 * O(faces). */
TriangleMesh triangleMeshOf(const CloudFile& cloud);

/** \brief No error for a mesh that can be drawn and measured: corners are finite and not too large
 * for floats, and there is an area. O(triangles). */
Error checkTriangles(const TriangleMesh& mesh);

}  // namespace pcl_slim

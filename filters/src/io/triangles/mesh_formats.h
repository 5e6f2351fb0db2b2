// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/mesh/triangle_mesh.h"

namespace pcl_slim {

/** The columns of vertices in addition to x y z and normals. */
struct MeshColumns {
  bool narrow = true;     ///< x y z as float, not double
  bool curvature = true;  ///< k1 and k2
};

/** Vertices as points, with colours if there are any, and triangles as faces. */
PointFile
toPointFile(const TriangleMesh& mesh, const MeshColumns& columns);

std::string
formatObj(const TriangleMesh& mesh);

std::vector<unsigned char>
formatStl(const TriangleMesh& mesh);

/** An error for a mesh too large for the 32-bit lengths of the format. */
Result<std::vector<unsigned char>>
formatGlb(const TriangleMesh& mesh);

/** An error in builds without VTP. */
Error
saveMeshVtp(const std::string& path, const TriangleMesh& mesh);

/** Whether float keeps vertices where they are. */
bool
floatsSuffice(const TriangleMesh& mesh);

}  // namespace pcl_slim

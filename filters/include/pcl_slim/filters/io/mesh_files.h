// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/mesh/triangle_mesh.h"

namespace pcl_slim {

/** \brief Whether this build's saveMesh supports the extension; otherwise an error that names those
 * it supports. */
PCL_SLIM_EXPORT Error checkMeshExtension(const std::string& path);

/** \brief Writes a mesh by extension (upper or lower case); the file appears only when complete.
 *
 * - .ply: binary_little_endian: x y z, normals, k1 k2, sigma_position and colours if there are any
 * - .obj: text: positions, colours behind them if there are any, normals
 * - .stl: binary: triangles alone
 * - .glb: glTF 2.0 in one file: positions about the middle of the mesh, which is the node's
 *   translation, normals, colours
 * - .vtp: for ParaView, in builds with PCL_SLIM_WITH_VTP: points, "Normals", k1, k2, sigma_position,
 *   "RGB"
 *
 * .ply and .vtp contain doubles where floats would move vertices by more than a thousandth of an
 * edge; .stl always contains floats. O(triangles).
 */
PCL_SLIM_EXPORT Error saveMesh(const std::string& path, const TriangleMesh& mesh);

/** \brief The columns of vertices in addition to their normals. */
struct MeshColumns {
  bool narrow = true;     ///< x y z as float, not double
  bool curvature = true;  ///< k1 and k2
};

/** \brief Vertices as points, with colours if there are any, and triangles as faces.
 * O(triangles). */
PCL_SLIM_EXPORT PointFile toPointFile(const TriangleMesh& mesh, const MeshColumns& columns = {});

/** \brief How far .stl's floats may move a vertex that the mesh has, in lengths of a mean edge. */
PCL_SLIM_EXPORT double floatErrorOf(const TriangleMesh& mesh);

}  // namespace pcl_slim

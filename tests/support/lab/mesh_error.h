// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/mesh/triangle_mesh.h"
#include "support/lab/scenes.h"

namespace pcl_slim::measure {

/** \brief How far a mesh is from an exact surface, in the scene's units. */
struct MeshError {
  double rms = 0;            ///< over the mesh's area, from seven places in each triangle
  double max = 0;            ///< of those places
  double vertex_rms = 0;     ///< over the vertices
  double normal = 0;         ///< RMS angle of the triangles' normals, by area [degrees]
  double vertex_normal = 0;  ///< RMS angle of the vertices' normals [degrees]
  double area = 0;
};

/** \brief Measures a mesh against a shape; places at an open rim count as well. O(triangles). */
MeshError measureMesh(Shape shape, const TriangleMesh& mesh);

}  // namespace pcl_slim::measure

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/mesh/detail/mesh_topology.h"
#include "pcl_slim/mesh/triangle_mesh.h"

namespace pcl_slim::detail {

/** \brief Triangles whose corners of equal coordinates are one vertex, as those of STL files are not.
 */
struct WeldedTriangles {
  std::vector<std::uint32_t> vertex;    ///< of each vertex of the mesh, its number here
  std::vector<Triangle> triangles;      ///< that have three different finite corners
  std::vector<std::uint32_t> original;  ///< of each of them, its number in the mesh
  std::uint32_t num_vertices = 0;       ///< numbered in order of their first ones
};

/** \brief Names a triangle with a corner that is no vertex. O(triangles). */
Error checkCorners(const TriangleMesh& mesh);

/** \brief O(vertices + triangles); corners must be vertices. */
WeldedTriangles weld(const TriangleMesh& mesh);

}  // namespace pcl_slim::detail

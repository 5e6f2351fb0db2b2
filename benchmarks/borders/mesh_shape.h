// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/mesh/triangle_mesh.h"
#include "rivals/point_tree.h"

namespace pcl_slim::borders {

/** \brief Closed chains of border edges: one a border, also where two of them share a vertex.
 * O(T log T). */
std::size_t countLoops(const TriangleMesh& mesh);

/** \brief Triangles less than a millionth as high as their longest edge is long. */
std::size_t countFlatTriangles(const TriangleMesh& mesh);

/** \brief Places of a mesh that are far from every point. */
struct FarPlaces {
  double farthest = 0.0;  ///< distance from a place to the point next to it
  double area = 0.0;      ///< of what is farther than the limit
};

/** \brief Looks at places no farther apart than about a unit of length. */
FarPlaces farPlaces(const TriangleMesh& mesh, const rivals::PointTree& tree,
                    const std::vector<Vector3>& points, double limit);

}  // namespace pcl_slim::borders

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/mesh/triangle_mesh.h"

/** \brief Triangles of meshes in small parts. */
namespace pcl_slim::borders {

inline Vector3 middleOf(const std::array<Vector3, 3>& t) {
  return scaled(along(along(t[0], 1.0, t[1]), 1.0, t[2]), 1.0 / 3.0);
}

inline double areaOf(const std::array<Vector3, 3>& t) {
  return 0.5 * length(cross(subtract(t[1], t[0]), subtract(t[2], t[0])));
}

/** \brief Calls use(corners) for the parts of a triangle, none with a longer edge than that. */
template <typename Use>
void forParts(const std::array<Vector3, 3>& corners, double edge, const Use& use) {
  std::size_t longest = 0;
  double most = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double size = length(subtract(corners[(k + 1) % 3], corners[k]));
    if (size <= most) continue;
    most = size;
    longest = k;
  }
  if (most <= edge) {
    use(corners);
    return;
  }
  const Vector3 &a = corners[longest], &b = corners[(longest + 1) % 3];
  const Vector3& c = corners[(longest + 2) % 3];
  const Vector3 middle = along(scaled(a, 0.5), 0.5, b);
  forParts({a, middle, c}, edge, use);
  forParts({middle, b, c}, edge, use);
}

/** \brief Calls use(corners) for the parts of all triangles of a mesh. */
template <typename Use>
void forParts(const TriangleMesh& mesh, double edge, const Use& use) {
  for (const auto& t : mesh.triangles) {
    forParts({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]}, edge, use);
  }
}

}  // namespace pcl_slim::borders

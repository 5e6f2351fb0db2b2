// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/mesh/triangle_mesh.h"

#include <algorithm>
#include <string>

namespace pcl_slim {

Error TriangleMesh::validate() const {
  const std::size_t n = vertices.size();
  const bool whole = normals.size() == n && k1.size() == n && k2.size() == n &&
                     (sigma.empty() || sigma.size() == n) && (colors.empty() || colors.size() == n);
  if (!whole) {
    return badInput("the mesh has " + std::to_string(n) +
                    " vertices and another number of normals, k1, k2, sigma or colours: give each "
                    "vertex one of each");
  }
  for (const auto& triangle : triangles) {
    const std::uint32_t last = *std::max_element(triangle.begin(), triangle.end());
    if (last < n) continue;
    return badInput("a triangle has vertex " + std::to_string(last) + " of " + std::to_string(n) +
                    ": correct it");
  }
  return {};
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "triangles/welding.h"

#include <string>

#include "pcl_slim/core/random.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

Error checkCorners(const TriangleMesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      if (v < n) continue;
      return badInput("a triangle has vertex " + std::to_string(v) + " of " + std::to_string(n) +
                      ": correct it");
    }
  }
  return {};
}

WeldedTriangles weld(const TriangleMesh& mesh) {
  constexpr std::uint32_t kFree = 0xffffffffu;
  const std::size_t n = mesh.vertices.size();
  WeldedTriangles welded;
  welded.vertex.resize(n);
  std::size_t slots = 16;
  while (slots < 2 * n) slots *= 2;
  std::vector<std::uint32_t> table(slots, kFree);  // first vertex at each place, open addressing
  for (std::uint32_t v = 0; v < n; ++v) {
    const Vector3& p = mesh.vertices[v];
    if (!isFinite(p)) {
      welded.vertex[v] = welded.num_vertices++;
      continue;
    }
    std::size_t slot = placeHash(p) & (slots - 1);
    while (table[slot] != kFree && mesh.vertices[table[slot]] != p) slot = (slot + 1) & (slots - 1);
    if (table[slot] == kFree) {
      table[slot] = v;
      welded.vertex[v] = welded.num_vertices++;
    } else {
      welded.vertex[v] = welded.vertex[table[slot]];
    }
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle corners;
    bool finite = true;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = welded.vertex[mesh.triangles[t][k]];
      finite = finite && isFinite(mesh.vertices[mesh.triangles[t][k]]);
    }
    const bool different =
        corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0];
    if (!finite || !different) continue;
    welded.triangles.push_back(corners);
    welded.original.push_back(t);
  }
  return welded;
}

}  // namespace pcl_slim::detail

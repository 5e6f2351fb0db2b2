// SPDX-License-Identifier: BSD-3-Clause
#include "topology/gaps.h"

#include <algorithm>

namespace pcl_slim::detail {

std::vector<std::vector<std::uint32_t>>
borderLoops(const std::vector<Triangle>& triangles, std::size_t num_vertices, int threads)
{
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> next(num_vertices, kNone);
  std::vector<bool> twice(num_vertices, false), seen(num_vertices, false);
  const EdgeTable table(triangles, threads);
  for (const MeshEdge& edge : table.edges) {
    if (edge.count != 1) continue;
    const std::uint32_t use = table.uses[edge.first];
    const std::uint32_t a = triangles[use / 3][use % 3], b = triangles[use / 3][(use % 3 + 1) % 3];
    // The triangle runs from a to b, what closes the gap from b to a.
    if (next[b] != kNone) twice[b] = true;
    next[b] = a;
  }
  std::vector<std::vector<std::uint32_t>> loops;
  for (std::uint32_t first = 0; first < num_vertices; ++first) {
    if (next[first] == kNone || seen[first]) continue;
    std::vector<std::uint32_t> loop;
    bool simple = true;
    std::uint32_t v = first;
    while (v != kNone && !seen[v]) {
      seen[v] = true;
      simple = simple && !twice[v];
      loop.push_back(v);
      v = next[v];
    }
    if (simple && v == first) loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace pcl_slim::detail

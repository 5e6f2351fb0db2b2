// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/mesh/triangle_mesh.h"

#include <algorithm>

#include "topology/fans.h"

namespace pcl_slim {

using namespace detail;

namespace {

void
countEdges(const TriangleMesh& mesh, const EdgeTable& table, MeshCensus& census)
{
  census.edges = table.edges.size();
  for (const MeshEdge& edge : table.edges) {
    census.border_edges += edge.count == 1 ? 1 : 0;
    census.nonmanifold_edges += edge.count > 2 ? 1 : 0;
    if (edge.count != 2) continue;
    const std::uint32_t a = table.uses[edge.first], b = table.uses[edge.first + 1];
    const bool same = mesh.triangles[a / 3][a % 3] == mesh.triangles[b / 3][b % 3];
    census.turned_edges += same ? 1 : 0;
  }
}

}  // namespace

MeshCensus
censusOf(const TriangleMesh& mesh)
{
  MeshCensus census;
  census.triangles = mesh.triangles.size();
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) used[v] = true;
  }
  census.vertices = static_cast<std::uint64_t>(std::count(used.begin(), used.end(), true));
  countEdges(mesh, EdgeTable(mesh.triangles, 1), census);
  census.euler = static_cast<std::int64_t>(census.vertices + census.triangles) -
                 static_cast<std::int64_t>(census.edges);
  std::size_t components = 0;
  componentsOf(mesh.triangles, mesh.vertices.size(), components);
  census.components = components;
  std::vector<Triangle> fans = mesh.triangles;
  std::vector<std::uint32_t> copies = separateFans(mesh.vertices.size(), fans, 1);
  std::sort(copies.begin(), copies.end());
  census.nonmanifold_vertices =
      static_cast<std::uint64_t>(std::unique(copies.begin(), copies.end()) - copies.begin());
  return census;
}

}  // namespace pcl_slim

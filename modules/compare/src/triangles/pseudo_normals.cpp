// SPDX-License-Identifier: BSD-3-Clause
#include "triangles/pseudo_normals.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pcl_slim::detail {

namespace {

std::array<float, 3> toFloat(const Vector3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

Vector3 toDouble(const std::array<float, 3>& v) {
  return {v[0], v[1], v[2]};
}

/** Sets of edges that flat triangles connect: the least of each set stands for it. */
class EdgeSets {
 public:
  explicit EdgeSets(std::size_t edges) : parent_(edges) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  std::uint32_t find(std::uint32_t e) {
    while (parent_[e] != e) e = parent_[e] = parent_[parent_[e]];
    return e;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/** The angle at corner k. */
double angleAt(const WeldedTriangles& welded, const std::vector<Vector3>& places, std::size_t t,
               std::size_t k) {
  const Triangle& corners = welded.triangles[t];
  const Vector3 a = subtract(places[corners[(k + 1) % 3]], places[corners[k]]);
  const Vector3 b = subtract(places[corners[(k + 2) % 3]], places[corners[k]]);
  return std::atan2(length(cross(a, b)), dot(a, b));
}

/** Sums the normals of each set of edges and finds the borders. */
void sumEdges(const EdgeTable& table, const std::vector<Triangle>& triangles,
              const std::vector<TriangleShape>& shapes, const std::vector<Vector3>& unit,
              EdgeSets& sets, PseudoNormals& made, TriangleIndexStatistics& statistics) {
  const auto edges = static_cast<std::uint32_t>(table.edges.size());
  std::vector<Vector3> sum(edges, Vector3{});
  std::vector<std::uint32_t> count(edges, 0);  // of triangles with a normal
  for (std::uint32_t e = 0; e < edges; ++e) {
    const std::uint32_t set = sets.find(e);
    const MeshEdge& edge = table.edges[e];
    std::uint32_t with_normal = 0, ascending = 0;
    for (std::uint32_t i = edge.first; i < edge.first + edge.count; ++i) {
      const std::uint32_t t = table.uses[i] / 3, k = table.uses[i] % 3;
      made.edge_of[t][k] = e;
      if (shapes[t] == TriangleShape::kFlat) continue;
      sum[set] = along(sum[set], 1, unit[t]);
      ++with_normal;
      if (triangles[t][k] == edge.low) ++ascending;
    }
    count[set] += with_normal;
    if (edge.count > 2) ++statistics.nonmanifold_edges;
    if (edge.count == 2 && with_normal == 2 && ascending != 1) ++statistics.turned_edges;
  }
  made.edge.resize(edges);
  made.edge_border.resize(edges);
  for (std::uint32_t e = 0; e < edges; ++e) {
    const std::uint32_t set = sets.find(e);
    made.edge[e] = toFloat(normalized(sum[set]));
    made.edge_border[e] = count[set] < 2;
    if (set == e && count[set] == 1) ++statistics.border_edges;
  }
}

}  // namespace

PseudoNormals pseudoNormals(const WeldedTriangles& welded, const std::vector<Vector3>& places,
                            const std::vector<TriangleShape>& shapes, int threads,
                            TriangleIndexStatistics& statistics) {
  const std::vector<Triangle>& triangles = welded.triangles;
  const EdgeTable table(triangles, threads);
  PseudoNormals made;
  made.edge_of.resize(triangles.size());
  std::vector<Vector3> unit(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Triangle& c = triangles[t];
    if (shapes[t] == TriangleShape::kFlat) continue;
    unit[t] = normalized(
        cross(subtract(places[c[1]], places[c[0]]), subtract(places[c[2]], places[c[0]])));
  }
  EdgeSets sets(table.edges.size());
  std::vector<std::uint32_t> first(triangles.size(), 0xffffffffu);
  for (std::uint32_t e = 0; e < table.edges.size(); ++e) {
    const MeshEdge& edge = table.edges[e];
    for (std::uint32_t i = edge.first; i < edge.first + edge.count; ++i) {
      const std::uint32_t t = table.uses[i] / 3;
      if (shapes[t] != TriangleShape::kFlat) continue;
      if (first[t] == 0xffffffffu) first[t] = e;
      sets.join(first[t], e);
    }
  }
  sumEdges(table, triangles, shapes, unit, sets, made, statistics);
  std::vector<Vector3> sum(welded.num_vertices, Vector3{});
  made.face.resize(triangles.size());
  made.vertex_border.assign(welded.num_vertices, 0);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const bool flat = shapes[t] == TriangleShape::kFlat;
    const Vector3 normal = flat ? toDouble(made.edge[made.edge_of[t][0]]) : unit[t];
    made.face[t] = toFloat(normal);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangles[t][k];
      sum[v] = along(sum[v], angleAt(welded, places, t, k), normal);
      if (made.edge_border[made.edge_of[t][k]] == 0) continue;
      made.vertex_border[v] = made.vertex_border[triangles[t][(k + 1) % 3]] = 1;
    }
  }
  made.vertex.resize(sum.size());
  for (std::size_t v = 0; v < sum.size(); ++v) made.vertex[v] = toFloat(normalized(sum[v]));
  return made;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/mesh/detail/mesh_topology.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "pcl_slim/cloud/detail/signed_graph.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/mesh/mesh_faces.h"
#include "pcl_slim/mesh/triangle_mesh.h"

namespace pcl_slim {

void MeshFaces::add(const std::uint32_t* first, std::size_t count) {
  if (begin.empty()) begin.push_back(0);
  corners.insert(corners.end(), first, first + count);
  begin.push_back(static_cast<std::uint32_t>(corners.size()));
}

Error MeshFaces::validate(std::size_t num_vertices) const {
  for (std::size_t f = 0; f < size(); ++f) {
    if (begin[f + 1] < begin[f] || begin[f + 1] > corners.size()) {
      return {ErrorCode::kBadInput, "face " + std::to_string(f) +
                                        " has offsets that do not ascend; make the faces again"};
    }
    for (const std::uint32_t vertex : (*this)[f]) {
      if (vertex < num_vertices) continue;
      return {ErrorCode::kBadInput, "face " + std::to_string(f) + " names vertex " +
                                        std::to_string(vertex) + " of " +
                                        std::to_string(num_vertices) + "; make the faces again"};
    }
  }
  return {};
}

Vector3 areaVector(const std::vector<Vector3>& vertices, IndexRow corners) {
  Vector3 area{};
  for (std::size_t k = 2; k < corners.size(); ++k) {
    const Vector3& o = vertices[corners[0]];
    const Vector3 part =
        cross(subtract(vertices[corners[k - 1]], o), subtract(vertices[corners[k]], o));
    area = along(area, 0.5, part);
  }
  return area;
}

Vector3 centroid(const std::vector<Vector3>& vertices, IndexRow corners) {
  Vector3 sum{};
  for (const std::uint32_t v : corners) sum = along(sum, 1.0, vertices[v]);
  return corners.size() > 0 ? scaled(sum, 1.0 / static_cast<double>(corners.size())) : sum;
}

MeshTopology::MeshTopology(const MeshFaces& faces, std::size_t num_vertices) {
  findFacesOfVertices(faces, num_vertices);
  findNeighbours(faces);
}

void MeshTopology::findFacesOfVertices(const MeshFaces& faces, std::size_t num_vertices) {
  vertex_begin_.assign(num_vertices + 1, 0);
  for (const std::uint32_t v : faces.corners) ++vertex_begin_[v + 1];
  for (std::size_t v = 0; v < num_vertices; ++v) vertex_begin_[v + 1] += vertex_begin_[v];
  std::vector<std::uint32_t> next(vertex_begin_.begin(), vertex_begin_.end() - 1);
  vertex_faces_.resize(faces.corners.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (const std::uint32_t v : faces[f]) vertex_faces_[next[v]++] = static_cast<std::uint32_t>(f);
  }
}

void MeshTopology::findNeighbours(const MeshFaces& faces) {
  edge_begin_.assign(1, 0);
  around_begin_.assign(1, 0);
  std::vector<std::uint32_t> near;
  const auto finish = [](std::vector<std::uint32_t>& begin, std::vector<std::uint32_t>& all) {
    const auto from = all.begin() + begin.back();
    std::sort(from, all.end());
    all.erase(std::unique(from, all.end()), all.end());
    begin.push_back(static_cast<std::uint32_t>(all.size()));
  };
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const IndexRow corners = faces[f];
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const IndexRow here = facesOf(corners[k]);
      const IndexRow next = facesOf(corners[(k + 1) % corners.size()]);
      for (const std::uint32_t g : here) {
        if (g == f) continue;
        around_faces_.push_back(g);
        if (std::binary_search(next.begin(), next.end(), g)) edge_faces_.push_back(g);
      }
    }
    finish(edge_begin_, edge_faces_);
    finish(around_begin_, around_faces_);
  }
}

}  // namespace pcl_slim

namespace pcl_slim::detail {

namespace {

/** Ends of an edge, the lower first, and whether a face runs from the higher to the lower. */
struct HalfEdge {
  std::uint32_t low, high;
  bool back;

  bool sameEdge(const HalfEdge& other) const { return low == other.low && high == other.high; }
};

std::vector<HalfEdge> sortedHalfEdges(const MeshFaces& faces) {
  std::vector<HalfEdge> edges;
  edges.reserve(faces.corners.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const IndexRow corners = faces[f];
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::uint32_t a = corners[k], b = corners[(k + 1) % corners.size()];
      edges.push_back({std::min(a, b), std::max(a, b), a > b});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return a.low != b.low ? a.low < b.low : a.high < b.high;
  });
  return edges;
}

std::uint32_t findRoot(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

void joinRoots(std::vector<std::uint32_t>& parent, std::uint32_t a, std::uint32_t b) {
  a = findRoot(parent, a);
  b = findRoot(parent, b);
  parent[std::max(a, b)] = std::min(a, b);
}

/** The corner of triangle t, 3 t + k, that is vertex v. */
std::uint32_t cornerAt(const std::vector<Triangle>& triangles, std::uint32_t t, std::uint32_t v) {
  const Triangle& own = triangles[t];
  return 3 * t + (own[0] == v ? 0 : own[1] == v ? 1 : 2);
}

}  // namespace

void countEdges(const MeshFaces& faces, std::uint64_t& disagreeing, std::uint64_t& nonmanifold) {
  disagreeing = nonmanifold = 0;
  const std::vector<HalfEdge> edges = sortedHalfEdges(faces);
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    while (end < edges.size() && edges[end].sameEdge(edges[i])) ++end;
    nonmanifold += end - i > 2;
    disagreeing += end - i == 2 && edges[i].back == edges[i + 1].back;
  }
}

EdgeTable::EdgeTable(const std::vector<Triangle>& triangles, int threads) {
  AlignedVector<std::uint64_t> keys(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      keys[3 * t + k] = static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
    }
  }
  AlignedVector<std::uint32_t> order;
  sortByKey(keys, order, threads);
  uses.assign(order.begin(), order.end());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (i == 0 || keys[i] != keys[i - 1]) {
      edges.push_back({static_cast<std::uint32_t>(keys[i] >> 32),
                       static_cast<std::uint32_t>(keys[i]), static_cast<std::uint32_t>(i), 0});
    }
    ++edges.back().count;
  }
}

std::vector<std::uint32_t> separateFans(std::size_t num_vertices, std::vector<Triangle>& triangles,
                                        int threads) {
  std::vector<std::uint32_t> parent(3 * triangles.size(), 0);
  std::iota(parent.begin(), parent.end(), 0u);
  const EdgeTable table(triangles, threads);
  for (const MeshEdge& edge : table.edges) {
    if (edge.count != 2) continue;
    const std::uint32_t a = table.uses[edge.first] / 3, b = table.uses[edge.first + 1] / 3;
    for (const std::uint32_t v : {edge.low, edge.high}) {
      joinRoots(parent, cornerAt(triangles, a, v), cornerAt(triangles, b, v));
    }
  }
  constexpr std::uint32_t kFree = 0xffffffffu;
  std::vector<std::uint32_t> copies, first(num_vertices, kFree);
  std::vector<std::uint32_t> number(parent.size(), 0);
  std::vector<Triangle> made = triangles;
  for (std::uint32_t i = 0; i < parent.size(); ++i) {
    const std::uint32_t v = triangles[i / 3][i % 3], root = findRoot(parent, i);
    if (root == i) {
      number[i] = v;
      if (first[v] != kFree) {
        number[i] = static_cast<std::uint32_t>(num_vertices + copies.size());
        copies.push_back(v);
      }
      first[v] = i;
    }
    made[i / 3][i % 3] = number[root];
  }
  triangles = std::move(made);
  return copies;
}

std::vector<std::uint8_t> agreeOnSides(std::vector<Triangle>& triangles, int threads) {
  // Small regions are errors of the contour, large ones have their side from the surface.
  constexpr double kOwnSide = 0.05;  // weight of a triangle's own side [edge of the border]
  const EdgeTable table(triangles, threads);
  SignedRegions regions(triangles.size());
  std::vector<SignedEdge> edges;  // between triangles that disagree
  for (const MeshEdge& edge : table.edges) {
    if (edge.count != 2) continue;
    const std::uint32_t a = table.uses[edge.first], b = table.uses[edge.first + 1];
    // Agreeing neighbours run along their edge in opposite directions.
    if (triangles[a / 3][a % 3] == triangles[b / 3][b % 3])
      edges.push_back({a / 3, b / 3, -1});
    else
      regions.join(a / 3, b / 3);
  }
  std::vector<std::uint8_t> turned(triangles.size(), 0);
  if (edges.empty()) return turned;
  std::vector<double> votes(regions.number(), 0.0);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) votes[regions.of(t)] += kOwnSide;
  std::vector<SignedEdge> between;
  for (const SignedEdge& e : edges) {
    const std::uint32_t a = regions.of(e.a), b = regions.of(e.b);
    if (a != b) between.push_back({a, b, e.agreement});
  }
  const std::vector<signed char> signs = signsByVotes(std::move(between), votes);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (signs[regions.of(t)] > 0) continue;
    turned[t] = 1;
    std::swap(triangles[t][1], triangles[t][2]);
  }
  return turned;
}

void dropTurned(std::vector<Triangle>& triangles, int threads) {
  const EdgeTable table(triangles, threads);
  std::vector<bool> dropped(triangles.size(), false);
  bool any = false;
  for (const MeshEdge& edge : table.edges) {
    if (edge.count != 2) continue;
    const std::uint32_t a = table.uses[edge.first], b = table.uses[edge.first + 1];
    if (triangles[a / 3][a % 3] != triangles[b / 3][b % 3] || dropped[a / 3]) continue;
    dropped[b / 3] = any = true;
  }
  if (!any) return;
  std::vector<Triangle> kept;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!dropped[t]) kept.push_back(triangles[t]);
  }
  triangles = std::move(kept);
}

void keepAlive(const std::vector<bool>& alive, std::vector<Triangle>& triangles) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (alive[t]) triangles[kept++] = triangles[t];
  }
  triangles.resize(kept);
}

std::vector<std::uint32_t> componentsOf(const std::vector<Triangle>& triangles,
                                        std::size_t num_vertices, std::size_t& count) {
  std::vector<std::uint32_t> parent(num_vertices, 0);
  std::iota(parent.begin(), parent.end(), 0u);
  for (const Triangle& t : triangles) {
    joinRoots(parent, t[0], t[1]);
    joinRoots(parent, t[0], t[2]);
  }
  constexpr std::uint32_t kFree = 0xffffffffu;
  std::vector<std::uint32_t> number(num_vertices, kFree), component(triangles.size());
  count = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    std::uint32_t& own = number[findRoot(parent, triangles[t][0])];
    if (own == kFree) own = static_cast<std::uint32_t>(count++);
    component[t] = own;
  }
  return component;
}

}  // namespace pcl_slim::detail

namespace pcl_slim {

using namespace detail;

namespace {

void countEdges(const TriangleMesh& mesh, const EdgeTable& table, MeshCensus& census) {
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

MeshCensus censusOf(const TriangleMesh& mesh) {
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

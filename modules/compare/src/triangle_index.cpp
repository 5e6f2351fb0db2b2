// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/compare/triangle_index.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcl_slim/core/parallel.h"
#include "place_order.h"
#include "tree/box_tree.h"
#include "triangles/closest_point.h"
#include "triangles/pseudo_normals.h"
#include "triangles/welding.h"

namespace pcl_slim {

using namespace detail;

/** Triangles in the order of the tree; places are relative to the middle of the mesh. */
struct TriangleIndex::Data {
  TriangleIndexStatistics statistics;
  Bounds bounds;
  Vector3 middle{};
  BoxTree tree;
  std::vector<PlacedTriangle> triangles;
  std::vector<TriangleShape> shapes;
  std::vector<std::array<std::uint32_t, 3>> corners;  ///< welded vertices
  std::vector<std::uint32_t> original;                ///< numbers in the mesh
  std::vector<std::uint32_t> placed;                  ///< of the mesh's triangles: numbers here
  PseudoNormals normals;

  void build(const TriangleMesh& mesh, const WeldedTriangles& welded, int threads);
  void sortByTree(const std::vector<std::uint32_t>& order, const WeldedTriangles& welded);
  TriangleFoot footOf(const Vector3& local, std::uint32_t t, const ClosestPoint& closest) const;
};

void TriangleIndex::Data::build(const TriangleMesh& mesh, const WeldedTriangles& welded,
                                int threads) {
  for (std::size_t a = 0; a < 3; ++a) middle[a] = 0.5 * bounds.low[a] + 0.5 * bounds.high[a];
  std::vector<Vector3> places(welded.num_vertices, Vector3{});
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    places[welded.vertex[v]] = subtract(mesh.vertices[v], middle);
  }
  const std::size_t count = welded.triangles.size();
  triangles.resize(count);
  shapes.resize(count);
  parallelFor(count, threads, 4096, [&](std::size_t t, int) {
    for (std::size_t k = 0; k < 3; ++k) triangles[t].corner[k] = places[welded.triangles[t][k]];
    shapes[t] = shapeOf(triangles[t]);
  });
  normals = pseudoNormals(welded, places, shapes, threads, statistics);
  std::vector<TreeItem> items(count);
  parallelFor(count, threads, 4096, [&](std::size_t t, int) {
    TreeItem& item = items[t];
    for (std::size_t a = 0; a < 3; ++a) {
      item.low[a] = item.high[a] = static_cast<float>(triangles[t].corner[0][a]);
    }
    for (const Vector3& corner : triangles[t].corner) item.add(corner);
    item.axis = normals.face[t];
    // Flat triangles without neighbours have no side.
    const bool none = item.axis[0] == 0 && item.axis[1] == 0 && item.axis[2] == 0;
    item.sine = none ? 1.0f : 0.0f;
  });
  tree = BoxTree(items);
  sortByTree(tree.order(), welded);
  statistics.triangles = mesh.triangles.size();
  statistics.dropped = mesh.triangles.size() - count;
  statistics.vertices = welded.num_vertices;
  for (std::size_t t = 0; t < count; ++t) {
    if (shapes[t] == TriangleShape::kFlat) ++statistics.flat;
    const auto& c = triangles[t].corner;
    statistics.volume += dot(c[0], cross(c[1], c[2])) / 6;
  }
  placed.assign(mesh.triangles.size(), TriangleFoot::kNone);
  for (std::uint32_t t = 0; t < count; ++t) placed[original[t]] = t;
}

void TriangleIndex::Data::sortByTree(const std::vector<std::uint32_t>& order,
                                     const WeldedTriangles& welded) {
  const std::size_t count = order.size();
  std::vector<PlacedTriangle> sorted(count);
  std::vector<TriangleShape> sorted_shapes(count);
  std::vector<std::array<float, 3>> faces(count);
  std::vector<std::array<std::uint32_t, 3>> edges(count);
  corners.resize(count);
  original.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    sorted[i] = triangles[order[i]];
    sorted_shapes[i] = shapes[order[i]];
    faces[i] = normals.face[order[i]];
    edges[i] = normals.edge_of[order[i]];
    corners[i] = welded.triangles[order[i]];
    original[i] = welded.original[order[i]];
  }
  triangles = std::move(sorted);
  shapes = std::move(sorted_shapes);
  normals.face = std::move(faces);
  normals.edge_of = std::move(edges);
}

TriangleFoot TriangleIndex::Data::footOf(const Vector3& local, std::uint32_t t,
                                         const ClosestPoint& closest) const {
  TriangleFoot foot;
  foot.triangle = original[t];
  foot.weights = closest.weights;
  for (std::size_t a = 0; a < 3; ++a) foot.position[a] = closest.position[a] + middle[a];
  const std::array<float, 3>* normal = &normals.face[t];
  if (isEdge(closest.part)) {
    const std::uint32_t e = normals.edge_of[t][edgeOf(closest.part)];
    foot.part = TrianglePart::kEdge;
    foot.border = normals.edge_border[e] != 0;
    normal = &normals.edge[e];
  } else if (isCorner(closest.part)) {
    const std::uint32_t v = corners[t][cornerOf(closest.part)];
    foot.part = TrianglePart::kVertex;
    foot.border = normals.vertex_border[v] != 0;
    normal = &normals.vertex[v];
  }
  foot.normal = {(*normal)[0], (*normal)[1], (*normal)[2]};
  if (closest.part == Part::kFace) {
    const auto& c = triangles[t].corner;
    foot.normal = normalized(cross(subtract(c[1], c[0]), subtract(c[2], c[0])));
  }
  const double distance = std::sqrt(closest.distance_sq);
  const bool behind = dot(subtract(local, closest.position), foot.normal) < 0;
  foot.distance = behind ? -distance : distance;
  return foot;
}

TriangleIndex::TriangleIndex(std::unique_ptr<Data> data) : data_(std::move(data)) {}
TriangleIndex::TriangleIndex(TriangleIndex&&) noexcept = default;
TriangleIndex& TriangleIndex::operator=(TriangleIndex&&) noexcept = default;
TriangleIndex::~TriangleIndex() = default;

Result<TriangleIndex> TriangleIndex::make(const TriangleMesh& mesh, int threads,
                                          Progress* progress) {
  if (Error error = checkThreads(threads)) return error;
  if (Error error = checkCorners(mesh)) return error;
  const WeldedTriangles welded = weld(mesh);
  if (welded.triangles.empty()) {
    return badInput(
        "the mesh has no triangle with three different finite corners: give one that has a "
        "surface");
  }
  Bounds box;
  for (const std::uint32_t t : welded.original) {
    for (const std::uint32_t v : mesh.triangles[t]) box.add(mesh.vertices[v]);
  }
  constexpr double kWidest = 1e18;  // its square is a float
  if (!(box.diagonal() < kWidest)) {
    return badInput("the mesh is more than 1e18 units wide: drop the vertices that are far away");
  }
  if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
  auto data = std::make_unique<Data>();
  data->bounds = box;
  data->build(mesh, welded, resolveThreads(threads));
  if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
  return TriangleIndex(std::move(data));
}

const TriangleIndexStatistics& TriangleIndex::statistics() const {
  return data_->statistics;
}

const Bounds& TriangleIndex::bounds() const {
  return data_->bounds;
}

std::size_t TriangleIndex::memoryBytes() const {
  const Data& d = *data_;
  const std::size_t triangle = sizeof(PlacedTriangle) + sizeof(TriangleShape) +
                               2 * sizeof(std::array<std::uint32_t, 3>) + sizeof(std::uint32_t) +
                               sizeof(std::array<float, 3>);
  const std::size_t normal = sizeof(std::array<float, 3>) + 1;
  return d.tree.memoryBytes() + d.triangles.size() * triangle +
         d.placed.size() * sizeof(std::uint32_t) +
         (d.normals.edge.size() + d.normals.vertex.size()) * normal;
}

TriangleFoot TriangleIndex::nearest(const Vector3& place, double most_distance, const Vector3* side,
                                    std::uint32_t hint) const {
  const Data& d = *data_;
  const Vector3 local = subtract(place, d.middle);
  ClosestPoint best;
  best.distance_sq = Bounds::kInfinity;
  double bound = most_distance;
  std::uint32_t found = TriangleFoot::kNone;
  const auto visit = [&](std::uint32_t t) {
    if (side) {
      const auto& n = d.normals.face[t];
      if (!(dot({n[0], n[1], n[2]}, *side) > 0)) return bound;
    }
    const ClosestPoint here = closestPoint(d.triangles[t], d.shapes[t], local);
    if (here.distance_sq < best.distance_sq) {
      const double distance = std::sqrt(here.distance_sq);
      if (distance <= bound) {
        best = here;
        found = t;
        bound = distance;
      }
    }
    return bound;
  };
  if (hint < d.placed.size() && d.placed[hint] != TriangleFoot::kNone) visit(d.placed[hint]);
  d.tree.search(local, side, bound, visit);
  if (found == TriangleFoot::kNone) return {};
  return d.footOf(local, found, best);
}

std::vector<TriangleFoot> TriangleIndex::nearest(const std::vector<Vector3>& places,
                                                 double most_distance,
                                                 const std::vector<Vector3>& sides,
                                                 int threads) const {
  threads = resolveThreads(threads);
  std::vector<TriangleFoot> feet(places.size());
  std::size_t finite = 0;
  const auto order = mortonOrder(places.data(), places.size(), threads, finite);
  parallelFor((finite + kRun - 1) / kRun, threads, 1, [&](std::size_t run, int) {
    std::uint32_t hint = TriangleFoot::kNone;
    for (std::size_t j = run * kRun; j < std::min(finite, (run + 1) * kRun); ++j) {
      const std::uint32_t i = order[j];
      const Vector3* side = sides.empty() ? nullptr : &sides[i];
      feet[i] = nearest(places[i], most_distance, side, hint);
      if (feet[i].found()) hint = feet[i].triangle;
    }
  });
  return feet;
}

}  // namespace pcl_slim

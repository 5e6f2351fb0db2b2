// SPDX-License-Identifier: BSD-3-Clause
#include "vertices/surface_vertices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <queue>

#include "pcl_slim/core/symmetric.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

namespace {

/** Sum of squared distances to planes, weighed: p^T A p + 2 b p + c. */
struct Quadric {
  Symmetric3<double> a{};
  Vector3 b{};
  double c = 0;

  /** Adds the plane through a place across a unit normal. */
  void addPlane(const Vector3& normal, const Vector3& place, double weight) {
    const double d = -dot(normal, place);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = i; j < 3; ++j) {
        a[kSymmetricEntry[i][j]] += weight * normal[i] * normal[j];
      }
      b[i] += weight * d * normal[i];
    }
    c += weight * d * d;
  }

  void add(const Quadric& other) {
    for (std::size_t k = 0; k < a.size(); ++k) a[k] += other.a[k];
    for (std::size_t i = 0; i < 3; ++i) b[i] += other.b[i];
    c += other.c;
  }

  double at(const Vector3& p) const {
    return std::max(0.0, dot(p, multiplied(a, p)) + 2 * dot(b, p) + c);
  }

  /** The place of least value. \return false where the planes do not determine one. */
  bool least(Vector3& p) const {
    const Vector3 x = {a[kXX], a[kXY], a[kXZ]}, y = {a[kXY], a[kYY], a[kYZ]},
                  z = {a[kXZ], a[kYZ], a[kZZ]};
    const Vector3 yz = cross(y, z), zx = cross(z, x), xy = cross(x, y);
    const double determinant = dot(x, yz), trace = a[kXX] + a[kYY] + a[kZZ];
    if (!(std::abs(determinant) > 1e-6 * trace * trace * trace)) return false;
    for (std::size_t i = 0; i < 3; ++i) {
      p[i] = -(b[0] * yz[i] + b[1] * zx[i] + b[2] * xy[i]) / determinant;
    }
    return true;
  }
};

constexpr double kBorderWeight = 10;  ///< of the planes that keep borders, over those of triangles
constexpr double kLeastFacing = 0.2;  ///< cosine of a triangle's normals before and after

/** An edge that may be collapsed, with its ends as they were. */
struct Candidate {
  double cost;
  std::uint32_t a, b, stamp_a, stamp_b;
  Vector3 place;

  /** The queue's top is the least: ties by numbers, so that the result is the same everywhere. */
  bool operator<(const Candidate& other) const {
    if (cost != other.cost) return cost > other.cost;
    return a != other.a ? a > other.a : b > other.b;
  }
};

class Collapser {
 public:
  Collapser(std::vector<Triangle>& triangles, SurfaceVertices& vertices)
      : triangles_(triangles),
        vertices_(vertices),
        alive_(triangles.size(), true),
        left_(triangles.size()),
        fans_(vertices.count()),
        quadrics_(vertices.count()),
        stamps_(vertices.count(), 0) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      for (const std::uint32_t v : triangles[t]) fans_[v].push_back(t);
    }
    for (std::uint32_t t = 0; t < triangles.size(); ++t) addQuadrics(t);
    for (std::uint32_t v = 0; v < fans_.size(); ++v) {
      for (const std::uint32_t o : neighbours(v)) {
        if (v < o) propose(v, o);
      }
    }
  }

  void run(std::size_t most) {
    while (left_ > most && !queue_.empty()) {
      const Candidate best = queue_.top();
      queue_.pop();
      if (best.stamp_a != stamps_[best.a] || best.stamp_b != stamps_[best.b]) continue;
      if (mayCollapse(best)) collapse(best);
    }
    keepAlive(alive_, triangles_);
  }

 private:
  const Vector3& at(std::uint32_t v) const { return vertices_.position[v]; }

  Vector3 areaOf(const Triangle& t) const {
    return cross(subtract(at(t[1]), at(t[0])), subtract(at(t[2]), at(t[0])));
  }

  /** The planes of a triangle, and those across it through its edges on the border. */
  void addQuadrics(std::uint32_t t) {
    const Vector3 area = areaOf(triangles_[t]);
    const double size = length(area);
    if (!(size > 0)) return;
    const Vector3 normal = scaled(area, 1 / size);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles_[t][k], b = triangles_[t][(k + 1) % 3];
      quadrics_[a].addPlane(normal, at(a), size);
      if (trianglesAt(a, b) != 1) continue;
      const Vector3 along_edge = subtract(at(b), at(a));
      const Vector3 outwards = normalized(cross(along_edge, normal));
      const double weight = kBorderWeight * dot(along_edge, along_edge);
      quadrics_[a].addPlane(outwards, at(a), weight);
      quadrics_[b].addPlane(outwards, at(a), weight);
    }
  }

  static bool has(const Triangle& t, std::uint32_t v) {
    return t[0] == v || t[1] == v || t[2] == v;
  }

  /** Triangles that have both vertices. */
  std::size_t trianglesAt(std::uint32_t a, std::uint32_t b) const {
    return static_cast<std::size_t>(std::count_if(
        fans_[a].begin(), fans_[a].end(), [&](std::uint32_t t) { return has(triangles_[t], b); }));
  }

  /** Vertices connected to one, ascending. */
  std::vector<std::uint32_t> neighbours(std::uint32_t v) const {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t t : fans_[v]) {
      for (const std::uint32_t o : triangles_[t]) {
        if (o != v) found.push_back(o);
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  bool onBorder(std::uint32_t v) const { return neighbours(v).size() != fans_[v].size(); }

  void propose(std::uint32_t a, std::uint32_t b) {
    Quadric sum = quadrics_[a];
    sum.add(quadrics_[b]);
    const Vector3 middle = along(at(a), 0.5, subtract(at(b), at(a)));
    const double reach = length(subtract(at(b), at(a)));
    Candidate made{0, a, b, stamps_[a], stamps_[b], middle};
    Vector3 best;
    if (sum.least(best) && length(subtract(best, middle)) < reach) {
      made.place = best;
    } else if (sum.at(at(a)) < sum.at(middle)) {
      made.place = at(a);
    } else if (sum.at(at(b)) < sum.at(middle)) {
      made.place = at(b);
    }
    // Among edges of no error, as on a plane, the shortest comes first.
    made.cost = sum.at(made.place) + 1e-12 * reach * reach * reach * reach;
    queue_.push(made);
  }

  /** Whether the mesh stays a manifold of the same kind, with no triangle turned over. */
  bool mayCollapse(const Candidate& edge) const {
    const auto of_a = neighbours(edge.a), of_b = neighbours(edge.b);
    std::vector<std::uint32_t> common;
    std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(),
                          std::back_inserter(common));
    const std::size_t shared = trianglesAt(edge.a, edge.b);
    if (common.size() != shared || of_a.size() + of_b.size() < shared + 5) return false;
    if (shared == 2 && onBorder(edge.a) && onBorder(edge.b)) return false;
    return staysUpright(edge.a, edge.b, edge.place) && staysUpright(edge.b, edge.a, edge.place);
  }

  /** Whether the triangles of v, but for those at the other end, face the same way with v moved. */
  bool staysUpright(std::uint32_t v, std::uint32_t other, const Vector3& place) const {
    for (const std::uint32_t t : fans_[v]) {
      if (has(triangles_[t], other)) continue;
      Vector3 corner[3];
      for (std::size_t k = 0; k < 3; ++k) {
        corner[k] = triangles_[t][k] == v ? place : at(triangles_[t][k]);
      }
      const Vector3 before = areaOf(triangles_[t]);
      const Vector3 after = cross(subtract(corner[1], corner[0]), subtract(corner[2], corner[0]));
      if (!(dot(before, after) > kLeastFacing * length(before) * length(after))) return false;
    }
    return true;
  }

  void collapse(const Candidate& edge) {
    const std::uint32_t a = edge.a, b = edge.b;
    vertices_.size[a] = std::max(
        {vertices_.size[a], vertices_.size[b], static_cast<float>(length(subtract(at(a), at(b))))});
    vertices_.position[a] = edge.place;
    const Vector3 normal = along(vertices_.normal[a], 1, vertices_.normal[b]);
    if (length(normal) > 0) vertices_.normal[a] = normalized(normal);
    quadrics_[a].add(quadrics_[b]);
    for (const std::uint32_t t : fans_[b]) {
      if (has(triangles_[t], a)) {
        alive_[t] = false;
        --left_;
        continue;
      }
      for (std::uint32_t& v : triangles_[t]) v = v == b ? a : v;
      fans_[a].push_back(t);
    }
    fans_[b].clear();
    for (const std::uint32_t o : neighboursOfDying(a)) dropDead(o);
    dropDead(a);
    ++stamps_[a];
    ++stamps_[b];
    for (const std::uint32_t o : neighbours(a)) propose(std::min(a, o), std::max(a, o));
  }

  /** Vertices of the triangles of a that are no more. */
  std::vector<std::uint32_t> neighboursOfDying(std::uint32_t a) const {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t t : fans_[a]) {
      if (alive_[t]) continue;
      for (const std::uint32_t v : triangles_[t]) {
        if (v != a) found.push_back(v);
      }
    }
    return found;
  }

  void dropDead(std::uint32_t v) {
    auto& fan = fans_[v];
    fan.erase(std::remove_if(fan.begin(), fan.end(), [&](std::uint32_t t) { return !alive_[t]; }),
              fan.end());
  }

  std::vector<Triangle>& triangles_;
  SurfaceVertices& vertices_;
  std::vector<bool> alive_;
  std::size_t left_;
  std::vector<std::vector<std::uint32_t>> fans_;  ///< triangles about each vertex
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> stamps_;  ///< rise whenever a vertex changes
  std::priority_queue<Candidate> queue_;
};

}  // namespace

void collapseEdges(std::size_t most_triangles, std::vector<Triangle>& triangles,
                   SurfaceVertices& vertices) {
  if (triangles.size() > most_triangles) Collapser(triangles, vertices).run(most_triangles);
}

}  // namespace pcl_slim::detail

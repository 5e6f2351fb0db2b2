// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "vertices/surface_vertices.h"

namespace pcl_slim::detail {

namespace {

constexpr double kFlat = 2e-3;   ///< height over longest edge of a triangle without area
constexpr double kTiny = 1e-3;   ///< longest edge over the mesh's mean edge of one
constexpr double kNeedle = 0.3;  ///< shortest over longest edge below which that is collapsed first
constexpr double kLift = 0.02;   ///< of the longest edge: a corner that is moved off it
constexpr double kTurn = 0.9;    ///< least cosine of the normals of triangles before and after
constexpr double kOffPlane = 0.3;  ///< of the way
constexpr int kMostPasses = 10;

class Cleaner {
 public:
  Cleaner(std::vector<Triangle>& triangles, SurfaceVertices& vertices)
      : triangles_(triangles), vertices_(vertices) {}

  void run() {
    double sum = 0;
    for (const Triangle& t : triangles_) sum += length(edge(t, 0));
    tiny_ = kTiny * sum / static_cast<double>(std::max<std::size_t>(1, triangles_.size()));
    std::vector<std::uint32_t> flat;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (isFlat(triangles_[t])) flat.push_back(t);
    }
    if (flat.empty() && !hasTips()) return;
    buildFans();
    for (int pass = 0; pass < kMostPasses && !flat.empty(); ++pass) {
      touched_.clear();
      for (const std::uint32_t t : flat) {
        if (alive_[t] && isFlat(triangles_[t])) repair(t);
      }
      flat.clear();
      std::sort(touched_.begin(), touched_.end());
      touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
      for (const std::uint32_t t : touched_) {
        if (alive_[t] && isFlat(triangles_[t])) flat.push_back(t);
      }
    }
    dropSpurs();
    keepAlive(alive_, triangles_);
  }

 private:
  const Vector3& at(std::uint32_t v) const { return vertices_.position[v]; }
  Vector3 edge(const Triangle& t, std::size_t k) const {
    return subtract(at(t[(k + 1) % 3]), at(t[k]));
  }
  Vector3 areaOf(const Triangle& t) const { return cross(edge(t, 0), edge(t, 1)); }

  /** The corner at which the longest (or shortest) edge begins. */
  std::size_t extremeEdge(const Triangle& t, bool longest) const {
    std::size_t best = 0;
    for (std::size_t k = 1; k < 3; ++k) {
      const double own = length(edge(t, k)), other = length(edge(t, best));
      if (longest ? own > other : own < other) best = k;
    }
    return best;
  }

  bool isFlat(const Triangle& t) const {
    const double longest = length(edge(t, extremeEdge(t, true)));
    return longest <= tiny_ || length(areaOf(t)) <= kFlat * longest * longest;
  }

  /** Whether some vertex is a corner of one triangle only. */
  bool hasTips() const {
    std::vector<std::uint32_t> count(vertices_.count(), 0);
    for (const Triangle& t : triangles_) {
      for (const std::uint32_t v : t) ++count[v];
    }
    return std::find(count.begin(), count.end(), 1u) != count.end();
  }

  void buildFans() {
    alive_.assign(triangles_.size(), true);
    begin_.assign(vertices_.count() + 1, 0);
    for (const Triangle& t : triangles_) {
      for (const std::uint32_t v : t) ++begin_[v + 1];
    }
    for (std::size_t v = 1; v < begin_.size(); ++v) begin_[v] += begin_[v - 1];
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    fans_.resize(begin_.back());
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      for (const std::uint32_t v : triangles_[t]) fans_[next[v]++] = t;
    }
    // Fans that change get a row of their own.
    changed_.assign(vertices_.count(), kNone);
  }

  /** The triangles about a vertex, until its fan changes. */
  struct Fan {
    const std::uint32_t *first, *last;
    const std::uint32_t* begin() const { return first; }
    const std::uint32_t* end() const { return last; }
    std::size_t size() const { return static_cast<std::size_t>(last - first); }
  };

  Fan fanOf(std::uint32_t v) const {
    if (changed_[v] == kNone) return {fans_.data() + begin_[v], fans_.data() + begin_[v + 1]};
    const auto& row = rows_[changed_[v]];
    return {row.data(), row.data() + row.size()};
  }
  std::vector<std::uint32_t>& changeFan(std::uint32_t v) {
    if (changed_[v] == kNone) {
      const Fan fan = fanOf(v);
      changed_[v] = static_cast<std::uint32_t>(rows_.size());
      rows_.emplace_back(fan.begin(), fan.end());
    }
    return rows_[changed_[v]];
  }
  void leaveFan(std::uint32_t v, std::uint32_t t) {
    auto& fan = changeFan(v);
    fan.erase(std::remove(fan.begin(), fan.end(), t), fan.end());
  }

  static bool has(const Triangle& t, std::uint32_t v) {
    return t[0] == v || t[1] == v || t[2] == v;
  }

  /** Triangles at an edge. */
  std::vector<std::uint32_t> atEdge(std::uint32_t a, std::uint32_t b) const {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t t : fanOf(a)) {
      if (has(triangles_[t], b)) found.push_back(t);
    }
    return found;
  }

  std::vector<std::uint32_t> neighbours(std::uint32_t v) const {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t t : fanOf(v)) {
      for (const std::uint32_t o : triangles_[t]) {
        if (o != v) found.push_back(o);
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  bool onBorder(std::uint32_t v) const { return neighbours(v).size() != fanOf(v).size(); }

  void repair(std::uint32_t t) {
    const Triangle own = triangles_[t];
    const std::size_t shortest = extremeEdge(own, false), longest = extremeEdge(own, true);
    const std::uint32_t a = own[shortest], b = own[(shortest + 1) % 3];
    const bool needle = length(edge(own, shortest)) <= kNeedle * length(edge(own, longest)) ||
                        length(edge(own, longest)) <= tiny_;
    if (needle && (collapse(a, b) || collapse(b, a))) return;
    if (flip(t, longest) || collapse(a, b) || collapse(b, a)) return;
    lift(t, longest);
  }

  /** Whether the triangles of v, but for those at `but`, keep their side with v moved to a place.
   * \param[in] least cosine of their normals before and after */
  bool mayMove(std::uint32_t v, std::uint32_t but, const Vector3& place, double least) const {
    for (const std::uint32_t t : fanOf(v)) {
      const Triangle& own = triangles_[t];
      if (but != kNone && has(own, but)) continue;
      Vector3 corner[3];
      for (std::size_t k = 0; k < 3; ++k) corner[k] = own[k] == v ? place : at(own[k]);
      const Vector3 after = cross(subtract(corner[1], corner[0]), subtract(corner[2], corner[0]));
      const Vector3 before = areaOf(own);
      if (!isFlat(own) && !(dot(before, after) > least * length(before) * length(after)))
        return false;
    }
    return true;
  }

  /** Whether a place is off the plane of a triangle of v: going there would round off an edge or a
   * corner. */
  bool leavesPlanes(std::uint32_t v, const Vector3& place) const {
    const Vector3 step = subtract(place, at(v));
    const double most = std::max(tiny_, kOffPlane * length(step));
    for (const std::uint32_t t : fanOf(v)) {
      const Vector3 area = areaOf(triangles_[t]);
      if (!isFlat(triangles_[t]) && std::abs(dot(area, step)) > most * length(area)) return true;
    }
    return false;
  }

  /** Joins b to a, if the mesh stays a manifold of the same kind and no triangle turns over. */
  bool collapse(std::uint32_t a, std::uint32_t b) {
    const auto of_a = neighbours(a), of_b = neighbours(b);
    std::vector<std::uint32_t> common;
    std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(),
                          std::back_inserter(common));
    const auto shared = atEdge(a, b);
    if (common.size() != shared.size() || of_a.size() + of_b.size() < shared.size() + 5)
      return false;
    if (leavesPlanes(b, at(a))) return false;
    const bool b_on_border = onBorder(b);
    if (b_on_border && (shared.size() == 2 || !onBorder(a))) return false;
    if (!mayMove(b, a, at(a), kTurn)) return false;
    for (const std::uint32_t t : shared) remove(t);
    auto& joined = changeFan(a);
    for (const std::uint32_t t : fanOf(b)) {
      for (std::uint32_t& v : triangles_[t]) v = v == b ? a : v;
      joined.push_back(t);
      touched_.push_back(t);
    }
    changeFan(b).clear();
    return true;
  }

  void remove(std::uint32_t t) {
    alive_[t] = false;
    for (const std::uint32_t v : triangles_[t]) leaveFan(v, t);
  }

  /** Puts the edge from corner k of a triangle across its quadrilateral, or takes the triangle away
   * where that edge is on the border and its other corner is not. */
  bool flip(std::uint32_t t, std::size_t k) {
    const Triangle own = triangles_[t];
    const std::uint32_t a = own[k], b = own[(k + 1) % 3], c = own[(k + 2) % 3];
    const auto shared = atEdge(a, b);
    if (shared.size() == 1) {
      if (onBorder(c)) return false;
      remove(t);
      return true;
    }
    const std::uint32_t s = shared[0] == t ? shared[1] : shared[0];
    std::uint32_t d = kNone;
    for (const std::uint32_t v : triangles_[s]) d = v != a && v != b ? v : d;
    if (d == c || !atEdge(c, d).empty()) return false;
    const Triangle first = {c, a, d}, second = {d, b, c};
    const Vector3 side = areaOf(triangles_[s]);
    if (isFlat(first) || isFlat(second)) return false;
    if (!isFlat(triangles_[s]) &&
        (!(dot(areaOf(first), side) > 0) || !(dot(areaOf(second), side) > 0)))
      return false;
    leaveFan(a, s);
    leaveFan(b, t);
    triangles_[t] = first;
    triangles_[s] = second;
    changeFan(d).push_back(t);
    changeFan(c).push_back(s);
    return true;
  }

  /** Moves a corner of a triangle off its longest edge, where its other triangles allow it. */
  void lift(std::uint32_t t, std::size_t longest) {
    const Triangle own = triangles_[t];
    const std::uint32_t v = own[(longest + 2) % 3];
    Vector3 line = edge(own, longest);
    double size = length(line);
    if (!(size > tiny_)) {
      size = 20 * tiny_;
      line = subtract(at(neighbours(v).back()), at(v));
    }
    for (const double way : {1.0, -1.0}) {
      const Vector3 step = normalized(cross(vertices_.normal[v], line));
      const Vector3 place = along(at(v), way * kLift * size, step);
      const Vector3 before = at(v);
      if (!mayMove(v, kNone, place, 0)) continue;
      vertices_.position[v] = place;
      if (!isFlat(own)) return;
      vertices_.position[v] = before;
    }
  }

  /** Triangles on two edges of the border that fold back onto the mesh. */
  void dropSpurs() {
    std::vector<std::uint32_t> queue;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (alive_[t]) queue.push_back(t);
    }
    for (std::size_t i = 0; i < queue.size(); ++i) {
      const std::uint32_t t = queue[i];
      if (!alive_[t]) continue;
      std::uint32_t inner = kNone;
      std::size_t tips = 0;
      for (const std::uint32_t v : triangles_[t]) tips += fanOf(v).size() == 1 ? 1 : 0;
      if (tips != 1) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto shared = atEdge(triangles_[t][k], triangles_[t][(k + 1) % 3]);
        if (shared.size() == 2) inner = shared[0] == t ? shared[1] : shared[0];
      }
      if (inner == kNone || !(dot(areaOf(triangles_[t]), areaOf(triangles_[inner])) < 0)) continue;
      remove(t);
      queue.push_back(inner);
    }
  }

  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::vector<Triangle>& triangles_;
  SurfaceVertices& vertices_;
  double tiny_ = 0;
  std::vector<bool> alive_;
  std::vector<std::uint32_t> begin_, fans_;  ///< triangles about each vertex, at first
  std::vector<std::uint32_t> changed_;       ///< of a vertex: its row, or kNone
  std::vector<std::vector<std::uint32_t>> rows_;
  std::vector<std::uint32_t> touched_;
};

}  // namespace

void cleanTriangles(std::vector<Triangle>& triangles, SurfaceVertices& vertices) {
  Cleaner(triangles, vertices).run();
}

}  // namespace pcl_slim::detail

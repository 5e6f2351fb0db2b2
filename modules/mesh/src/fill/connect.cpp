// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <unordered_set>

#include "fill/loop_fill.h"

namespace pcl_slim::detail {

BorderRings::BorderRings(const std::vector<Triangle>& triangles, const SurfaceVertices& vertices,
                         int threads)
    : slot_(vertices.count(), kNone) {
  const EdgeTable table(triangles, threads);
  std::vector<std::uint32_t> on_border, next;
  for (const MeshEdge& edge : table.edges) {
    if (edge.count != 1) continue;
    const std::uint32_t use = table.uses[edge.first];
    const Triangle& t = triangles[use / 3];
    // The triangle runs from a to b, what closes the loop from b to a.
    const std::uint32_t a = t[use % 3], b = t[(use % 3 + 1) % 3];
    slot_[b] = static_cast<std::uint32_t>(on_border.size());
    on_border.push_back(b);
    next.push_back(a);
    const Vector3 &p = vertices.position[t[0]], &q = vertices.position[t[1]];
    normals_.push_back(normalized(cross(subtract(q, p), subtract(vertices.position[t[2]], p))));
  }
  begin_.assign(on_border.size() + 2, 0);
  const auto forEnds = [&](const auto& use) {
    for (const MeshEdge& edge : table.edges) {
      if (slot_[edge.low] != kNone) use(slot_[edge.low], edge.high);
      if (slot_[edge.high] != kNone) use(slot_[edge.high], edge.low);
    }
  };
  forEnds([&](std::uint32_t slot, std::uint32_t) { ++begin_[slot + 2]; });
  for (std::size_t i = 2; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  neighbours_.resize(begin_.back());
  forEnds([&](std::uint32_t slot, std::uint32_t o) { neighbours_[begin_[slot + 1]++] = o; });
  for (std::size_t i = 0; i < on_border.size(); ++i) {
    std::sort(neighbours_.begin() + begin_[i], neighbours_.begin() + begin_[i + 1]);
  }

  fan_begin_.assign(on_border.size() + 2, 0);
  const auto forCorners = [&](const auto& use) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      for (const std::uint32_t v : triangles[t]) {
        if (slot_[v] != kNone) use(slot_[v], t);
      }
    }
  };
  forCorners([&](std::uint32_t slot, std::uint32_t) { ++fan_begin_[slot + 2]; });
  for (std::size_t i = 2; i < fan_begin_.size(); ++i) fan_begin_[i] += fan_begin_[i - 1];
  fans_.resize(fan_begin_.back());
  forCorners([&](std::uint32_t slot, std::uint32_t t) { fans_[fan_begin_[slot + 1]++] = t; });

  std::sort(on_border.begin(), on_border.end());
  std::vector<bool> seen(on_border.size(), false);
  for (const std::uint32_t first : on_border) {
    Loop loop;
    for (std::uint32_t v = first; v < slot_.size() && slot_[v] != kNone && !seen[slot_[v]];
         v = next[slot_[v]]) {
      seen[slot_[v]] = true;
      loop.push_back(v);
    }
    if (loop.size() >= 3 && next[slot_[loop.back()]] == first) loops_.push_back(std::move(loop));
  }
}

IndexRow BorderRings::neighbours(std::uint32_t v) const {
  if (v >= slot_.size() || slot_[v] == kNone) return {};
  return {neighbours_.data() + begin_[slot_[v]], neighbours_.data() + begin_[slot_[v] + 1]};
}

IndexRow BorderRings::trianglesAt(std::uint32_t v) const {
  if (v >= slot_.size() || slot_[v] == kNone) return {};
  return {fans_.data() + fan_begin_[slot_[v]], fans_.data() + fan_begin_[slot_[v] + 1]};
}

namespace {

constexpr double kFolded = -0.3;  ///< cosine of neighbours' normals below which they fold back

/** A corner that may be cut off: between the vertices before and after it. */
struct Corner {
  bool bad;  ///< its triangle folds back, or contains other vertices
  double radius;
  std::uint32_t at, stamp;

  /** The queue's top is the best; ties by numbers. */
  bool operator<(const Corner& other) const {
    if (bad != other.bad) return bad;
    return radius != other.radius ? radius > other.radius : at > other.at;
  }
};

class Connector {
 public:
  Connector(const Loop& loop, const BorderRings& rings, const SurfaceVertices& vertices)
      : loop_(loop), rings_(rings), left_(loop.size()), stamps_(loop.size(), 0) {
    const auto n = static_cast<std::uint32_t>(loop.size());
    for (std::uint32_t i = 0; i < n; ++i) {
      fill_.positions.push_back(vertices.position[loop[i]]);
      normals_.push_back(rings.normalAt(loop[i]));
      next_.push_back((i + 1) % n);
      before_.push_back((i + n - 1) % n);
    }
    for (std::uint32_t i = 0; i < n; ++i) {
      fill_.sizes.push_back(0.5 * (distance(i, next_[i]) + distance(i, before_[i])));
    }
  }

  LoopFill run() {
    for (std::uint32_t i = 0; left_ > 3 && i < loop_.size(); ++i) propose(i);
    while (left_ > 3 && !queue_.empty()) {
      const Corner best = queue_.top();
      queue_.pop();
      if (best.stamp != stamps_[best.at]) continue;
      if (!best.bad && containsOthers(best.at)) {
        queue_.push({true, best.radius, best.at, best.stamp});
        continue;
      }
      cut(best.at);
    }
    closeRest();
    return std::move(fill_);
  }

 private:
  double distance(std::uint32_t i, std::uint32_t j) const {
    return length(subtract(fill_.positions[i], fill_.positions[j]));
  }
  Triangle triangleAt(std::uint32_t i) const { return {before_[i], i, next_[i]}; }

  static std::uint64_t keyOf(std::uint32_t i, std::uint32_t j) {
    return static_cast<std::uint64_t>(std::min(i, j)) << 32 | std::max(i, j);
  }

  /** Whether the mesh or the fill has an edge between two of the loop's vertices. */
  bool isEdge(std::uint32_t i, std::uint32_t j) const {
    const IndexRow row = rings_.neighbours(loop_[i]);
    return std::binary_search(row.begin(), row.end(), loop_[j]) || made_.count(keyOf(i, j)) > 0;
  }

  void propose(std::uint32_t i) {
    const Triangle t = triangleAt(i);
    if (isEdge(t[0], t[2])) return;
    const Vector3 area = fill_.areaOf(t);
    const double size = length(area);
    const double sides = distance(t[0], t[1]) * distance(t[1], t[2]) * distance(t[2], t[0]);
    const double facing = std::min(dot(area, normals_[t[0]]), dot(area, normals_[t[1]]));
    const bool folds = facing < kFolded * size;
    const double radius = size > 0 ? sides / size : std::numeric_limits<double>::infinity();
    queue_.push({folds, radius, i, stamps_[i]});
  }

  /** Whether another vertex that is left is over or under a corner's triangle. */
  bool containsOthers(std::uint32_t i) const {
    const Triangle t = triangleAt(i);
    const Vector3 area = fill_.areaOf(t);
    const double size_sq = dot(area, area), reach = distance(t[0], t[2]);
    for (std::uint32_t j = next_[t[2]]; j != t[0]; j = next_[j]) {
      double share[3];
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector3& p = fill_.positions[t[(k + 1) % 3]];
        share[k] = dot(area, cross(subtract(fill_.positions[t[(k + 2) % 3]], p),
                                   subtract(fill_.positions[j], p)));
      }
      if (std::min({share[0], share[1], share[2]}) <= 1e-9 * size_sq) continue;
      const double off = dot(area, subtract(fill_.positions[j], fill_.positions[t[0]]));
      if (off * off < reach * reach * size_sq) return true;
    }
    return false;
  }

  void cut(std::uint32_t i) {
    const Triangle t = triangleAt(i);
    fill_.triangles.push_back(t);
    normals_[t[0]] = normalized(fill_.areaOf(t));
    made_.insert(keyOf(t[0], t[2]));
    next_[t[0]] = t[2];
    before_[t[2]] = t[0];
    ++stamps_[i];
    --left_;
    first_ = t[0];
    for (const std::uint32_t j : {t[0], t[2]}) {
      ++stamps_[j];
      if (left_ > 3) propose(j);
    }
  }

  /** The last three vertices are a triangle; more of them are connected to one in their middle. */
  void closeRest() {
    if (left_ == 3) {
      fill_.triangles.push_back(triangleAt(first_));
      return;
    }
    const auto middle = static_cast<std::uint32_t>(fill_.positions.size());
    Vector3 sum{};
    double size = 0;
    std::uint32_t j = first_;
    do {
      sum = along(sum, 1.0 / static_cast<double>(left_), fill_.positions[j]);
      size += fill_.sizes[j] / static_cast<double>(left_);
      fill_.triangles.push_back({middle, j, next_[j]});
      j = next_[j];
    } while (j != first_);
    fill_.positions.push_back(sum);
    fill_.sizes.push_back(size);
  }

  const Loop& loop_;
  const BorderRings& rings_;
  std::size_t left_;
  std::uint32_t first_ = 0;  ///< one of the vertices left
  std::vector<std::uint32_t> stamps_, next_, before_;
  std::vector<Vector3> normals_;  ///< across the edge that begins at each vertex left
  std::unordered_set<std::uint64_t> made_;
  std::priority_queue<Corner> queue_;
  LoopFill fill_;
};

}  // namespace

LoopFill connectLoop(const Loop& loop, const BorderRings& rings, const SurfaceVertices& vertices) {
  return Connector(loop, rings, vertices).run();
}

LoopFill fillLoop(const Loop& loop, const BorderRings& rings, std::vector<Triangle>& triangles,
                  SurfaceVertices& vertices) {
  LoopFill fill = connectLoop(loop, rings, vertices);
  if (loop.size() > 3) {
    refineFill(loop, rings, fill);
    fairFill(loop, rings, triangles, vertices, fill);
  }
  const std::size_t before = vertices.count(), n = loop.size();
  vertices.resize(before + fill.positions.size() - n);
  for (std::size_t i = n; i < fill.positions.size(); ++i) {
    vertices.position[before + i - n] = fill.positions[i];
    vertices.size[before + i - n] = static_cast<float>(fill.sizes[i]);
  }
  for (const Triangle& t : fill.triangles) {
    const Vector3 area = fill.areaOf(t);
    fill.area += 0.5 * length(area);
    Triangle made;
    for (std::size_t k = 0; k < 3; ++k) {
      made[k] = t[k] < n ? loop[t[k]] : static_cast<std::uint32_t>(before + t[k] - n);
      if (t[k] >= n) vertices.normal[made[k]] = along(vertices.normal[made[k]], 1, area);
    }
    triangles.push_back(made);
  }
  for (std::size_t v = before; v < vertices.count(); ++v) {
    vertices.normal[v] = normalized(vertices.normal[v]);
  }
  return fill;
}

}  // namespace pcl_slim::detail

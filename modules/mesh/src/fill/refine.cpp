// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "fill/loop_fill.h"

namespace pcl_slim::detail {

namespace {

constexpr double kDensity = 1.4142135623730951;  ///< of Liepa: a centroid that far from all corners
constexpr double kGrowth = 0.1;  ///< by which triangles grow with the distance from the loop
constexpr int kMostRounds = 40, kFlipRounds = 8;
constexpr std::uint32_t kNone = 0xffffffffu;

class Refiner {
 public:
  Refiner(const Loop& loop, const BorderRings& rings, LoopFill& fill)
      : loop_(loop), rings_(rings), fill_(fill), triangles_(fill.triangles) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> uses;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        uses.emplace_back(keyOf(triangles_[t][k], triangles_[t][(k + 1) % 3]), 3 * t + k);
      }
    }
    std::sort(uses.begin(), uses.end());
    across_.assign(3 * triangles_.size(), kNone);
    for (std::size_t i = 0; i < uses.size(); ++i) {
      edges_.insert(uses[i].first);
      if (i == 0 || uses[i].first != uses[i - 1].first) continue;
      across_[uses[i].second] = uses[i - 1].second;
      across_[uses[i - 1].second] = uses[i].second;
    }
  }

  void run() {
    flipEdges();
    for (int round = 0; round < kMostRounds; ++round) {
      const std::size_t before = triangles_.size();
      for (std::uint32_t t = 0; t < before; ++t) divide(t);
      if (triangles_.size() == before) break;
      flipEdges();
    }
  }

 private:
  static std::uint64_t keyOf(std::uint32_t i, std::uint32_t j) {
    return static_cast<std::uint64_t>(std::min(i, j)) << 32 | std::max(i, j);
  }

  /** Use u is the edge of triangle u / 3 from its corner u % 3 to the next. */
  std::uint32_t cornerOf(std::uint32_t use, std::uint32_t k) const {
    return triangles_[use / 3][(use + k - 3 * (use / 3)) % 3];
  }

  void connect(std::uint32_t a, std::uint32_t b) {
    if (a != kNone) across_[a] = b;
    if (b != kNone) across_[b] = a;
  }

  void divide(std::uint32_t t) {
    const Triangle own = triangles_[t];
    Vector3 middle{};
    for (const std::uint32_t v : own) middle = along(middle, 1.0 / 3, fill_.positions[v]);
    double size = 0, off[3];
    for (std::size_t k = 0; k < 3; ++k) {
      off[k] = length(subtract(middle, fill_.positions[own[k]]));
      size += (fill_.sizes[own[k]] + kGrowth * off[k]) / 3;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if (kDensity * off[k] <= std::max(size, fill_.sizes[own[k]])) return;
    }
    const auto v = static_cast<std::uint32_t>(fill_.positions.size());
    fill_.positions.push_back(middle);
    fill_.sizes.push_back(size);
    const auto second = static_cast<std::uint32_t>(triangles_.size()), third = second + 1;
    const std::uint32_t outer[3] = {across_[3 * t], across_[3 * t + 1], across_[3 * t + 2]};
    triangles_[t] = {own[0], own[1], v};
    triangles_.push_back({own[1], own[2], v});
    triangles_.push_back({own[2], own[0], v});
    across_.resize(3 * triangles_.size(), kNone);
    connect(3 * t, outer[0]);
    connect(3 * second, outer[1]);
    connect(3 * third, outer[2]);
    connect(3 * t + 1, 3 * second + 2);
    connect(3 * second + 1, 3 * third + 2);
    connect(3 * third + 1, 3 * t + 2);
    for (const std::uint32_t corner : own) edges_.insert(keyOf(corner, v));
  }

  /** The cosine of the angle at corner p of a triangle p q r. */
  double cosine(std::uint32_t p, std::uint32_t q, std::uint32_t r) const {
    const Vector3 a = subtract(fill_.positions[q], fill_.positions[p]);
    const Vector3 b = subtract(fill_.positions[r], fill_.positions[p]);
    const double size = length(a) * length(b);
    return size > 0 ? std::clamp(dot(a, b) / size, -1.0, 1.0) : 1;
  }

  bool isEdge(std::uint32_t i, std::uint32_t j) const {
    if (edges_.count(keyOf(i, j)) > 0) return true;
    if (i >= loop_.size() || j >= loop_.size()) return false;
    const IndexRow row = rings_.neighbours(loop_[i]);
    return std::binary_search(row.begin(), row.end(), loop_[j]);
  }

  /** Flips the edge of a use if its opposite angles are more than half a turn. */
  bool flip(std::uint32_t use) {
    const std::uint32_t other = across_[use];
    if (other == kNone) return false;
    const std::uint32_t a = cornerOf(use, 0), b = cornerOf(use, 1), c = cornerOf(use, 2),
                        d = cornerOf(other, 2);
    if (std::acos(cosine(c, a, b)) + std::acos(cosine(d, a, b)) <= M_PI + 1e-9) return false;
    if (c == d || isEdge(c, d)) return false;
    const Vector3 sum = along(fill_.areaOf({a, b, c}), 1, fill_.areaOf({b, a, d}));
    if (!(dot(fill_.areaOf({c, a, d}), sum) > 0) || !(dot(fill_.areaOf({d, b, c}), sum) > 0))
      return false;
    const auto nextUse = [](std::uint32_t u) { return u % 3 == 2 ? u - 2 : u + 1; };
    const std::uint32_t bc = across_[nextUse(use)], ca = across_[nextUse(nextUse(use))],
                        ad = across_[nextUse(other)], db = across_[nextUse(nextUse(other))];
    const std::uint32_t t = use / 3, s = other / 3;
    triangles_[t] = {c, a, d};
    triangles_[s] = {d, b, c};
    connect(3 * t, ca);
    connect(3 * t + 1, ad);
    connect(3 * s, db);
    connect(3 * s + 1, bc);
    connect(3 * t + 2, 3 * s + 2);
    edges_.erase(keyOf(a, b));
    edges_.insert(keyOf(c, d));
    return true;
  }

  void flipEdges() {
    for (int round = 0; round < kFlipRounds; ++round) {
      bool any = false;
      for (std::uint32_t use = 0; use < across_.size(); ++use) any = flip(use) || any;
      if (!any) return;
    }
  }

  const Loop& loop_;
  const BorderRings& rings_;
  LoopFill& fill_;
  std::vector<Triangle>& triangles_;
  std::vector<std::uint32_t> across_;  ///< the use of each use's edge by the other triangle
  std::unordered_set<std::uint64_t> edges_;
};

}  // namespace

void refineFill(const Loop& loop, const BorderRings& rings, LoopFill& fill) {
  Refiner(loop, rings, fill).run();
}

}  // namespace pcl_slim::detail

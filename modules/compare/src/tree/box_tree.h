// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief What a BoxTree knows of an item: a box that contains it, and a cone of directions that
 * contains its normals. */
struct TreeItem {
  std::array<float, 3> low{}, high{};
  std::array<float, 3> axis{};  ///< unit, or zero: the normals are anywhere
  float sine = 1;               ///< of the cone's half angle; 1: no direction is excluded

  /** \brief Makes the box contain a place in spite of its rounding to float. */
  void add(const Vector3& p);
};

/** \brief Bounding-volume hierarchy over items with eight children a node, made from the top by the
 * surface area heuristic over bins along the longest axis of the items' middles (Wald, On fast
 * construction of SAH-based bounding volume hierarchies, 2007). Nodes also have cones of normals, so
 * that searches for one side leave out what faces away. Items are renumbered: those of one node
 * follow each other. */
class BoxTree {
 public:
  static constexpr std::size_t kFan = 8;

  BoxTree() = default;
  /** \brief O(N log N); the same for any number of threads. At most 2^31 items. */
  explicit BoxTree(const std::vector<TreeItem>& items);

  /** \brief The number, among the items given, of each item of the tree. */
  const std::vector<std::uint32_t>& order() const { return order_; }
  std::size_t memoryBytes() const;

  /** \brief Visits the items whose box is nearer to a place than a bound, near ones first.
   * \param[in] side null, or a direction: items whose cone has only normals at 90 degrees or more
   * from it are left out \param[in] bound distance; may be infinite \param[in] visit visit(item)
   * returns the bound from there on, which must not increase. */
  template <typename Visit>
  void search(const Vector3& place, const Vector3* side, double bound, const Visit& visit) const;

 private:
  static constexpr std::uint32_t kItem = 0x80000000u, kNothing = 0xffffffffu;

  /** The children of a node: boxes, then nodes or items. Unused ones are nothing, in no box. */
  struct Node {
    alignas(32) float low[3][kFan], high[3][kFan];
    std::uint32_t child[kFan];
  };
  struct Cones {
    alignas(32) float axis[3][kFan], sine[kFan];
  };
  /** Of the items [begin, end) in the tree's order. */
  struct Range {
    std::uint32_t begin, end;
    TreeItem hull;
  };
  struct Build;
  struct Waiting {
    float distance_sq;
    std::uint32_t child;
  };

  AlignedVector<Node> nodes_;
  AlignedVector<Cones> cones_;
  std::vector<std::uint32_t> order_;
};

template <typename Visit>
void BoxTree::search(const Vector3& place, const Vector3* side, double bound,
                     const Visit& visit) const {
  if (nodes_.empty()) return;
  // Of the place's rounding to float, and of the squares'.
  constexpr double kSlack = 0x1p-22, kWidening = 1 + 0x1p-20;
  float p[3], s[3] = {0, 0, 0};
  double greatest = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    p[a] = static_cast<float>(place[a]);
    greatest = std::max(greatest, std::abs(place[a]));
    if (side) s[a] = static_cast<float>((*side)[a]);
  }
  const float least_cosine = -0x1p-20f * (std::abs(s[0]) + std::abs(s[1]) + std::abs(s[2]));
  const double slack = kSlack * greatest;
  const auto squared = [&](double b) {
    const double wide = (b + slack) * kWidening;
    return static_cast<float>(wide * wide);
  };
  float bound_sq = squared(bound);
  Waiting stack[256];
  std::size_t count = 1;
  stack[0] = {0, 0};
  while (count > 0) {
    const Waiting next = stack[--count];
    if (next.distance_sq > bound_sq) continue;
    if (next.child & kItem) {
      bound_sq = squared(visit(next.child & ~kItem));
      continue;
    }
    const Node& node = nodes_[next.child];
    float distance_sq[kFan], facing[kFan];
    for (std::size_t k = 0; k < kFan; ++k) {
      float sum = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        const float below = node.low[a][k] - p[a], above = p[a] - node.high[a][k];
        const float off = std::max(std::max(below, above), 0.0f);
        sum += off * off;
      }
      distance_sq[k] = sum;
      facing[k] = 0;
    }
    if (side) {
      const Cones& c = cones_[next.child];
      for (std::size_t k = 0; k < kFan; ++k)
        facing[k] = c.axis[0][k] * s[0] + c.axis[1][k] * s[1] + c.axis[2][k] * s[2] + c.sine[k];
    }
    // The near ones on top of the stack.
    const std::size_t first = count;
    for (std::size_t k = 0; k < kFan; ++k) {
      if (distance_sq[k] > bound_sq || facing[k] < least_cosine || node.child[k] == kNothing)
        continue;
      std::size_t at = count++;
      for (; at > first && stack[at - 1].distance_sq < distance_sq[k]; --at)
        stack[at] = stack[at - 1];
      stack[at] = {distance_sq[k], node.child[k]};
    }
  }
}

}  // namespace pcl_slim::detail

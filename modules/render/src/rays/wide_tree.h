// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "pcl_slim/core/aligned.h"

namespace pcl_slim::detail {

constexpr std::uint32_t kWide = 8;  ///< children of a node, and things in a block

/** \brief An axis-aligned box; empty until something is added. */
struct Box {
  float low[3] = {kFar, kFar, kFar};
  float high[3] = {-kFar, -kFar, -kFar};

  void add(const Box& other);
  /** \brief Half the surface area; 0 of an empty box. */
  double area() const;

  static constexpr float kFar = std::numeric_limits<float>::infinity();
};

/** \brief Boxes of a node's children side by side; row 2 a is low, row 2 a + 1 high along axis a. */
struct WideBoxes {
  alignas(64) float bound[6][kWide];
};

/** \brief A node's children: other nodes, or with kBlock set blocks, or kNoChild. */
struct WideNode {
  static constexpr std::uint32_t kBlock = 0x80000000u;
  static constexpr std::uint32_t kNoChild = 0xffffffffu;

  WideBoxes hit;  ///< what rays have to meet
  std::uint32_t child[kWide];
};

/** \brief A tree with eight children a node over boxes in blocks of eight, for one ray at a time.
 *
 * It is a tree apart from BlockTree, which groups neighbours along a Morton curve and so finds blocks in
 * ascending order: with such groups rays look at twice the nodes and take 1.4 times as long.
 *
 * Each thing has two boxes: one in which rays meet it, and a wider one in which it takes part in a
 * blend. Node 0 is the root. Boxes are wider than given by more than the rounding of a ray in
 * single precision that starts no farther off than the tree is long.
 */
struct WideTree {
  AlignedVector<WideNode> nodes;
  AlignedVector<WideBoxes> reach;    ///< per node, the wider boxes of its children
  std::vector<std::uint32_t> order;  ///< kWide things a block; kNothing where there is none
  Box bounds;                        ///< of all boxes that rays have to meet

  static constexpr std::uint32_t kNothing = 0xffffffffu;

  std::size_t numBlocks() const { return order.size() / kWide; }
  bool empty() const { return nodes.empty(); }
};

/** \brief Builds the tree by the surface area heuristic in bins. O(n log n); the same for any number
 * of threads. \param[in] hit, reach finite boxes, one of each per thing */
WideTree
buildWideTree(const std::vector<Box>& hit, const std::vector<Box>& reach, int threads);

}  // namespace pcl_slim::detail

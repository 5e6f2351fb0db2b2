// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "octree/color_octree.h"
#include "points/point_window.h"

namespace pcl_slim::detail {

/** A cell of the whole tree. Children stand before their parent. */
struct OctreeNode {
  std::uint32_t begin, end;
  std::uint32_t size;  ///< nodes of its subtree, itself included
  float spacing;       ///< of its own points; 0: too few
  double cost;         ///< D
  double error;        ///< points times Delta E
  std::int32_t shift;
};

/** The trees of one slice's roots, and the best cut for one lambda. */
struct OctreeForest {
  std::vector<OctreeNode> nodes;
  std::vector<double> best;          ///< least D + lambda * cells of each subtree
  std::vector<std::uint32_t> roots;  ///< places of roots
  std::uint64_t cells = 0;           ///< of the best cut
  double error = 0;

  /** Finds the best cut. O(nodes). */
  void solve(double lambda);
  /** Its cells below a node, in order. spacing: around the node, where its points are too few. */
  void extract(double lambda, std::size_t node, float spacing, std::vector<OctreeCell>& out) const;

 private:
  double childrenBest(std::size_t i) const;
  bool whole(std::size_t i, double lambda) const { return best[i] >= nodes[i].cost + lambda; }
};

/** Grows the trees above all points, slice by slice, from cells 2^growth roots wide. */
std::vector<OctreeForest>
growForests(const OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule, int growth,
            int threads);

}  // namespace pcl_slim::detail

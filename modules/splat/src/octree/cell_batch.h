// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "octree/cell_sums.h"
#include "octree/color_octree.h"

namespace pcl_slim::detail {

/** Some cells of one window. Batches of two threads share no cache line. */
struct alignas(64) CellBatch {
  std::vector<OctreeCell> cells;
  std::vector<CellSums> sums;  ///< over the points of each

  std::size_t size() const { return cells.size(); }

  void add(const OctreeCell& cell, const CellSums& of_points)
  {
    cells.push_back(cell);
    sums.push_back(of_points);
  }

  void clear()
  {
    cells.clear();
    sums.clear();
  }
};

}  // namespace pcl_slim::detail

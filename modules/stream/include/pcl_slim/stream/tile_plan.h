// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief A cloud cut into tiles along its Morton curve: a function of the points and the tile size
 * alone, never of memory, threads or the order of the points. */
struct PCL_SLIM_EXPORT TilePlan {
  /** \brief Points of one cell of an octree over the cloud. Ascending, without gaps between points.
   */
  struct Cell {
    std::uint64_t first_key = 0;  ///< least Morton code
    std::uint32_t points = 0;
    std::uint32_t depth = 0;  ///< edge: 2^-depth of the local unit
  };
  /** \brief A run of cells. */
  struct Tile {
    std::size_t first_cell = 0, end_cell = 0;
    std::uint64_t first_key = 0, end_key = 0;  ///< half open
    std::uint64_t points = 0;
  };

  std::vector<Cell> cells;
  std::vector<Tile> tiles;
  std::uint64_t points = 0;  ///< of all tiles

  /** \brief Cuts cells into tiles of at most this number of points each, unless one cell has more:
   * nodes of the octree, of which small neighbours under one parent are joined, and remainders of
   * less than a ninth with a neighbour on the curve. O(cells). */
  void makeTiles(std::uint64_t most_points);
};

}  // namespace pcl_slim

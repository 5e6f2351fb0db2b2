// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "octree/cell_tree.h"

namespace pcl_slim::detail {

/** An edge of an octree's cells that no finer cell divides. */
struct CellEdge {
  /** The cells around it, counter-clockwise as seen from the edge's upper end; a coarse cell whose face
   * holds the edge is there twice. */
  std::uint32_t cell[4];
  std::uint32_t low[3];  ///< its lower end
  std::uint8_t axis;
  std::uint8_t depth;  ///< of cells as wide as the edge is long
};

/** All such edges with a cell about them that a sheet passes, in a fixed order. O(nodes).
 * \param[in] fresh_only only those of cells that the last split() has made. O(those and nodes above). */
std::vector<CellEdge>
cellEdges(const CellTree& tree, bool fresh_only = false);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "octree/leaf_shapes.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** A cell by its lowest corner, in units of the finest cells that a tree may have. */
struct CellPlace {
  std::uint32_t low[3] = {0, 0, 0};
  std::uint32_t depth = 0;
};

/** A cell that is not divided, or a node above some. */
struct CellNode {
  std::uint32_t first_child = 0;  ///< of eight, x highest; 0: not divided
  std::uint32_t cell = 0;         ///< number among the cells not divided, in Morton order
  bool near = false;              ///< a leaf's sheet passes it, or may
  bool fresh = false;             ///< made by the last split(), or above such
};

/** An octree over the leaves of a surface. */
class CellTree {
 public:
  static constexpr std::uint32_t kMostDepth = 20;  ///< corners have twenty bits and a half

  /** Divides cells until none is wider than the leaves on it allow. \return an error where there
   * would be too many. O(cells times leaves near each); the same for any number of threads. */
  Error build(const std::vector<LeafShape>& shapes, int threads);

  static constexpr std::uint32_t kDivided = 0xffffffffu;

  /** Divides more cells, by their numbers. \return of each cell its number from now on, or kDivided. */
  std::vector<std::uint32_t> split(const std::vector<std::uint32_t>& cells);

  const std::vector<CellNode>& nodes() const { return nodes_; }
  /** Cells not divided, in Morton order. */
  const std::vector<CellPlace>& cells() const { return cells_; }
  std::uint64_t numNear() const;

  static std::uint32_t width(std::uint32_t depth) { return 1u << (kMostDepth - depth); }
  double size(std::uint32_t depth) const { return unit_ * width(depth); }
  Vector3 corner(const std::uint32_t (&place)[3]) const
  {
    return {low_[0] + unit_ * place[0], low_[1] + unit_ * place[1], low_[2] + unit_ * place[2]};
  }
  static CellPlace child(const CellPlace& parent, unsigned int octant);

 private:
  void place(const std::vector<LeafShape>& shapes);
  void number();

  Vector3 low_{};
  double unit_ = 0;  ///< width of the finest cells
  std::vector<CellNode> nodes_;
  std::vector<CellPlace> cells_;
};

/** An edge of an octree's cells that no finer cell divides. */
struct CellEdge {
  /** The cells around it, counter-clockwise as seen from the edge's upper end; a coarse cell whose face
   * contains the edge is listed twice. */
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

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "contour/probe_blocks.h"
#include "octree/cell_tree.h"

namespace pcl_slim::detail {

/** Signed distances at corners of cells, evaluated once each and kept while cells are divided. */
class CornerValues {
 public:
  explicit CornerValues(const ProbeField& field) : field_(field) {}

  /** Evaluates the ends of edges where that is not done yet. \return of each edge its lower and upper
   * end, as places in values() until the next call. O(corners), and a probe's time for each new corner. */
  std::vector<std::array<std::uint32_t, 2>> evaluate(const CellTree& tree,
                                                     const std::vector<CellEdge>& edges);

  const std::vector<SheetDistance>& values() const { return values_; }

 private:
  void merge(const CellTree& tree, const std::vector<std::uint64_t>& keys);

  const ProbeField& field_;
  std::vector<std::uint64_t> keys_;  ///< Morton codes of corners, ascending
  std::vector<SheetDistance> values_;
};

/** Where the surface crosses an edge of the cells. */
struct EdgeCrossing {
  std::uint32_t cell[4];  ///< as of the edge, counter-clockwise as seen from the normal's side
  Vector3 position, normal;
  float size;  ///< of the edge
};

/** Appends the edges at whose ends the surface's distance has different signs, but for jumps from one sheet to
 * another. Ends whose normals oppose each other are turned to agree first where the surface is not
 * oriented. O(edges). */
void
findCrossings(const CellTree& tree, const std::vector<CellEdge>& edges,
              const std::vector<std::array<std::uint32_t, 2>>& ends,
              const std::vector<SheetDistance>& values, bool oriented,
              std::vector<EdgeCrossing>& crossings);

}  // namespace pcl_slim::detail

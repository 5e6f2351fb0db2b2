// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "contour/corner_values.h"

namespace pcl_slim::detail {

/** Where the surface crosses an edge of the cells. */
struct Crossing {
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
              std::vector<Crossing>& crossings);

}  // namespace pcl_slim::detail

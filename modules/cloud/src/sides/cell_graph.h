// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/cloud/detail/sides.h"
#include "sides/cell_sheet.h"
#include "sides/side_cells.h"
#include "sides/signed_contraction.h"

namespace pcl_slim::detail {

/** \brief Cells with their normals, of no particular sign, and edges between near cells. */
struct CellGraph {
  std::vector<CellSheet> sheets;
  std::vector<SignedEdge> edges;
};

/** \brief Normals by the moments of the nearest cells, those of a cell's own sheet where two run
 * through them; edges to these cells, and to the next sheet along the normal. O(cells). */
CellGraph
graphOf(const SideCells& cut, const SideConstants& constants, int threads);

}  // namespace pcl_slim::detail

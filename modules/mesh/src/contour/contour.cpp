// SPDX-License-Identifier: BSD-3-Clause
#include "contour/contour.h"

#include <algorithm>

#include "contour/corner_values.h"
#include "contour/crossings.h"
#include "contour/polygons.h"
#include "octree/cell_edges.h"

namespace pcl_slim::detail {

namespace {

constexpr int kMostRounds = 6;

/** Takes away the crossings on edges of cells that have been divided, and renumbers the others' cells. */
void
keepWhole(const std::vector<std::uint32_t>& numbers, std::vector<Crossing>& crossings)
{
  std::size_t kept = 0;
  for (const Crossing& crossing : crossings) {
    Crossing own = crossing;
    bool whole = true;
    for (std::uint32_t& cell : own.cell) {
      cell = numbers[cell];
      whole = whole && cell != CellTree::kDivided;
    }
    if (whole) crossings[kept++] = own;
  }
  crossings.resize(kept);
}

}  // namespace

SheetVertices
contour(const ProbeField& field, bool oriented, CellTree& tree, MeshStatistics& statistics,
        const Progress* progress)
{
  CornerValues corners(field);
  std::vector<Crossing> crossings;
  SheetVertices vertices;
  statistics.split_cells = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    statistics.rounds = static_cast<std::uint64_t>(round) + 1;
    const std::vector<CellEdge> edges = cellEdges(tree, round > 0);
    const auto ends = corners.evaluate(tree, edges);
    if (progress != nullptr && progress->cancelled()) return vertices;
    findCrossings(tree, edges, ends, corners.values(), oriented, crossings);
    vertices = findSheetVertices(crossings, oriented, field.threads);
    const std::vector<std::uint32_t> cells = crowdedCells(vertices, field.threads);
    if (cells.empty() || round + 1 == kMostRounds) break;
    statistics.split_cells += cells.size();
    keepWhole(tree.split(cells), crossings);
  }
  statistics.corners = corners.values().size();
  return vertices;
}

}  // namespace pcl_slim::detail

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

}  // namespace

SheetVertices
contour(const ProbeField& field, bool oriented, CellTree& tree, MeshStatistics& statistics,
        const Progress* progress)
{
  CornerValues corners(field);
  SheetVertices vertices;
  statistics.split_cells = 0;
  for (int round = 0; round < kMostRounds; ++round) {
    statistics.rounds = static_cast<std::uint64_t>(round) + 1;
    const std::vector<CellEdge> edges = cellEdges(tree);
    const auto ends = corners.evaluate(tree, edges);
    if (progress != nullptr && progress->cancelled()) return vertices;
    const auto crossings = findCrossings(tree, edges, ends, corners.values(), oriented);
    vertices = findSheetVertices(crossings, oriented, field.threads);
    std::vector<std::uint32_t> cells = crowdedCells(vertices, field.threads);
    if (cells.empty()) break;
    if (round + 1 == kMostRounds) break;
    statistics.split_cells += cells.size();
    tree.split(cells);
  }
  statistics.corners = corners.values().size();
  return vertices;
}

}  // namespace pcl_slim::detail

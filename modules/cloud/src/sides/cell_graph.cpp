// SPDX-License-Identifier: BSD-3-Clause
// The graph of cells (docs/sides.md, "Sides before the cover").
#include "sides/side_cells.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

/// Greatest distance along the normal in which another sheet is sought [widths of a cell].
constexpr int kReach = 8;
constexpr double kLeastCosine = 0.5;  ///< least |cosine| of the normals of two parallel sheets

/** The index of a cell in the list of cells that another has edges to; 0: it is not in the list. */
std::size_t indexAmong(const SheetCells& sheet, std::uint32_t cell,
                       const SideConstants& constants) {
  const std::size_t most = std::min(sheet.count, constants.edge_neighbors + 1);
  for (std::size_t k = 1; k < sheet.count; ++k) {
    if (sheet.cells[k] == cell) return k < most || sheet.isOther(k) ? k : 0;
  }
  return 0;
}

/** Adds edges to a cell's nearest cells, and to all of its cells on another sheet. If both cells of
 * a pair have an edge to the other, the one of the lesser index adds the sum. */
void addNearEdges(std::uint32_t cell, const std::vector<CellSheet>& sheets,
                  const std::vector<SheetCells>& near, const SideConstants& constants,
                  std::vector<SignedEdge>& edges) {
  const SheetCells& own = near[cell];
  for (std::size_t k = 1; k < own.count; ++k) {
    const bool apart = own.isOther(k);
    if (k > constants.edge_neighbors && !apart) continue;
    const std::uint32_t other = own.cells[k];
    const std::size_t back = indexAmong(near[other], cell, constants);
    if (back > 0 && other < cell) continue;
    const double cosine = dot(sheets[cell].normal, sheets[other].normal);
    double agreement = apart ? -cosine : cosine;
    if (back > 0) agreement += near[other].isOther(back) ? -cosine : cosine;
    edges.emplace_back(cell, other, agreement, apart);
  }
}

/** Adds edges to the nearest sheets parallel to a cell's own along its normal, on either side. */
void addFacingEdges(std::uint32_t cell, const SideCells& cut, const std::vector<CellSheet>& sheets,
                    const SideConstants& constants, std::vector<SignedEdge>& edges) {
  const CellSheet& own = sheets[cell];
  const Vector3& from = cut.cells[cell].mean;
  const double apart_sq = constants.sheet_distance * constants.sheet_distance;
  for (const double way : {1.0, -1.0}) {
    for (int step = 1; step <= kReach; ++step) {
      const std::uint32_t other = cut.cellAt(along(from, way * step * cut.width, own.normal));
      if (other == SideCells::kNone || other == cell) continue;
      const double cosine = dot(own.normal, sheets[other].normal);
      const double height = dot(subtract(cut.cells[other].mean, from), own.normal);
      const double spread = std::max(own.spread, sheets[other].spread);
      if (std::abs(cosine) < kLeastCosine || height * height < apart_sq * spread) continue;
      edges.emplace_back(cell, other, -cosine, true);
      break;
    }
  }
}

/** CellGraph::neighbors. */
std::vector<std::uint32_t> neighborsOnSheets(const std::vector<SheetCells>& near,
                                             const SideConstants& constants, int threads) {
  const std::size_t each = constants.edge_neighbors + 1;
  std::vector<std::uint32_t> neighbors(near.size() * each, SideCells::kNone);
  parallelFor(near.size(), threads, 4096, [&](std::size_t c, int) {
    for (std::size_t k = 0; k < std::min(near[c].count, each); ++k)
      if (!near[c].isOther(k)) neighbors[c * each + k] = near[c].cells[k];
  });
  return neighbors;
}

}  // namespace

CellGraph graphOf(const SideCells& cut, const SideConstants& constants, int threads) {
  constexpr std::size_t kTask = 256;
  const std::size_t n = cut.cells.size(), tasks = (n + kTask - 1) / kTask;
  std::vector<CellSheet> sheets(n);
  std::vector<SheetCells> near(n);
  parallelFor(tasks, threads, 1, [&](std::size_t t, int) {
    for (std::size_t c = t * kTask; c < std::min(n, (t + 1) * kTask); ++c)
      sheets[c] = sheetOf(cut, static_cast<std::uint32_t>(c), constants, near[c]);
  });
  std::vector<std::vector<SignedEdge>> edges(tasks);
  parallelFor(tasks, threads, 1, [&](std::size_t t, int) {
    thread_local std::vector<SignedEdge> found;  // a copy of it has no spare room
    found.clear();
    for (std::size_t c = t * kTask; c < std::min(n, (t + 1) * kTask); ++c) {
      const auto cell = static_cast<std::uint32_t>(c);
      addNearEdges(cell, sheets, near, constants, found);
      addFacingEdges(cell, cut, sheets, constants, found);
    }
    edges[t].assign(found.begin(), found.end());
  });
  CellGraph graph;
  graph.neighbors = neighborsOnSheets(near, constants, threads);
  std::vector<SheetCells>().swap(near);
  std::size_t count = 0;
  for (const auto& part : edges) count += part.size();
  graph.edges.reserve(count);
  for (auto& part : edges) {
    graph.edges.insert(graph.edges.end(), part.begin(), part.end());
    std::vector<SignedEdge>().swap(part);
  }
  graph.sheets = std::move(sheets);
  return graph;
}

}  // namespace pcl_slim::detail

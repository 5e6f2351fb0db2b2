// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/stream/tile_plan.h"

#include <algorithm>

#include "cells/cell_counts.h"

namespace pcl_slim {

namespace {

using namespace detail;

constexpr std::uint64_t kSmall = 9;  ///< a tile of less than such a part is joined with another

/** Cuts the cells of an octree's nodes into tiles. */
class TileCutter {
 public:
  TileCutter(TilePlan& plan, std::uint64_t most) : plan_(plan), most_(most)
  {
    sums_.assign(plan.cells.size() + 1, 0);
    for (std::size_t i = 0; i < plan.cells.size(); ++i)
      sums_[i + 1] = sums_[i] + plan.cells[i].points;
  }

  /** Cuts the cells [begin, end), all in one node of a depth. */
  void cut(std::size_t begin, std::size_t end, int depth)
  {
    if (begin == end) return;
    if (sums_[end] - sums_[begin] <= most_ || end - begin == 1 || depth == kDeepestCell) {
      add(begin, end);
      return;
    }
    std::size_t pending = begin;  // children not yet in a tile
    for (std::size_t child = begin; child < end;) {
      const std::size_t next = endOfChild(child, end, depth + 1);
      if (sums_[next] - sums_[pending] > most_) {
        if (pending < child) add(pending, child);
        pending = child;
        if (sums_[next] - sums_[child] > most_) {
          cut(child, next, depth + 1);
          pending = next;
        }
      }
      child = next;
    }
    if (pending < end) add(pending, end);
  }

  /** Joins tiles of few points with what follows or precedes them on the curve. */
  void joinSmall(std::uint64_t least)
  {
    std::vector<TilePlan::Tile> cut;
    cut.swap(plan_.tiles);
    for (const TilePlan::Tile& tile : cut) {
      const bool joins = !plan_.tiles.empty() &&
                         std::min(plan_.tiles.back().points, tile.points) < least &&
                         plan_.tiles.back().points + tile.points <= most_ + least;
      const std::size_t begin = joins ? plan_.tiles.back().first_cell : tile.first_cell;
      if (joins) plan_.tiles.pop_back();
      plan_.tiles.push_back(tileOf(begin, tile.end_cell));
    }
  }

 private:
  std::size_t endOfChild(std::size_t begin, std::size_t end, int depth) const
  {
    const std::uint64_t code = cellOf(plan_.cells[begin].first_key, depth);
    const auto first = plan_.cells.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = plan_.cells.begin() + static_cast<std::ptrdiff_t>(end);
    const auto in_child = [&](const TilePlan::Cell& cell) {
      return cellOf(cell.first_key, depth) == code;
    };
    return static_cast<std::size_t>(std::partition_point(first, last, in_child) -
                                    plan_.cells.begin());
  }

  void add(std::size_t begin, std::size_t end) { plan_.tiles.push_back(tileOf(begin, end)); }

  TilePlan::Tile tileOf(std::size_t begin, std::size_t end) const
  {
    TilePlan::Tile tile;
    tile.first_cell = begin;
    tile.end_cell = end;
    tile.first_key = plan_.cells[begin].first_key;
    const TilePlan::Cell& last = plan_.cells[end - 1];
    const int below = 3 * (kDeepestCell - static_cast<int>(last.depth));
    tile.end_key = last.first_key + (std::uint64_t{1} << below);
    tile.points = sums_[end] - sums_[begin];
    return tile;
  }

  TilePlan& plan_;
  std::uint64_t most_;
  std::vector<std::uint64_t> sums_;
};

}  // namespace

void
TilePlan::makeTiles(std::uint64_t most_points)
{
  tiles.clear();
  points = 0;
  for (const Cell& cell : cells) points += cell.points;
  const std::uint64_t small = most_points / kSmall;
  TileCutter cutter(*this, most_points - small);
  cutter.cut(0, cells.size(), 0);
  cutter.joinSmall(small);
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// The cloud's points counted in the cells of an octree, and the cells cut into tiles.
#include "cell_counts.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "pcl_slim/cloud/detail/block_kernels.h"
#include "pcl_slim/cloud/detail/cloud_reader.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kSlice = 1 << 14;  ///< points a thread takes at a time
constexpr std::size_t kBatch = kernels::kMortonBatch;

Error tooMany() {
  return badInput("2^32 points lie within a 256th of the cloud's width: fit its parts apart");
}

}  // namespace

const AlignedVector<std::uint64_t>& PointKeys::of(const CloudView& piece) {
  const std::size_t n = piece.count();
  keys_.resize(n + kBatch);
  parallelFor((n + kSlice - 1) / kSlice, threads_, 1,
              [&](std::size_t s, int) { slice(piece, s * kSlice, std::min(n, (s + 1) * kSlice)); });
  return keys_;
}

void PointKeys::slice(const CloudView& piece, std::size_t begin, std::size_t end) {
  const CloudReader reader(piece);
  const bool normals = frame_.with_normals;
  const auto& center = frame_.bulk_center;
  // Neither NaN nor infinity is within a finite reach.
  const double reach = std::min(frame_.bulk_reach, std::numeric_limits<double>::max());
  alignas(64) double batch[3][kBatch] = {};
  alignas(64) std::uint64_t codes[kBatch];
  for (std::size_t first = begin; first < end; first += kBatch) {
    const std::size_t count = std::min(kBatch, end - first);
    bool wanted[kBatch];
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t input = piece.inputIndex(first + i);
      const auto p = reader.position(input);
      const double farthest = std::max(
          {std::abs(p[0] - center[0]), std::abs(p[1] - center[1]), std::abs(p[2] - center[2])});
      const bool near = farthest <= reach && !std::isnan(p[0] + p[1] + p[2]);
      wanted[i] = near && (!normals || reader.hasNormal(input));
      for (std::size_t a = 0; a < 3; ++a) batch[a][i] = wanted[i] ? p[a] : frame_.origin[a];
    }
    kernels::mortonCodes(batch, frame_.origin.data(), 1.0 / frame_.scale, codes);
    for (std::size_t i = 0; i < count; ++i) keys_[first + i] = wanted[i] ? codes[i] : kLeftOut;
  }
}

CellCounts::CellCounts() : table_(std::size_t{1} << (3 * kTableDepth), 0) {
  addPage();  // number 0 is none
}

std::uint32_t CellCounts::addPage() {
  const auto page = static_cast<std::uint32_t>(values_.size() / kPage);
  values_.resize(values_.size() + kPage, 0);
  deeper_.resize(deeper_.size() + kPage, 0);
  return page;
}

/** The slot of the deepest cell that contains a code; the first pass makes it. Slot 0: none. */
std::size_t CellCounts::slotOf(std::uint64_t key, int& depth) {
  std::uint32_t& top = table_[cellOf(key, kTableDepth)];
  if (top == 0) {
    if (depth_ != kTableDepth + kPageDepth) return 0;
    const std::uint32_t page = addPage();
    top = page;
  }
  depth = kTableDepth + kPageDepth;
  std::size_t slot = top * kPage + (cellOf(key, depth) & (kPage - 1));
  while (deeper_[slot] != 0) {
    depth += kPageDepth;
    slot = deeper_[slot] * kPage + (cellOf(key, depth) & (kPage - 1));
  }
  return slot;
}

Error CellCounts::add(const std::uint64_t* keys, std::size_t count) {
  int depth = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t key = keys[i];
    if (key == PointKeys::kLeftOut) continue;
    const std::size_t slot = slotOf(key, depth);
    if (slot == 0 || depth != depth_) continue;
    if (++values_[slot] == std::numeric_limits<std::uint32_t>::max()) return tooMany();
  }
  return {};
}

Error CellCounts::replace(const std::vector<TilePlan::Cell>& cells) {
  int depth = 0;
  for (const TilePlan::Cell& cell : cells) {
    if (cell.points == std::numeric_limits<std::uint32_t>::max()) return tooMany();
    values_[slotOf(cell.first_key, depth)] = cell.points;
  }
  return {};
}

bool CellCounts::divideCells(std::uint64_t most) {
  if (depth_ >= kMostDepth) return false;
  bool divided = false;
  for (std::size_t slot = kPage; slot < values_.size(); ++slot) {
    // Cells of earlier passes are divided already, or small.
    if (deeper_[slot] != 0 || values_[slot] <= most) continue;
    const std::uint32_t page = addPage();
    deeper_[slot] = page;
    values_[slot] = 0;
    divided = true;
  }
  if (divided) depth_ += kPageDepth;
  return divided;
}

template <typename Visit>
void CellCounts::forPage(std::uint32_t page, std::uint64_t code, int depth,
                         const Visit& visit) const {
  for (std::size_t k = 0; k < kPage; ++k) {
    const std::size_t slot = page * kPage + k;
    const std::uint64_t cell = code << (3 * kPageDepth) | k;
    if (deeper_[slot] != 0)
      forPage(deeper_[slot], cell, depth + kPageDepth, visit);
    else if (values_[slot] != 0)
      visit(cell, depth, slot);
  }
}

template <typename Visit>
void CellCounts::forCells(const Visit& visit) const {
  for (std::size_t code = 0; code < table_.size(); ++code) {
    if (table_[code] != 0) forPage(table_[code], code, kTableDepth + kPageDepth, visit);
  }
}

std::vector<TilePlan::Cell> CellCounts::cells() const {
  std::vector<TilePlan::Cell> cells;
  forCells([&](std::uint64_t code, int depth, std::size_t slot) {
    TilePlan::Cell cell;
    cell.first_key = code << (3 * (kDeepestCell - depth));
    cell.points = values_[slot];
    cell.depth = static_cast<std::uint32_t>(depth);
    cells.push_back(cell);
  });
  return cells;
}

void CellCounts::numberCells() {
  std::uint32_t next = 0;
  forCells([&](std::uint64_t, int, std::size_t slot) { values_[slot] = next++; });
}

std::size_t CellCounts::memoryBytes() const {
  return sizeof(std::uint32_t) * (table_.capacity() + values_.capacity() + deeper_.capacity());
}

}  // namespace pcl_slim::detail

namespace pcl_slim {

namespace {

using namespace detail;

constexpr std::uint64_t kSmall = 9;  ///< a tile of less than such a part is joined with another

/** Cuts the cells of an octree's nodes into tiles. */
class TileCutter {
 public:
  TileCutter(TilePlan& plan, std::uint64_t most) : plan_(plan), most_(most) {
    sums_.assign(plan.cells.size() + 1, 0);
    for (std::size_t i = 0; i < plan.cells.size(); ++i)
      sums_[i + 1] = sums_[i] + plan.cells[i].points;
  }

  /** Cuts the cells [begin, end), all in one node of a depth. */
  void cut(std::size_t begin, std::size_t end, int depth) {
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
  void joinSmall(std::uint64_t least) {
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
  std::size_t endOfChild(std::size_t begin, std::size_t end, int depth) const {
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

  TilePlan::Tile tileOf(std::size_t begin, std::size_t end) const {
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

void TilePlan::makeTiles(std::uint64_t most_points) {
  tiles.clear();
  points = 0;
  for (const Cell& cell : cells) points += cell.points;
  const std::uint64_t small = most_points / kSmall;
  TileCutter cutter(*this, most_points - small);
  cutter.cut(0, cells.size(), 0);
  cutter.joinSmall(small);
}

}  // namespace pcl_slim

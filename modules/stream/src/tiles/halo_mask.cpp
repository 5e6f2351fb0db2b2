// SPDX-License-Identifier: BSD-3-Clause
#include "tiles/halo_mask.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

constexpr double kCellsOfReach = 6.0;
constexpr double kMostCells = 1 << 26;  ///< of a mask: coarser cells where a tile is scattered

/** Takes every third bit: the inverse of spreadBits(). */
int
compact(std::uint64_t v)
{
  v &= 0x1249249249249249ULL;
  v = (v | v >> 2) & 0x10c30c30c30c30c3ULL;
  v = (v | v >> 4) & 0x100f00f00f00f00fULL;
  v = (v | v >> 8) & 0x1f0000ff0000ffULL;
  v = (v | v >> 16) & 0x1f00000000ffffULL;
  return static_cast<int>((v | v >> 32) & 0x1fffff);
}

std::array<int, 3>
placeOf(std::uint64_t code)
{
  return {compact(code >> 2), compact(code >> 1), compact(code)};
}

}  // namespace

HaloMask::HaloMask(const TilePlan& plan, const TilePlan::Tile& tile,
                   const AlignedVector<std::uint64_t>& keys, double reach)
{
  depth_ = std::clamp(static_cast<int>(std::ceil(std::log2(kCellsOfReach / reach))), 1,
                      kDeepestCell - 1);
  while (!fitBox(plan, tile, reach) && depth_ > 1) --depth_;
  markCore(keys);
  grow(std::ldexp(reach, depth_));
}

/** Sets the box of the mask. \return whether it is of a size to work with. */
bool
HaloMask::fitBox(const TilePlan& plan, const TilePlan::Tile& tile, double reach)
{
  constexpr int kMost = 1 << kDeepestCell;
  Place low{kMost, kMost, kMost}, high{};
  for (std::size_t c = tile.first_cell; c < tile.end_cell; ++c) {
    const TilePlan::Cell& cell = plan.cells[c];
    const Place p = placeOf(cellOf(cell.first_key, depth_));
    const int wide = std::max(0, depth_ - static_cast<int>(cell.depth));
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a] + (1 << wide) - 1);
    }
  }
  const int margin = static_cast<int>(std::ceil(std::ldexp(reach, depth_))) + 1;
  double cells = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    low_[a] = low[a] - margin;
    size_[a] = high[a] - low[a] + 1 + 2 * margin;
    cells *= size_[a];
  }
  return cells <= kMostCells;
}

void
HaloMask::markCore(const AlignedVector<std::uint64_t>& keys)
{
  bits_.assign(indexOf({low_[0] + size_[0], low_[1], low_[2]}), false);
  std::uint64_t last = PointKeys::kLeftOut;
  for (const std::uint64_t key : keys) {
    const std::uint64_t cell = cellOf(key, depth_);
    if (cell != last) bits_[indexOf(placeOf(cell))] = true;
    last = cell;
  }
}

std::size_t
HaloMask::indexOf(const Place& p) const
{
  const auto at = [&](std::size_t a) { return static_cast<std::size_t>(p[a] - low_[a]); };
  return (at(0) * static_cast<std::size_t>(size_[1]) + at(1)) * static_cast<std::size_t>(size_[2]) +
         at(2);
}

bool
HaloMask::inside(const Place& p) const
{
  return std::equal(p.begin(), p.end(), low_.begin(), [](int at, int low) { return at >= low; }) &&
         p[0] < low_[0] + size_[0] && p[1] < low_[1] + size_[1] && p[2] < low_[2] + size_[2];
}

/** Marks all cells whose boxes come within so many cells' widths of a marked one's. */
void
HaloMask::grow(double cells)
{
  const int most = static_cast<int>(std::ceil(cells)) + 1;
  const auto gap = [](int d) { return std::max(0, std::abs(d) - 1); };
  struct Row {
    std::ptrdiff_t begin;
    int length;
  };
  std::vector<Row> rows;  // of the ball, along z
  const auto middle = static_cast<std::ptrdiff_t>(indexOf(low_));
  for (int dx = -most; dx <= most; ++dx) {
    for (int dy = -most; dy <= most; ++dy) {
      const double left = cells * cells - gap(dx) * gap(dx) - gap(dy) * gap(dy);
      if (left < 0) continue;
      const int half = std::min(static_cast<int>(std::sqrt(left)) + 1, most);
      const std::ptrdiff_t begin = (std::ptrdiff_t{dx} * size_[1] + dy) * size_[2] - half;
      rows.push_back({begin - middle, 2 * half + 1});
    }
  }
  const std::vector<bool> core = bits_;
  for (std::size_t i = 0; i < core.size(); ++i) {
    if (!core[i]) continue;
    for (const Row& row : rows) {
      const auto begin = bits_.begin() + static_cast<std::ptrdiff_t>(i) + row.begin;
      std::fill(begin, begin + row.length, true);
    }
  }
}

bool
HaloMask::hasCell(std::uint64_t code) const
{
  const Place p = placeOf(code);
  return inside(p) && bits_[indexOf(p)];
}

bool
HaloMask::meets(const TilePlan::Cell& cell) const
{
  const int depth = static_cast<int>(cell.depth);
  if (depth >= depth_) return holds(cell.first_key);
  const Place first = placeOf(cellOf(cell.first_key, depth_));
  const int width = 1 << (depth_ - depth);
  Place low, high;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::max(first[a], low_[a]);
    high[a] = std::min(first[a] + width, low_[a] + size_[a]);
  }
  for (int x = low[0]; x < high[0]; ++x) {
    for (int y = low[1]; y < high[1]; ++y) {
      for (int z = low[2]; z < high[2]; ++z) {
        if (bits_[indexOf({x, y, z})]) return true;
      }
    }
  }
  return false;
}

}  // namespace pcl_slim::detail

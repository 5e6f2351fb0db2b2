// SPDX-License-Identifier: BSD-3-Clause
#include "tiles/tile_loader.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/cloud/detail/cloud_reader.h"
#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/core/random.h"

namespace pcl_slim::detail {
namespace {

constexpr double kCellsOfReach = 6.0;
constexpr double kMostCells = 1 << 26;  ///< of a mask: coarser cells where a tile is scattered

std::array<int, 3>
placeOf(std::uint64_t code)
{
  const auto at = [code](int axis) { return static_cast<int>(gatherBits(code >> axis)); };
  return {at(2), at(1), at(0)};
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

/** Marks all cells whose boxes are within a number of cells' widths of a marked one's. */
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

Error
TileLoader::loadCore(std::size_t tile, std::vector<unsigned char>& records) const
{
  records.clear();
  for (const Bucket& bucket : store_.buckets()) {
    if (bucket.tile != tile) continue;
    if (Error error = store_.read(bucket, records)) return error;
  }
  return {};
}

HaloMask
TileLoader::maskOf(std::size_t tile, const std::vector<unsigned char>& records, double reach) const
{
  const CloudView view = record().view(records);
  PointKeys keys(frame_, threads_);
  AlignedVector<std::uint64_t> codes = keys.of(view);
  codes.resize(view.count());
  return {plan_, plan_.tiles[tile], codes, reach};
}

std::vector<std::uint64_t>
TileLoader::haloCells(std::size_t tile, const HaloMask& mask) const
{
  const TilePlan::Tile& own = plan_.tiles[tile];
  std::vector<std::uint64_t> cells;
  for (std::size_t c = 0; c < plan_.cells.size(); ++c) {
    const bool outside = c < own.first_cell || c >= own.end_cell;
    if (outside && mask.meets(plan_.cells[c])) cells.push_back(c);
  }
  return cells;
}

/** Appends the points of a bucket that are wanted(key, position). */
template <typename Wanted>
Error
TileLoader::loadSome(const TileStore& store, const Bucket& bucket, const Wanted& wanted,
                     std::vector<unsigned char>& records) const
{
  const std::size_t step = record().bytes();
  std::vector<unsigned char> read;
  if (Error error = store.read(bucket, read)) return error;
  const CloudView view = record().view(read);
  const CloudReader reader(view);
  PointKeys keys(frame_, threads_);
  const AlignedVector<std::uint64_t>& codes = keys.of(view);
  for (std::size_t i = 0; i < view.count(); ++i) {
    if (!wanted(codes[i], reader.position(i))) continue;
    const auto from = read.begin() + static_cast<std::ptrdiff_t>(i * step);
    records.insert(records.end(), from, from + static_cast<std::ptrdiff_t>(step));
  }
  return {};
}

Error
TileLoader::loadHalo(std::size_t tile, const HaloMask& mask,
                     std::vector<unsigned char>& records) const
{
  const auto inMask = [&](std::uint64_t key, const auto&) { return mask.holds(key); };
  for (const TileStore* store : {&store_, &halo_}) {
    for (const Bucket& bucket : store->buckets()) {
      if (bucket.tile == tile) continue;
      bool meets = false;
      for (std::size_t c = bucket.first_cell; c < bucket.end_cell && !meets; ++c)
        meets = mask.meets(plan_.cells[c]);
      if (!meets) continue;
      if (Error error = loadSome(*store, bucket, inMask, records)) return error;
    }
  }
  return {};
}

Error
TileLoader::loadCells(std::size_t first, std::size_t end, std::uint64_t thinning,
                      std::vector<unsigned char>& records) const
{
  const std::uint64_t begin_key = plan_.cells[first].first_key;
  const std::uint64_t last_key = plan_.cells[end - 1].first_key;
  const int below = 3 * (kDeepestCell - static_cast<int>(plan_.cells[end - 1].depth));
  const auto wanted = [&](std::uint64_t key, const std::array<double, 3>& p) {
    return key >= begin_key && (key < last_key || (key - last_key) >> below == 0) &&
           (thinning == 1 || placeHash(p) % thinning == 0);
  };
  for (const Bucket& bucket : store_.buckets()) {
    if (bucket.end_cell <= first || bucket.first_cell >= end) continue;
    if (Error error = loadSome(store_, bucket, wanted, records)) return error;
  }
  return {};
}

}  // namespace pcl_slim::detail

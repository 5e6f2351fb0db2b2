// SPDX-License-Identifier: BSD-3-Clause
#include "cover/cover_cells.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/cloud/morton.h"

namespace pcl_slim::detail {

namespace {

/** A code one step before or after along an axis, whose bits the mask has. */
std::uint64_t
stepAlong(std::uint64_t code, std::uint64_t mask, int step)
{
  const std::uint64_t own = code & mask, one = mask & (0 - mask);
  const std::uint64_t moved = step < 0 ? own - one : step > 0 ? (own | ~mask) + one : own;
  return moved & mask;
}

/** The end of a run that starts at i: ever longer steps until it is left, then halving the last. */
template <typename InRun>
std::size_t
endOfRun(const AlignedVector<std::uint32_t>& values, std::size_t i, const InRun& in_run)
{
  std::size_t step = 1;
  for (; i + step < values.size() && in_run(values[i + step]); step *= 2) i += step;
  const auto begin = values.begin() + static_cast<std::ptrdiff_t>(i);
  const auto last = values.begin() + static_cast<std::ptrdiff_t>(std::min(values.size(), i + step));
  return static_cast<std::size_t>(std::partition_point(begin, last, in_run) - values.begin());
}

}  // namespace

void
CoverCells::divide(const PointStore& store, const AlignedVector<std::uint32_t>& points,
                   double reach)
{
  // A level may be finer than floats resolve: its reach is 0 then.
  const double levels = std::floor(-std::log2(2.0 * reach));
  const int depth = static_cast<int>(std::clamp(levels, 0.0, double{kMortonBits}));
  const int shift = 3 * (kMortonBits - depth);
  const auto codeOf = [&](std::uint32_t point) { return store.keys()[point] >> shift; };
  cells_.clear();
  for (std::size_t i = 0; i < points.size();) {
    const std::uint64_t code = codeOf(points[i]);
    const std::size_t end =
        endOfRun(points, i, [&](std::uint32_t point) { return codeOf(point) == code; });
    cells_.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(end), code});
    i = end;
  }
  orderByColor();
}

std::uint32_t
CoverCells::beside(std::uint32_t i, int x, int y, int z) const
{
  constexpr std::uint64_t kZ = 0x1249249249249249ULL, kY = kZ << 1, kX = kZ << 2;
  const std::uint64_t own = cells_[i].code;
  const std::uint64_t code = stepAlong(own, kX, x) | stepAlong(own, kY, y) | stepAlong(own, kZ, z);
  const auto at =
      std::lower_bound(cells_.begin(), cells_.end(), code,
                       [](const Cell& cell, std::uint64_t value) { return cell.code < value; });
  const bool found = at != cells_.end() && at->code == code;
  return static_cast<std::uint32_t>((found ? at : cells_.end()) - cells_.begin());
}

void
CoverCells::orderByColor()
{
  color_begin_.fill(0);
  for (const Cell& cell : cells_) ++color_begin_[colorOf(cell) + 1];
  for (std::size_t c = 0; c < 8; ++c) color_begin_[c + 1] += color_begin_[c];
  by_color_.resize(cells_.size());
  for (std::uint32_t i = 0; i < by_color_.size(); ++i) by_color_[i] = i;
  std::stable_sort(by_color_.begin(), by_color_.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Cell &first = cells_[a], &second = cells_[b];
    if (colorOf(first) != colorOf(second)) return colorOf(first) < colorOf(second);
    return first.end - first.begin > second.end - second.begin;
  });
}

}  // namespace pcl_slim::detail

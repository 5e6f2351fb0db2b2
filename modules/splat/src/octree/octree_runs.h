// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "octree/cell_sums.h"
#include "octree/color_octree.h"
#include "pcl_slim/core/parallel.h"
#include "points/point_window.h"

namespace pcl_slim::detail {

constexpr std::size_t kSpacingPoints = 8;  ///< fewer points do not determine their density
constexpr std::size_t kSpacingReach = 32;  ///< points to look at on either side of a cell for more
constexpr std::size_t kRootSlice = 1 << 12;  ///< points per slice: their window fits into a cache

inline std::size_t
numRootSlices(const OctreeCloud& cloud)
{
  return (cloud.size() + kRootSlice - 1) / kRootSlice;
}

/** First root of a slice that no cell 2^growth roots wide shares with the slice before. */
inline std::size_t
firstRoot(const OctreeCloud& cloud, std::size_t slice, int growth)
{
  const std::size_t point = slice * kRootSlice, n = cloud.numRoots();
  if (point >= cloud.size()) return n;
  std::size_t r = cloud.rootOf(point);
  if (cloud.root(r).begin < point) ++r;
  while (r > 0 && r < n && (cloud.root(r).key ^ cloud.root(r - 1).key) >> 3 * growth == 0) ++r;
  return r;
}

/** Runs body(slice, thread, first, last) for the roots [first, last) of every slice; cells 2^growth
 * roots wide are in one slice each, and slices do not depend on threads. body may write to things
 * of its slice only. */
template <typename Body>
void
forEachRootSlice(const OctreeCloud& cloud, int growth, int threads, const Body& body)
{
  parallelFor(numRootSlices(cloud), threads, 1, [&](std::size_t slice, int thread) {
    const std::size_t first = firstRoot(cloud, slice, growth);
    const std::size_t last = firstRoot(cloud, slice + 1, growth);
    if (first < last) body(slice, static_cast<std::size_t>(thread), first, last);
  });
}

/** A cloud's keys, which give the runs of points that share a cell. */
struct RunKeys {
  const std::uint64_t* keys;

  std::uint64_t above(std::size_t i, int shift) const { return keys[i] >> 3 * shift; }

  /** End of the run that starts at begin and shares its cell of that size. */
  std::size_t runEnd(std::size_t begin, std::size_t end, int shift) const
  {
    const std::uint64_t cell = above(begin, shift);
    // Galloping: runs are short compared with the rest of the cloud.
    std::size_t step = 1, low = begin;
    while (low + step < end && above(low + step, shift) == cell) {
      low += step;
      step *= 2;
    }
    std::size_t high = std::min(end, low + step);
    while (low + 1 < high) {
      const std::size_t middle = low + (high - low) / 2;
      (above(middle, shift) == cell ? low : high) = middle;
    }
    return high;
  }

  /** The level at which a run falls apart; -1: at none that keys resolve. */
  int dividingShift(std::size_t begin, std::size_t end) const
  {
    std::uint64_t difference = keys[begin] ^ keys[end - 1];
    int shift = -1;
    for (; difference != 0; difference >>= 3) ++shift;
    return shift;
  }
};

/** Spacing around a cell with too few points for its own: that of the smallest cell of roots around it with
 * enough points, of those in the window that kSpacingReach allows. */
inline double
spacingAround(const OctreeCloud& cloud, const PointWindow& window, const OctreeCell& cell)
{
  const std::size_t r = cloud.rootOf(cell.begin);
  const std::size_t low =
      std::max<std::size_t>(window.begin() + kSpacingReach, cell.begin) - kSpacingReach;
  const std::size_t high = std::min<std::size_t>(window.end(), cell.end + kSpacingReach);
  std::size_t first = r, last = r + 1;
  std::size_t begin = std::max<std::size_t>(low, cloud.root(first).begin);
  std::size_t end = std::min<std::size_t>(high, cloud.root(last).begin);
  for (int growth = 1; end - begin < kSpacingPoints && growth <= OctreeCloud::kBits; ++growth) {
    const std::uint64_t key = cloud.root(r).key >> 3 * growth;
    while (begin > low && cloud.root(first - 1).key >> 3 * growth == key) {
      begin = std::max<std::size_t>(low, cloud.root(--first).begin);
    }
    while (end < high && cloud.root(last).key >> 3 * growth == key) {
      end = std::min<std::size_t>(high, cloud.root(++last).begin);
    }
  }
  return sumsOf(window, begin, end).spacing();
}

/** Joins what slices made, in their order. */
template <typename T>
std::vector<T>
joined(const std::vector<std::vector<T>>& parts)
{
  std::size_t total = 0;
  for (const auto& part : parts) total += part.size();
  std::vector<T> all;
  all.reserve(total);
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace pcl_slim::detail

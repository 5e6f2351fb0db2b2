// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "cell_sums.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/splat/octree_cloud.h"

namespace pcl_slim {

constexpr std::size_t kSpacingPoints = 8;  ///< fewer points do not tell how dense they lie
constexpr int kBitsPerLevel = 3;

/** Runs visit(slice, begin, end) for every root cell; a root belongs to the slice it starts in, and
 * slices do not depend on threads. visit may write to things of its slice only. */
template <typename Visit>
void
forEachRoot(const OctreeCloud& cloud, int shift, int threads, const Visit& visit);

constexpr std::size_t kRootSlice = 1 << 14;  ///< points per slice

inline std::size_t
numRootSlices(const OctreeCloud& cloud)
{
  return (cloud.size() + kRootSlice - 1) / kRootSlice;
}

/** End of the run that starts at begin and shares its key above shift. */
inline std::size_t
runEnd(const std::uint64_t* keys, std::size_t begin, std::size_t end, int shift)
{
  const std::uint64_t bits = std::uint64_t{1} << kBitsPerLevel * shift;
  const std::uint64_t next = (keys[begin] | (bits - 1)) + 1;
  // Galloping: runs are short beside what is left of the cloud.
  std::size_t step = 1, low = begin;
  while (low + step < end && keys[low + step] < next) {
    low += step;
    step *= 2;
  }
  return static_cast<std::size_t>(
      std::lower_bound(keys + low + 1, keys + std::min(end, low + step), next) - keys);
}

template <typename Visit>
void
forEachRoot(const OctreeCloud& cloud, int shift, int threads, const Visit& visit)
{
  const std::size_t n = cloud.size();
  const std::uint64_t* keys = cloud.keys();
  const int bits = kBitsPerLevel * shift;
  parallelFor(numRootSlices(cloud), threads, 1, [&](std::size_t slice, int) {
    const std::size_t slice_end = std::min(n, (slice + 1) * kRootSlice);
    std::size_t begin = slice * kRootSlice;
    while (begin > 0 && begin < slice_end && keys[begin] >> bits == keys[begin - 1] >> bits)
      ++begin;
    while (begin < slice_end) {
      const std::size_t end = runEnd(keys, begin, n, shift);
      visit(slice, begin, end);
      begin = end;
    }
  });
}

/** The level at which a run of more than one point falls apart; -1: all keys are equal. */
inline int
dividingShift(const OctreeCloud& cloud, std::size_t begin, std::size_t end)
{
  std::uint64_t difference = cloud.keys()[begin] ^ cloud.keys()[end - 1];
  int bit = -1;
  while (difference != 0) {
    difference >>= kBitsPerLevel;
    ++bit;
  }
  return bit;
}

/** Spacing around a run too short to tell: that of the smallest cell around it with enough points.
 * Looks at a bounded number of points. */
inline double
spacingAround(const OctreeCloud& cloud, std::size_t begin, std::size_t end, int shift)
{
  constexpr std::size_t kReach = 32;  ///< points to look at on either side
  const std::uint64_t* keys = cloud.keys();
  const std::size_t first = begin > kReach ? begin - kReach : 0;
  const std::size_t last = std::min(cloud.size(), end + kReach);
  while (end - begin < kSpacingPoints && shift < OctreeCloud::kBits) {
    ++shift;
    const int bits = kBitsPerLevel * shift;
    const std::uint64_t cell = keys[begin] >> bits;
    while (begin > first && keys[begin - 1] >> bits == cell) --begin;
    while (end < last && keys[end] >> bits == cell) ++end;
  }
  return sumsOf(cloud, begin, end).spacing();
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

}  // namespace pcl_slim

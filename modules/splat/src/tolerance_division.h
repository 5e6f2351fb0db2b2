// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "color_octree.h"
#include "octree_runs.h"

namespace pcl_slim {

/** Divides roots until no rule asks for more; leaf(cell, sums) receives what stays whole, in Morton
 * order, while its points stand in the window. Chains of cells that hold the same points are
 * skipped. */
template <typename Leaf>
class Divider {
 public:
  Divider(const OctreeCloud& cloud, const SplitRule& rule, PointWindow& window, const Leaf& leaf)
      : cloud_(cloud),
        rule_(rule),
        window_(window),
        leaf_(leaf),
        color_limit_(rule.color_error * rule.color_error),
        normal_limit_(rule.geometric_error * rule.geometric_error),
        least_shift_(std::max(0, cloud.depth() - rule.max_depth))
  {
  }

  void root(std::size_t begin, std::size_t end)
  {
    divide(begin, end, cloud_.depth(), 0.0, keysOf(cloud_));
  }

 private:
  void divide(std::size_t begin, std::size_t end, int shift, double spacing, RunKeys keys)
  {
    const std::size_t n = end - begin;
    const CellSums sums = sumsOf(window_, begin, end);
    if (n >= kSpacingPoints) spacing = sums.spacing();
    if (n > 1 && n >= rule_.min_points && least_shift_ < shift && asksForMore(sums)) {
      int children = keys.keys ? keys.dividingShift(begin, end) : -1;
      if (children < keys.lowest && keys.lowest > least_shift_) {
        keys = refine(cloud_, window_, begin, end, keys_);
        children = keys.dividingShift(begin, end);
      }
      if (children >= least_shift_) {
        for (std::size_t at = begin; at < end;) {
          const std::size_t next = keys.runEnd(at, end, children);
          divide(at, next, children, spacing, keys);
          at = next;
        }
        return;
      }
      shift = std::min(shift, least_shift_);
    }
    leaf_({static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end),
           static_cast<float>(spacing), shift},
          sums);
  }

  bool asksForMore(const CellSums& sums) const
  {
    const double slack = 1.0 + rule_.noise_z / std::sqrt(sums.count - 1.0);
    if (sums.colorVariance() > color_limit_ + rule_.noise.color * slack) return true;
    const double limit = normal_limit_ + rule_.noise.normal * slack;
    return rule_.oriented ? sums.orientedVariance() > limit : sums.unorientedAbove(limit);
  }

  const OctreeCloud& cloud_;
  const SplitRule& rule_;
  PointWindow& window_;
  const Leaf& leaf_;
  double color_limit_, normal_limit_;
  int least_shift_;
  AlignedVector<std::uint64_t> keys_;  ///< of one run that the cloud's keys do not tell apart
};

/** Divides every occupied root cell; leaf(slice, window, cell, sums) for each cell that stays
 * whole, in Morton order within a slice. O(N) per level that is divided; the same cells for any
 * number of threads. */
template <typename Leaf>
void
divideByTolerance(const OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule,
                  int threads, const Leaf& leaf)
{
  std::vector<PointWindow> windows(static_cast<std::size_t>(threads));
  forEachRootSlice(cloud, 0, threads,
                   [&](std::size_t slice, std::size_t thread, std::size_t first, std::size_t last) {
                     PointWindow& window = windows[thread];
                     const std::size_t begin = cloud.root(first).begin,
                                       end = cloud.root(last).begin;
                     window.load(cloud, source, begin - std::min(begin, kSpacingReach),
                                 std::min(cloud.size(), end + kSpacingReach));
                     const auto own = [&](const OctreeCell& cell, const CellSums& sums) {
                       leaf(slice, window, cell, sums);
                     };
                     Divider<decltype(own)> divider(cloud, rule, window, own);
                     for (std::size_t r = first; r < last; ++r) {
                       divider.root(cloud.root(r).begin, cloud.root(r + 1).begin);
                     }
                   });
}

}  // namespace pcl_slim

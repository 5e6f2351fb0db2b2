// SPDX-License-Identifier: BSD-3-Clause
// Step 2 of docs/color_octree_splat_sampler.md: cubes are halved while they vary too much.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "octree/cell_batch.h"
#include "octree/octree_runs.h"

namespace pcl_slim::detail {

/** Divides roots until no rule asks for more; leaves receives what stays whole, in Morton order.
 * Chains of cells that hold the same points are skipped. */
class Divider {
 public:
  Divider(const OctreeCloud& cloud, const SplitRule& rule, const PointWindow& window,
          CellBatch& leaves)
      : cloud_(cloud),
        keys_{cloud.keys()},
        rule_(rule),
        window_(window),
        leaves_(leaves),
        color_limit_(rule.color_error * rule.color_error),
        normal_limit_(rule.geometric_error * rule.geometric_error),
        least_shift_(std::max(0, cloud.depth() - rule.max_depth))
  {
  }

  void root(std::size_t begin, std::size_t end) { divide(begin, end, cloud_.depth(), 0.0); }

 private:
  void divide(std::size_t begin, std::size_t end, int shift, double spacing)
  {
    const std::size_t n = end - begin;
    const CellSums sums = sumsOf(window_, begin, end);
    if (n >= kSpacingPoints) spacing = sums.spacing();
    if (n > 1 && n >= rule_.min_points && least_shift_ < shift && asksForMore(sums)) {
      const int children = keys_.dividingShift(begin, end);
      if (children >= least_shift_) {
        for (std::size_t at = begin; at < end;) {
          const std::size_t next = keys_.runEnd(at, end, children);
          divide(at, next, children, spacing);
          at = next;
        }
        return;
      }
      shift = std::min(shift, least_shift_);
    }
    leaves_.add({static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end),
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
  RunKeys keys_;
  const SplitRule& rule_;
  const PointWindow& window_;
  CellBatch& leaves_;
  double color_limit_, normal_limit_;
  int least_shift_;
};

/** Divides every occupied root cell; leaves(slice, window, batch) for the cells of each slice that stay
 * whole, in Morton order. O(N) per level that is divided; the same cells for any number of threads. */
template <typename Leaves>
void
divideByTolerance(const OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule,
                  int threads, const Leaves& leaves)
{
  std::vector<PointWindow> windows(static_cast<std::size_t>(threads));
  std::vector<CellBatch> batches(windows.size());
  forEachRootSlice(cloud, 0, threads,
                   [&](std::size_t slice, std::size_t thread, std::size_t first, std::size_t last) {
                     PointWindow& window = windows[thread];
                     CellBatch& batch = batches[thread];
                     window.loadAround(cloud, source, cloud.root(first).begin,
                                       cloud.root(last).begin, kSpacingReach);
                     batch.clear();
                     Divider divider(cloud, rule, window, batch);
                     for (std::size_t r = first; r < last; ++r) {
                       divider.root(cloud.root(r).begin, cloud.root(r + 1).begin);
                     }
                     leaves(slice, window, batch);
                   });
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/splat/color_octree.h"

#include <algorithm>
#include <cmath>

#include "octree_roots.h"

namespace pcl_slim {

namespace {

/** Divides the roots of one slice. */
class Divider {
 public:
  Divider(const OctreeCloud& cloud, const SplitRule& rule, std::vector<OctreeCell>& cells)
      : cloud_(cloud),
        rule_(rule),
        cells_(cells),
        least_shift_(std::max(0, cloud.depth() - rule.max_depth))
  {
  }

  void root(std::size_t begin, std::size_t end)
  {
    double spacing = 0;
    if (end - begin < kSpacingPoints) spacing = spacingAround(cloud_, begin, end, cloud_.depth());
    divide(begin, end, cloud_.depth(), spacing);
  }

 private:
  void divide(std::size_t begin, std::size_t end, int shift, double spacing)
  {
    const std::size_t n = end - begin;
    if (n >= kSpacingPoints || (n >= rule_.min_points && n > 1)) {
      const CellSums sums = sumsOf(cloud_, begin, end);
      if (n >= kSpacingPoints) spacing = sums.spacing();
      if (asksForMore(sums)) {
        const int children = std::max(dividingShift(cloud_, begin, end), -1);
        if (children >= least_shift_) {
          for (std::size_t at = begin; at < end;) {
            const std::size_t next = runEnd(cloud_.keys(), at, end, children);
            divide(at, next, children, spacing);
            at = next;
          }
          return;
        }
        shift = std::min(shift, least_shift_);
      }
    }
    cells_.push_back({static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end),
                      static_cast<float>(spacing), shift});
  }

  bool asksForMore(const CellSums& sums) const
  {
    if (sums.count < 2 || sums.count < rule_.min_points) return false;
    const double slack = 1.0 + rule_.noise_z / std::sqrt(sums.count - 1.0);
    const double color_limit = rule_.color_error * rule_.color_error + rule_.noise.color * slack;
    if (cloud_.hasColors() && sums.colorVariance() > color_limit) return true;
    const double limit = rule_.geometric_error * rule_.geometric_error + rule_.noise.normal * slack;
    return rule_.oriented ? sums.orientedVariance() > limit : sums.unorientedAbove(limit);
  }

  const OctreeCloud& cloud_;
  const SplitRule& rule_;
  std::vector<OctreeCell>& cells_;
  int least_shift_;
};

}  // namespace

std::vector<OctreeCell>
divideByTolerance(const OctreeCloud& cloud, const SplitRule& rule, int threads)
{
  std::vector<std::vector<OctreeCell>> parts(numRootSlices(cloud));
  forEachRoot(cloud, cloud.depth(), resolveThreads(threads),
              [&](std::size_t slice, std::size_t begin, std::size_t end) {
                Divider(cloud, rule, parts[slice]).root(begin, end);
              });
  return joined(parts);
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "noise/patch.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kLeastSide = 1;  ///< a side without a point is none

/** Two parallel sheets through a patch: a common normal, and the height between them. */
struct SheetPair {
  Eigen::Vector3d normal;
  double middle = 0;
};

Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>
axesOf(const Eigen::Matrix3d& matrix)
{
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
  axes.computeDirect(matrix);
  return axes;
}

Eigen::Matrix3d
covarianceOf(const PatchSums& sums, std::size_t count)
{
  const double share = 1 / static_cast<double>(count);
  return share * sums.second - (share * sums.first) * (share * sums.first).transpose();
}

/** Two-means on heights, with the normal of what is left within the two sides. */
SheetPair
pairSheets(const PatchPoints& points, int passes, double* heights)
{
  const PatchSums all = kernels::sumPatch(points);
  SheetPair pair{axesOf(covarianceOf(all, points.size())).eigenvectors().col(0), 0};
  const auto n = static_cast<double>(points.size());
  pair.middle = pair.normal.dot(all.first) / n;
  Eigen::Vector3d above, last_above = Eigen::Vector3d::Zero();
  std::size_t last_count = 0;
  for (int pass = 0; pass < passes; ++pass) {
    kernels::heightsAlong(points, pair.normal, heights);
    const std::size_t count = kernels::sumAbove(points, heights, pair.middle, above);
    if (count < kLeastSide || points.size() - count < kLeastSide) break;
    if (count == last_count && above == last_above) break;  // no point has changed sides
    last_count = count;
    last_above = above;
    const auto a = static_cast<double>(count);
    const Eigen::Vector3d below = (all.first - above) / (n - a);
    above /= a;
    const Eigen::Matrix3d within =
        all.second - a * above * above.transpose() - (n - a) * below * below.transpose();
    pair.normal = axesOf(within).eigenvectors().col(0);
    pair.middle = 0.5 * pair.normal.dot(above + below);
  }
  return pair;
}

}  // namespace

Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>
principalAxes(const PatchPoints& points)
{
  return axesOf(covarianceOf(kernels::sumPatch(points), points.size()));
}

bool
keepOwnSheet(const PatchSheetConstants& constants, Patch& patch)
{
  const std::size_t n = patch.points.size();
  if (n < 2 * kLeastSide) return false;
  thread_local AlignedVector<double> heights;
  heights.resize(n + kPadding);
  const SheetPair pair = pairSheets(patch.points, constants.passes, heights.data());
  kernels::heightsAlong(patch.points, pair.normal, heights.data());
  const HeightGap gap = kernels::gapAbout(heights.data(), n, pair.middle);
  if (n - gap.above < kLeastSide || gap.above < kLeastSide) return false;
  const double spread = std::max(gap.end_below - gap.lowest, gap.highest - gap.begin_above);
  if (gap.begin_above - gap.end_below < constants.gap * spread) return false;
  std::size_t kept = 0;
  double radius_sq = 0;
  for (std::size_t i = 0; i < n; ++i) {
    // The sample itself is at height 0.
    if ((heights[i] > pair.middle) != (0.0 > pair.middle)) continue;
    const Eigen::Vector3d p = patch.points.at(i);
    patch.points.set(kept++, p);
    radius_sq = std::max(radius_sq, p.squaredNorm());
  }
  patch.points.cut(kept);
  patch.radius = std::sqrt(radius_sq);
  return true;
}

}  // namespace pcl_slim::detail

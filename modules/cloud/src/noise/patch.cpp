// SPDX-License-Identifier: BSD-3-Clause
#include "noise/patch.h"

#include <algorithm>

namespace pcl_slim::detail {

Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>
principalAxes(const Eigen::Matrix3Xd& points)
{
  const Eigen::Vector3d mean = points.rowwise().mean();
  const Eigen::Matrix3Xd centered = points.colwise() - mean;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
  axes.computeDirect(centered * centered.transpose() / static_cast<double>(points.cols()));
  return axes;
}

namespace {

constexpr Eigen::Index kLeastSide = 1;  ///< a side without a point is none

/** Two parallel sheets through a patch: a common normal, and the height between them. */
struct SheetPair {
  Eigen::Vector3d normal;
  double middle = 0;
};

/** A patch's points by coordinate: loops over them take several at once. */
class PatchColumns {
 public:
  explicit PatchColumns(const Eigen::Matrix3Xd& points) : columns_(points.transpose()) {}

  Eigen::Index count() const { return columns_.rows(); }

  /** Heights along a normal, in order of the points. */
  const Eigen::VectorXd& heightsAlong(const Eigen::Vector3d& normal)
  {
    heights_.noalias() = columns_ * normal;
    return heights_;
  }

  /** Number and sum of the points that stood above a height when heights were last asked for. */
  double sumAbove(double middle, Eigen::Vector3d& sum) const
  {
    const double *x = columns_.col(0).data(), *y = columns_.col(1).data(),
                 *z = columns_.col(2).data();
    double above = 0, sx = 0, sy = 0, sz = 0;
    for (Eigen::Index i = 0; i < heights_.size(); ++i) {
      const double share = heights_[i] > middle ? 1.0 : 0.0;
      above += share;
      sx += share * x[i];
      sy += share * y[i];
      sz += share * z[i];
    }
    sum = {sx, sy, sz};
    return above;
  }

  Eigen::Vector3d sum() const { return columns_.colwise().sum(); }
  Eigen::Matrix3d products() const { return columns_.transpose() * columns_; }

 private:
  Eigen::MatrixX3d columns_;
  Eigen::VectorXd heights_;
};

/** Two-means on heights, with the normal of what is left within the two sides. */
SheetPair
pairSheets(const Eigen::Matrix3Xd& points, int passes, PatchColumns& columns)
{
  SheetPair pair{principalAxes(points).eigenvectors().col(0), 0};
  const auto n = static_cast<double>(columns.count());
  const Eigen::Vector3d all = columns.sum();
  const Eigen::Matrix3d products = columns.products();
  pair.middle = pair.normal.dot(all) / n;
  Eigen::Vector3d above, last_above = Eigen::Vector3d::Zero();
  double last_count = 0;
  for (int pass = 0; pass < passes; ++pass) {
    columns.heightsAlong(pair.normal);
    const double count = columns.sumAbove(pair.middle, above);
    if (count < kLeastSide || n - count < kLeastSide) break;
    if (count == last_count && above == last_above) break;  // no point has changed sides
    last_count = count;
    last_above = above;
    const Eigen::Vector3d below = (all - above) / (n - count);
    above /= count;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
    axes.computeDirect(products - count * above * above.transpose() -
                       (n - count) * below * below.transpose());
    pair.normal = axes.eigenvectors().col(0);
    pair.middle = 0.5 * pair.normal.dot(above + below);
  }
  return pair;
}

}  // namespace

bool
keepOwnSheet(const PatchSheetConstants& constants, Patch& patch)
{
  const Eigen::Index n = patch.points.cols();
  if (n < 2 * kLeastSide) return false;
  PatchColumns columns(patch.points);
  const SheetPair pair = pairSheets(patch.points, constants.passes, columns);
  const Eigen::VectorXd& heights = columns.heightsAlong(pair.normal);
  const double lowest = heights.minCoeff(), highest = heights.maxCoeff();
  double end_below = lowest, begin_above = highest;
  Eigen::Index above = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double h = heights[i];
    above += h > pair.middle;
    end_below = std::max(end_below, h > pair.middle ? lowest : h);
    begin_above = std::min(begin_above, h > pair.middle ? h : highest);
  }
  if (n - above < kLeastSide || above < kLeastSide) return false;
  const double spread = std::max(end_below - lowest, highest - begin_above);
  if (begin_above - end_below < constants.gap * spread) return false;
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    // The sample itself stands at height 0.
    if ((heights[i] > pair.middle) == (0.0 > pair.middle))
      patch.points.col(kept++) = patch.points.col(i);
  }
  patch.points.conservativeResize(3, kept);
  patch.radius = std::sqrt(patch.points.colwise().squaredNorm().maxCoeff());
  return true;
}

}  // namespace pcl_slim::detail

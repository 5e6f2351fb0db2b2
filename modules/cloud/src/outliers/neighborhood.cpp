// SPDX-License-Identifier: BSD-3-Clause
#include "outliers/neighborhood.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "noise/patch.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kEighth = 8;
constexpr double kLine =
    0.05;  ///< second eigenvalue over the greatest, below which points are a line

}  // namespace

std::size_t
Neighborhood::find(std::size_t point, std::size_t count, const unsigned char* left_out,
                   std::size_t among)
{
  search_.nearest(point, among + 1, found_, distances_sq_);
  others_.resize(3, static_cast<Eigen::Index>(count));
  distances_.clear();
  const auto center = store_.position(point);
  for (std::size_t j = 0; j < found_.size() && distances_.size() < count; ++j) {
    const std::size_t other = found_[j];
    if (other == point || (left_out != nullptr && left_out[other] != 0)) continue;
    const auto p = store_.position(other);
    const auto column = static_cast<Eigen::Index>(distances_.size());
    for (std::size_t a = 0; a < 3; ++a)
      others_(static_cast<Eigen::Index>(a), column) = p[a] - center[a];
    distances_.push_back(std::sqrt(static_cast<double>(distances_sq_[j])));
  }
  others_.conservativeResize(3, static_cast<Eigen::Index>(distances_.size()));
  return distances_.size();
}

double
Neighborhood::distance(std::size_t n) const
{
  return n <= distances_.size() ? distances_[n - 1] : std::numeric_limits<double>::infinity();
}

bool
Neighborhood::fillsVolume(double least_ratio) const
{
  Eigen::Matrix3Xd all(3, others_.cols() + 1);
  all << Eigen::Vector3d::Zero(), others_;
  const Eigen::Vector3d spread = principalAxes(all).eigenvalues();
  return spread[0] > least_ratio * spread[2];
}

/** The neighbours that lie as densely as their median does; none if that is no closer to another than a
 * given distance. */
Eigen::Matrix3Xd
Neighborhood::densePatch(double distance) const
{
  constexpr double kAlike = 3;  // times the median's distance to its nearest
  std::vector<double> nearest(static_cast<std::size_t>(others_.cols()),
                              std::numeric_limits<double>::infinity());
  for (Eigen::Index i = 0; i < others_.cols(); ++i) {
    for (Eigen::Index j = 0; j < others_.cols(); ++j) {
      double& least = nearest[static_cast<std::size_t>(i)];
      if (i != j) least = std::min(least, (others_.col(i) - others_.col(j)).norm());
    }
  }
  std::vector<double> sorted = nearest;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  if (!(*middle <= distance)) return Eigen::Matrix3Xd(3, 0);
  Eigen::Matrix3Xd patch(3, others_.cols());
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < others_.cols(); ++i) {
    if (nearest[static_cast<std::size_t>(i)] <= kAlike * *middle)
      patch.col(count++) = others_.col(i);
  }
  return patch.leftCols(count);
}

bool
Neighborhood::standsApart(double closeness, double spreads, double off) const
{
  const Eigen::Matrix3Xd patch = densePatch(distance(kEighth) / closeness);
  if (patch.cols() < 3) return false;
  const Eigen::Vector3d mean = patch.rowwise().mean();
  const auto axes = principalAxes(patch);
  const Eigen::Vector3d spread = axes.eigenvalues().cwiseMax(0.0);
  const double distance_sq = mean.squaredNorm();
  if (!(distance_sq > spreads * spreads * spread.sum())) return false;
  const double along = mean.dot(axes.eigenvectors().col(2)),
               across = mean.dot(axes.eigenvectors().col(0));
  const bool line = spread[1] < kLine * spread[2];
  const double off_sq = line ? distance_sq - along * along : across * across;
  return off_sq > off * off * distance_sq;
}

bool
Neighborhood::standsOffPlane(double heights, double share) const
{
  const Eigen::Vector3d mean = others_.rowwise().mean();
  const auto axes = principalAxes(others_);
  const double height = std::abs(mean.dot(axes.eigenvectors().col(0)));
  const double own = std::sqrt(std::max(0.0, axes.eigenvalues()[0]));
  return height > heights * own && height > share * mean.norm() &&
         height > share * distance(kEighth);
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "outliers/neighborhood.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pcl_slim/cloud/detail/block_kernels.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kEighth = 8;
constexpr double kLine =
    0.05;  ///< second eigenvalue over the greatest, below which points are a line

Eigen::Vector3d
meanOf(const PatchPoints& points)
{
  return kernels::sumPatch(points).first / static_cast<double>(points.size());
}

}  // namespace

std::size_t
Neighborhood::find(std::size_t point, std::size_t count, const unsigned char* left_out,
                   std::size_t among)
{
  search_.nearest(point, among + 1, found_, distances_sq_);
  others_.resize(count);
  distances_.clear();
  const auto center = store_.position(point);
  for (std::size_t j = 0; j < found_.size() && distances_.size() < count; ++j) {
    const std::size_t other = found_[j];
    if (other == point || (left_out != nullptr && left_out[other] != 0)) continue;
    const auto p = store_.position(other);
    others_.set(distances_.size(), {p[0] - center[0], p[1] - center[1], p[2] - center[2]});
    distances_.push_back(std::sqrt(static_cast<double>(distances_sq_[j])));
  }
  others_.cut(distances_.size());
  return distances_.size();
}

bool
Neighborhood::hasOthersWithin(double distance, std::size_t point, std::size_t count,
                              const unsigned char* left_out)
{
  constexpr double kRounding = 1e-5;
  const auto center = store_.position(point);
  const float c[3] = {static_cast<float>(center[0]), static_cast<float>(center[1]),
                      static_cast<float>(center[2])};
  const double sure = distance * (1 - kRounding);
  blocks_.clear();
  store_.tree().blocksInBall(c, static_cast<float>(distance), blocks_);
  const std::size_t most = (blocks_.size() + 1) * PointStore::kBlock;
  within_sq_.resize(most);
  within_.resize(most);
  const std::size_t found =
      kernels::pointsUpTo(store_, blocks_.data(), blocks_.size(), center.data(),
                          static_cast<float>(sure * sure), within_sq_.data(), within_.data());
  if (left_out == nullptr) return found > count;
  const auto isOther = [&](std::uint32_t other) { return other != point && left_out[other] == 0; };
  const auto end = within_.begin() + static_cast<std::ptrdiff_t>(found);
  return static_cast<std::size_t>(std::count_if(within_.begin(), end, isOther)) >= count;
}

double
Neighborhood::distance(std::size_t n) const
{
  return n <= distances_.size() ? distances_[n - 1] : std::numeric_limits<double>::infinity();
}

bool
Neighborhood::fillsVolume(double least_ratio) const
{
  PatchPoints all = others_;
  all.resize(others_.size() + 1);
  all.set(others_.size(), Eigen::Vector3d::Zero());
  const Eigen::Vector3d spread = principalAxes(all).eigenvalues();
  return spread[0] > least_ratio * spread[2];
}

/** The neighbours that lie as densely as their median does; none if that is no closer to another than a
 * given distance. */
PatchPoints
Neighborhood::densePatch(double distance) const
{
  constexpr double kAlike = 3;  // times the median's distance to its nearest
  const std::size_t n = others_.size();
  std::vector<double> nearest(n, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double between = (others_.at(i) - others_.at(j)).norm();
      nearest[i] = std::min(nearest[i], between);
      nearest[j] = std::min(nearest[j], between);
    }
  }
  std::vector<double> sorted = nearest;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  PatchPoints patch;
  if (!(*middle <= distance)) return patch;
  patch.resize(n);
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (nearest[i] <= kAlike * *middle) patch.set(count++, others_.at(i));
  }
  patch.cut(count);
  return patch;
}

bool
Neighborhood::standsApart(double closeness, double spreads, double off) const
{
  const PatchPoints patch = densePatch(distance(kEighth) / closeness);
  if (patch.size() < 3) return false;
  const Eigen::Vector3d mean = meanOf(patch);
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
  const Eigen::Vector3d mean = meanOf(others_);
  const auto axes = principalAxes(others_);
  const double height = std::abs(mean.dot(axes.eigenvectors().col(0)));
  const double own = std::sqrt(std::max(0.0, axes.eigenvalues()[0]));
  return height > heights * own && height > share * mean.norm() &&
         height > share * distance(kEighth);
}

}  // namespace pcl_slim::detail

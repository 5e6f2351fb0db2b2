// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "cell_sums.h"
#include "pcl_slim/splat/color_octree.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kSamples = 2000;
constexpr std::size_t kNeighbors = 8;
constexpr std::size_t kReach = 24;  ///< points before and after a sample to choose neighbours from
// A sample less the mean of k neighbours has the variance of one point times (k + 1) / k.
constexpr double kMeanFactor = static_cast<double>(kNeighbors) / (kNeighbors + 1);
constexpr double kMedian3 = 3.0 / 2.36597;  ///< mean over median of chi squared, 3 degrees
// The mean squared sine to many neighbours: chi squared of 2 degrees for the sample's own share,
// whose median is 1.38629, and its mean 2 for theirs; 2 is one point's variance.
constexpr double kNormalFactor = 2.0 / (1.38629 + 2.0);

double
median(std::vector<double>& values)
{
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double
distanceSq(const OctreePoint& p, const OctreePoint& q)
{
  double sum = 0;
  for (int a = 0; a < 3; ++a) {
    const double d = static_cast<double>(p.position[a]) - q.position[a];
    sum += d * d;
  }
  return sum;
}

double
colorResidual(const OctreePoint& p, const CellSums& near)
{
  double sum = 0;
  for (int a = 0; a < 3; ++a) {
    const double d = p.lab[a] - near.lab[a] / near.count;
    sum += d * d;
  }
  return sum;
}

/** Mean squared sine between a normal and its neighbours'. */
double
normalResidual(const OctreePoint& p, const CellSums& near)
{
  const double* m = near.product;
  const double x = p.normal[0], y = p.normal[1], z = p.normal[2];
  const double along = m[0] * x * x + m[3] * y * y + m[5] * z * z +
                       2.0 * (m[1] * x * y + m[2] * x * z + m[4] * y * z);
  return std::max(0.0, 1.0 - along / near.normals());
}

CellSums
neighborsOf(const OctreeCloud& cloud, std::size_t i)
{
  const std::size_t first = i > kReach ? i - kReach : 0;
  const std::size_t last = std::min(cloud.size(), i + kReach + 1);
  std::array<std::pair<double, std::size_t>, 2 * kReach + 1> near;
  std::size_t count = 0;
  for (std::size_t j = first; j < last; ++j) {
    if (j != i) near[count++] = {distanceSq(cloud.point(i), cloud.point(j)), j};
  }
  const auto end = near.begin() + static_cast<std::ptrdiff_t>(kNeighbors);
  std::partial_sort(near.begin(), end, near.begin() + static_cast<std::ptrdiff_t>(count));
  CellSums sums;
  for (auto it = near.begin(); it != end; ++it) sums.add(cloud.point(it->second));
  return sums;
}

}  // namespace

SampleNoise
estimateSampleNoise(const OctreeCloud& cloud)
{
  SampleNoise noise;
  if (cloud.size() < 4 * kNeighbors) return noise;
  const std::size_t samples = std::min(kSamples, cloud.size());
  std::vector<double> color, normal;
  for (std::size_t s = 0; s < samples; ++s) {
    const std::size_t i = (2 * s + 1) * cloud.size() / (2 * samples);
    const CellSums near = neighborsOf(cloud, i);
    const OctreePoint& p = cloud.point(i);
    color.push_back(colorResidual(p, near));
    const bool has_normal = p.normal[0] != 0 || p.normal[1] != 0 || p.normal[2] != 0;
    if (has_normal && near.normals() > 0) normal.push_back(normalResidual(p, near));
  }
  noise.color = cloud.hasColors() ? kMedian3 * kMeanFactor * median(color) : 0.0;
  noise.normal = kNormalFactor * median(normal);
  return noise;
}

}  // namespace pcl_slim

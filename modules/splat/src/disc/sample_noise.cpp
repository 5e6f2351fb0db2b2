// SPDX-License-Identifier: BSD-3-Clause
#include "disc/sample_noise.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "octree/cell_sums.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kFewestSamples = 150, kSamples = 600;
constexpr std::size_t kPointsPerSample = 1000;  ///< between these two: noise is to cost little
constexpr std::size_t kNeighbors = 8;
// Points before and after a sample along the curve to choose neighbours from.
constexpr std::size_t kLeastReach = 12, kReach = 24;
// A sample less the mean of k neighbours has the variance of one point times (k + 1) / k.
constexpr double kMeanFactor = static_cast<double>(kNeighbors) / (kNeighbors + 1);
constexpr double kMedian3 = 3.0 / 2.36597;  ///< mean over median of chi squared, 3 degrees
// The mean squared sine to many neighbours: chi squared of 2 degrees for the sample's own share,
// whose median is 1.38629, and its mean 2 for theirs; 2 is one point's variance.
constexpr double kNormalFactor = 2.0 / (1.38629 + 2.0);

double
medianOrZero(std::vector<double> values)
{
  return values.empty() ? 0.0 : median(std::move(values));
}

double
colorResidual(const std::array<float, 3>& lab, const CellSums& near)
{
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double d = lab[a] - near.lab[a] / near.count;
    sum += d * d;
  }
  return sum;
}

/** Mean squared sine between a normal and its neighbours'. */
double
normalResidual(const std::array<float, 3>& normal, const CellSums& near)
{
  const Symmetric3<double>& m = near.product;
  const double x = normal[0], y = normal[1], z = normal[2];
  const double along = m[kXX] * x * x + m[kYY] * y * y + m[kZZ] * z * z +
                       2.0 * (m[kXY] * x * y + m[kXZ] * x * z + m[kYZ] * y * z);
  return std::max(0.0, 1.0 - along / near.normals());
}

/** Sums over the window's points nearest to one of them. */
CellSums
neighborsOf(const PointWindow& window, std::size_t own)
{
  std::array<std::pair<float, std::size_t>, kNeighbors> nearest;
  std::size_t found = 0;
  const auto p = window.position(own);
  for (std::size_t j = window.begin(); j < window.end(); ++j) {
    if (j == own) continue;
    const auto q = window.position(j);
    float distance = 0;
    for (std::size_t a = 0; a < 3; ++a) distance += (p[a] - q[a]) * (p[a] - q[a]);
    if (found == kNeighbors && distance >= nearest.back().first) continue;
    std::size_t at = found < kNeighbors ? found++ : kNeighbors - 1;
    for (; at > 0 && nearest[at - 1].first > distance; --at) nearest[at] = nearest[at - 1];
    nearest[at] = {distance, j};
  }
  CellSums sums;
  for (const auto& [distance, j] : nearest) sums.add(window, j, j + 1);
  return sums;
}

}  // namespace

SampleNoise
estimateSampleNoise(const OctreeCloud& cloud, const OctreeSource& source, int threads)
{
  SampleNoise noise;
  const std::size_t n = cloud.size();
  if (n < 4 * kNeighbors) return noise;
  const std::size_t samples =
      std::min(n, std::clamp(n / kPointsPerSample, kFewestSamples, kSamples));
  std::vector<double> color(samples), normal(samples, -1.0);
  std::vector<PointWindow> windows(static_cast<std::size_t>(threads));
  parallelFor(samples, threads, 32, [&](std::size_t s, int thread) {
    const std::size_t i = (2 * s + 1) * n / (2 * samples);
    PointWindow& window = windows[static_cast<std::size_t>(thread)];
    const std::size_t r = cloud.rootOf(i);
    const std::size_t before = std::clamp(i - cloud.root(r).begin, kLeastReach, kReach);
    const std::size_t behind = std::clamp(cloud.root(r + 1).begin - i, kLeastReach, kReach);
    window.load(cloud, source, i - std::min(i, before), std::min(n, i + behind));
    const CellSums near = neighborsOf(window, i);
    color[s] = colorResidual(window.lab(i), near);
    const auto own = window.normal(i);
    const bool has_normal = own[0] != 0 || own[1] != 0 || own[2] != 0;
    if (has_normal && near.normals() > 0) normal[s] = normalResidual(own, near);
  });
  normal.erase(std::remove(normal.begin(), normal.end(), -1.0), normal.end());
  noise.color = source.colors.bgr ? kMedian3 * kMeanFactor * medianOrZero(color) : 0.0;
  noise.normal = kNormalFactor * medianOrZero(normal);
  return noise;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "store/bulk.h"

#include <algorithm>
#include <vector>

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kSample = 4096;
constexpr std::size_t kLeast = 8;  ///< points, below which nothing tells a stray from the others
constexpr double kReach = 0x1p14;

double
quantile(std::vector<double>& values, double share)
{
  const auto at = values.begin() +
                  static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

Bulk
findBulk(std::size_t count, const std::function<std::array<double, 3>(std::size_t i)>& point)
{
  Bulk bulk;
  std::vector<double> columns[3];
  const std::size_t samples = std::min(count, kSample);
  for (std::size_t s = 0; s < samples; ++s) {
    const auto p = point(s * count / samples);
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) continue;
    for (int a = 0; a < 3; ++a) columns[a].push_back(p[a]);
  }
  if (columns[0].size() < kLeast) return bulk;
  double between = 0;
  for (int a = 0; a < 3; ++a) {
    bulk.median[a] = quantile(columns[a], 0.5);
    between = std::hypot(between, quantile(columns[a], 0.75) - quantile(columns[a], 0.25));
  }
  if (between > 0) bulk.reach = kReach * between;
  return bulk;
}

}  // namespace pcl_slim::detail

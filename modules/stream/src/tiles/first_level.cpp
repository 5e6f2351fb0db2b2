// SPDX-License-Identifier: BSD-3-Clause
#include "tiles/first_level.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "cells/point_keys.h"
#include "pcl_slim/cloud/detail/cloud_reader.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kBalls = 31;
constexpr std::uint64_t kCounted = 65536;  ///< points that balls are counted on, about
constexpr double kWideBall = 32.0;         ///< the same of balls that average noise well
constexpr double kNoiseOfBall = 16.0;  ///< sqrt(lambda) in the radius of the narrowest first ball

using Place = std::array<float, 3>;

/** Some of a tile's points in local units, and the places of the balls. */
struct Sample {
  std::vector<Place> points, centers;
  std::uint64_t thinning = 1;
};

Sample
takeSample(const CloudView& core, const StoreFrame& frame)
{
  Sample sample;
  sample.thinning = std::max<std::uint64_t>(1, core.count() / kCounted);
  const CloudReader reader(core);
  std::vector<std::pair<std::uint64_t, Place>> least;
  for (std::size_t i = 0; i < core.count(); ++i) {
    const auto p = reader.position(i);
    const std::uint64_t hash = placeHash(p);
    if (hash % sample.thinning != 0) continue;
    Place local;
    for (std::size_t a = 0; a < 3; ++a)
      local[a] = static_cast<float>((p[a] - frame.origin[a]) / frame.scale);
    sample.points.push_back(local);
    least.emplace_back(hash / sample.thinning, local);
  }
  const std::size_t balls = std::min(kBalls, least.size());
  std::partial_sort(least.begin(), least.begin() + static_cast<std::ptrdiff_t>(balls), least.end());
  for (std::size_t b = 0; b < balls; ++b) sample.centers.push_back(least[b].second);
  return sample;
}

/** How many points a ball has at each level. */
std::vector<std::uint32_t>
countLevels(const Sample& sample, const Place& center, const LevelRadii& radii)
{
  std::vector<float> limits;
  for (int level = 1; level <= radii.last; ++level) {
    const double r = radii.radius(level);
    limits.push_back(static_cast<float>(r * r));
  }
  std::vector<std::uint32_t> counts(limits.size() + 1,
                                    0);  // by the finest level that holds a point
  for (const Place& p : sample.points) {
    const float x = p[0] - center[0], y = p[1] - center[1], z = p[2] - center[2];
    const float d = x * x + y * y + z * z;
    std::size_t level = 0;
    while (level < limits.size() && d < limits[level]) ++level;
    ++counts[level];
  }
  for (std::size_t k = counts.size() - 1; k > 0; --k) counts[k - 1] += counts[k];
  return counts;
}

}  // namespace

int
firstLevel(const CloudView& core, const StoreFrame& frame, const LevelRadii& radii,
           std::uint64_t most_points, double lambda, std::vector<std::uint64_t>& gathered)
{
  const Sample sample = takeSample(core, frame);
  gathered.assign(static_cast<std::size_t>(radii.last) + 1, 0);
  std::vector<std::uint32_t> crowded(static_cast<std::size_t>(radii.last) + 1, 0);
  for (const Place& center : sample.centers) {
    const std::vector<std::uint32_t> counts = countLevels(sample, center, radii);
    for (std::size_t k = 1; k < crowded.size(); ++k)
      crowded[k] += counts[k] * sample.thinning > most_points;
    // A ball reaches as far as one of the level above is wide.
    for (std::size_t k = 1; k < crowded.size(); ++k)
      gathered[k] = std::max(gathered[k], counts[k - 1] * sample.thinning);
  }
  int level = 1;
  while (level < radii.last && 2 * crowded[static_cast<std::size_t>(level)] > sample.centers.size())
    ++level;
  while (level > 1 && radii.radius(level) < kWideBall * std::sqrt(lambda)) --level;
  return level;
}

bool
isFirstLevel(const LevelRadii& radii, int level, double lambda)
{
  return level <= radii.last && radii.radius(level) >= kNoiseOfBall * std::sqrt(lambda);
}

}  // namespace pcl_slim::detail

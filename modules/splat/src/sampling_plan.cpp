// SPDX-License-Identifier: BSD-3-Clause
#include "sampling_plan.h"

#include <limits>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr double kPointsPerRoot = 50.0;  ///< the paper's own start: 2 % of the points
constexpr double kRootsPerSplat = 0.25;  ///< budgets start from cells twice as wide as even ones
constexpr double kPointsPerErrorRoot = 256.0;  ///< budgets of error: coarse enough for any error
constexpr double kColorOff = 1.0;              ///< a colour error from here on ignores colour
constexpr double kLabPerUnit = 100.0;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

SamplingPlan::SamplingPlan(const SplatParams& given) : params(given)
{
  params.threads = resolveThreads(params.threads);
  if (params.paper_mode) {
    params.rgb_space = RgbSpace::kEbu;
    params.color = SplatColor::kOwn;
    params.radius = RadiusRule::kCorner;
    params.remove_noise = false;
    params.min_points = 2;
  }
}

bool
SamplingPlan::needsNoise() const
{
  const bool by_bend = params.radius == RadiusRule::kDensity;
  const bool shapes = params.color == SplatColor::kGradient || by_bend;
  return params.remove_noise && (shapes || !isUniform());
}

RootGrid
SamplingPlan::rootGrid() const
{
  RootGrid grid;
  if (params.max_splats > 0) {
    grid.occupied = kRootsPerSplat * static_cast<double>(params.max_splats);
  } else if (params.initial_resolution > 0) {
    grid.resolution = params.initial_resolution;
  } else {
    grid.points_per_root = params.target_error > 0 ? kPointsPerErrorRoot : kPointsPerRoot;
  }
  return grid;
}

SplitRule
SamplingPlan::splitRule(const SampleNoise& noise, bool normals_estimated) const
{
  SplitRule rule;
  rule.geometric_error = params.geometric_error;
  rule.color_error = params.color_error < kColorOff ? kLabPerUnit * params.color_error : kInfinity;
  rule.oriented = params.paper_mode && !normals_estimated;
  rule.noise = noise;
  rule.min_points = params.min_points;
  rule.max_depth = params.max_depth;
  return rule;
}

}  // namespace pcl_slim::detail

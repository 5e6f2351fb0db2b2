// SPDX-License-Identifier: BSD-3-Clause
#include "ball/ball_gather.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

void
takeEveryNth(const BlockList& blocks, std::size_t stride, BlockList& taken)
{
  taken.clear();
  for (std::size_t b = 0; b < blocks.size(); b += stride) taken.push_back(blocks[b]);
}

}  // namespace

std::array<float, 3>
onCenterGrid(const std::array<double, 3>& place, double grid)
{
  std::array<float, 3> center;
  for (std::size_t a = 0; a < 3; ++a)
    center[a] = static_cast<float>(std::round(place[a] / grid) * grid);
  return center;
}

BallSite
siteOf(const PointStore& store, const FitSettings& settings, std::size_t i, double radius)
{
  const double noise_ratio = settings.noiseRatioAt(i, store.size());
  BallSite site;
  site.center = onCenterGrid(store.position(i), settings.center_grid);
  if (settings.with_normals) site.normal = store.normal(i);
  site.sided = site.normal != std::array<float, 3>{};
  site.radius = radius;
  site.lambda = noise_ratio * settings.energy.lambda;
  site.noise = noise_ratio * settings.noise;
  return site;
}

GatheredBall
BallGatherer::gather(const BallSite& site, std::size_t stride)
{
  const BlockList* blocks = &nearby_.within(site.center, site.radius);
  if (stride > 1) {
    takeEveryNth(*blocks, stride, sampled_);
    blocks = &sampled_;
  }
  GatheredBall ball;
  ball.site = site;
  ball.points = &points_;
  const BallQuery query{site.center, static_cast<float>(site.radius),
                        site.sided ? site.normal.data() : nullptr, settings_.min_dot,
                        settings_.normal_error > 0};
  kernels::gatherBall(store_, *blocks, query, !site.sided, points_, ball.sums);
  gathered_ += points_.count;
  return ball;
}

bool
normalIsAlone(const GatheredBall& ball, const FitSettings& settings)
{
  if (!settings.with_normals || !settings.skip_lone_normals) return false;
  const BallConstants& constants = settings.constants.ball;
  const BallSums& sums = ball.sums;
  const auto on_its_side = static_cast<double>(ball.points->count);
  if (on_its_side < constants.lone_share * static_cast<double>(sums.inside)) return true;
  const auto& n = sums.normal;
  const auto& own = ball.site.normal;
  return n[0] * own[0] + n[1] * own[1] + n[2] * own[2] < constants.lone_cosine * sums.weight;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "ball/ball_gather.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/oct_normal.h"

namespace pcl_slim::detail {

namespace {

void
takeEveryNth(const BlockList& blocks, std::size_t stride, BlockList& taken)
{
  taken.clear();
  for (std::size_t b = 0; b < blocks.size(); b += stride) taken.push_back(blocks[b]);
}

/** The mean normal; the site's own where the points' cancel. */
Vector3
meanNormal(const BallSums& sums, const BallSite& site)
{
  const Vector3& n = sums.normal;
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (length > FloatLimits::kNormalLength * sums.weight)
    return {n[0] / length, n[1] / length, n[2] / length};
  return {site.normal[0], site.normal[1], site.normal[2]};
}

/** The direction of least spread; z where all points coincide. */
Vector3
leastSpread(const BallSums& sums)
{
  const auto& s = sums.second;
  const double inverse = 1.0 / sums.weight;
  const Eigen::Vector3d mean =
      Eigen::Vector3d(sums.first[0], sums.first[1], sums.first[2]) * inverse;
  Eigen::Matrix3d covariance;
  covariance << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
  covariance = covariance * inverse - mean * mean.transpose();
  covariance /= std::max(covariance.trace(), 1e-300);  // no division by 0
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
  axes.computeDirect(covariance);
  const Eigen::Vector3d n = axes.eigenvectors().col(0);
  if (!n.allFinite() || n.squaredNorm() < 0.5) return {0.0, 0.0, 1.0};
  return {n[0], n[1], n[2]};
}

/** The weighted sums of a ball that is framed already, in its frame. */
BallSums
sumsOf(const BallBuffer& ball)
{
  BallSums sums;
  for (std::size_t i = 0; i < ball.count; ++i) {
    const double g = evaluateKernel(WeightKernel::kPower4, ball.s_sq[i]);
    const double p[3] = {ball.u[i], ball.v[i], ball.w[i]};
    sums.weight += g;
    for (std::size_t a = 0, k = 0; a < 3; ++a) {
      sums.first[a] += g * p[a];
      for (std::size_t b = a; b < 3; ++b, ++k) sums.second[k] += g * p[a] * p[b];
    }
  }
  return sums;
}

/** The axes of one frame in coordinates of another. */
LocalFrame
frameWithin(const LocalFrame& frame, const LocalFrame& other)
{
  const auto coordinates = [&](const Vector3& axis) {
    return Vector3{dot(axis, other.u), dot(axis, other.v), dot(axis, other.w)};
  };
  LocalFrame within;
  within.u = coordinates(frame.u);
  within.v = coordinates(frame.v);
  within.w = coordinates(frame.w);
  return within;
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
siteOf(const PointStore& store, const FitPlan& plan, std::size_t i, double radius)
{
  const double noise_ratio = plan.noiseRatioAt(i, store.size());
  BallSite site;
  site.center = onCenterGrid(store.position(i), plan.center_grid);
  if (plan.with_normals) site.normal = store.normal(i);
  site.sided = site.normal != std::array<float, 3>{};
  site.radius = radius;
  site.lambda = noise_ratio * plan.energy.lambda;
  site.noise = noise_ratio * plan.noise;
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
                        site.sided ? site.normal.data() : nullptr, plan_.min_dot,
                        plan_.normal_error > 0};
  kernels::gatherBall(store_, *blocks, query, !site.sided, points_, ball.sums);
  gathered_ += points_.count;
  return ball;
}

bool
normalIsAlone(const GatheredBall& ball, const FitPlan& plan)
{
  if (!plan.with_normals || !plan.skip_lone_normals) return false;
  const BallConstants& constants = plan.constants.ball;
  const BallSums& sums = ball.sums;
  const auto on_its_side = static_cast<double>(ball.points->count);
  if (on_its_side < constants.lone_share * static_cast<double>(sums.inside)) return true;
  const auto& n = sums.normal;
  const auto& own = ball.site.normal;
  return n[0] * own[0] + n[1] * own[1] + n[2] * own[2] < constants.lone_cosine * sums.weight;
}

FramedBall
framed(const GatheredBall& ball, const FitPlan& plan)
{
  const BallSite& site = ball.site;
  FramedBall result{site, {}, ball.points};
  result.normal = snapNormal(site.sided ? meanNormal(ball.sums, site) : leastSpread(ball.sums));
  if (plan.normal_error > 0) {
    // An error of the normal's direction has half its variance in each of two slopes.
    const double slope_error = plan.normal_error * site.radius;
    ball.points->slope_weight = 2.0 * site.noise / (slope_error * slope_error);
  }
  kernels::toFrame(result.frame(), static_cast<float>(site.radius), *ball.points);
  return result;
}

FramedBall
reframed(const FramedBall& ball)
{
  const BallSums sums = sumsOf(*ball.points);
  if (!(sums.weight > 0)) return ball;
  const LocalFrame old = ball.frame();
  const Vector3 local = leastSpread(sums);
  Vector3 normal;
  for (std::size_t a = 0; a < 3; ++a)
    normal[a] = local[0] * old.u[a] + local[1] * old.v[a] + local[2] * old.w[a];
  FramedBall result = ball;
  result.normal = snapNormal(normal);
  kernels::toFrame(frameWithin(result.frame(), old), 1.0f, *ball.points);
  return result;
}

}  // namespace pcl_slim::detail

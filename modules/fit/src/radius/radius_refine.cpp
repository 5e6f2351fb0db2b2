// SPDX-License-Identifier: BSD-3-Clause
// What becomes of a ball once its radius is chosen, or where none could be.
#include <algorithm>
#include <cmath>

#include "radius/radius_search.h"

namespace pcl_slim::detail {

namespace {

constexpr double kDataMargin = 1.25;  ///< a ball reaches at most so far past its farthest point
constexpr double kBlob = 0.02;        ///< e / r of a few points beyond which they are no surface
constexpr int kRobustPasses = 2;
constexpr double kRobustScale = 2.5;

}  // namespace

RadiusChoice
RadiusSearch::fallBack()
{
  const Trial wide = evaluate(1.0);
  if (wide.supported) {
    const Trial wall = evaluateWall(1.0);
    return surfaceOrNothing(wall.supported ? wall : wide);
  }
  Trial lower = evaluate(rho_right_);
  if (lower.fit.degree == 0) lower = wide;
  if (lower.fit.degree == 0) return {RadiusChoice::Kind::kSparse, lower, false};
  // No wider than the lower degree needs: a few lone points are no surface all over the ball.
  const int degree = lower.fit.degree;
  const Trial wall =
      evaluate(wallRadius(lower.rho, degree, settings_.fit_kernel), degree, settings_.fit_kernel);
  return surfaceOrNothing(wall.supported ? wall : lower);
}

/** A forced leaf, unless its few points are scattered about it rather than on it. */
RadiusChoice
RadiusSearch::surfaceOrNothing(const Trial& trial) const
{
  const bool scattered = !settings_.paper && lacksFit(trial, trial) &&
                         trial.fit.residual_sq > kBlob * kBlob * trial.rho * trial.rho;
  return scattered ? RadiusChoice{RadiusChoice::Kind::kSparse, trial, false}
                   : RadiusChoice{RadiusChoice::Kind::kLeaf, trial, true};
}

/** A ball much wider than its points would spread the leaf over empty space: shrinks it to them,
 * as far as support allows. */
double
RadiusSearch::radiusOfData(const Trial& trial, WeightKernel kernel)
{
  const BallBuffer& points = pointsWithin(trial.rho);
  // The least float that is not below rho^2 has the same floats below it.
  const double rho_sq = trial.rho * trial.rho;
  auto limit_sq = static_cast<float>(rho_sq);
  if (limit_sq < rho_sq) limit_sq = std::nextafter(limit_sq, 2.0f * limit_sq);
  const float farthest_sq = kernels::farthestWithin(points, limit_sq);
  const double extent = kDataMargin * std::sqrt(farthest_sq);
  if (extent >= trial.rho) return trial.rho;
  return std::max(extent, wallRadius(trial.rho, trial.fit.degree, kernel));
}

Trial
RadiusSearch::refine(const RadiusChoice& choice)
{
  const bool at_wall = choice.forced && choice.trial.supported && !settings_.paper;
  const WeightKernel kernel = at_wall ? settings_.wall_kernel : settings_.fit_kernel;
  Trial result = choice.trial;
  if (!settings_.paper) result.rho = radiusOfData(choice.trial, kernel);
  if (!refit(pointsWithin(result.rho), kernel, result)) {
    // Rounding cost a pivot: the accepted fit stands, made again with its coefficients.
    return evaluate(choice.trial.rho, choice.trial.fit.degree, kernel);
  }
  if (!settings_.robust) return result;
  kernels::compactBall(*ball_, static_cast<float>(result.rho * result.rho), robust_);
  const double spread_sq = result.fit.residual_sq;
  for (int pass = 0; pass < kRobustPasses; ++pass) {
    setRobustWeights(result.fit);
    if (!refit(robust_, kernel, result)) break;
  }
  // e stays what all points make it: cover takes in what lies within 5 e, outlying points too.
  result.fit.residual_sq = std::max(result.fit.residual_sq, spread_sq);
  return result;
}

/** Fits the trial's degree and radius with refinement; leaves it alone where that degree fails. */
bool
RadiusSearch::refit(const BallBuffer& points, WeightKernel kernel, Trial& trial)
{
  ++fits_;
  // The degree was settled with the full support; rounding must not undo it here.
  const LocalFit fit = kernels::fitBall(points, trial.fit.degree, static_cast<float>(trial.rho),
                                        kernel, 0.5 * settings_.support, true);
  if (fit.degree != trial.fit.degree) return false;
  trial.fit = fit;
  return true;
}

/** Cauchy-like weights against outliers; the scale is the noise, or the fit where that is worse. */
void
RadiusSearch::setRobustWeights(const LocalFit& fit)
{
  residuals_.resize(robust_.count + BallBuffer::kPadding);
  kernels::ballResiduals(robust_, fit, residuals_.data());
  const double noise_sq = energy_.lambda / (gather_radius_ * gather_radius_);
  const double scale_sq = kRobustScale * kRobustScale * std::max(noise_sq, 0.25 * fit.residual_sq);
  robust_.prior.assign(robust_.u.size(), 1.0f);
  for (std::size_t i = 0; i < robust_.count && scale_sq > 0; ++i) {
    const double q = 1.0 / (1.0 + residuals_[i] * residuals_[i] / scale_sq);
    robust_.prior[i] = static_cast<float>(q * q);
  }
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "radius/sparse_fallback.h"

namespace pcl_slim::detail {

namespace {

/** A support-limited leaf, unless its few points are scattered about it. */
RadiusChoice
surfaceOrNothing(const TrialFits& trials, const ResidualTests& tests, const Trial& trial)
{
  const double ratio = trials.constants().scattered_ratio;
  const bool scattered =
      tests.lacksFit(trial) && trial.fit.residual_sq > ratio * ratio * trial.rho * trial.rho;
  return scattered ? RadiusChoice::sparse(trial) : RadiusChoice::supportLimited(trial);
}

/** The highest degree with support at r_r, else at the gather radius; degree 0 where there is none.
 */
Trial
fitOfLowerDegree(TrialFits& trials, const Trial& wide)
{
  const Trial lower = trials.at(trials.samples().rhoRight());
  return lower.fit.degree > 0 ? lower : wide;
}

}  // namespace

RadiusChoice
fallBackWhereSparse(TrialFits& trials, const ResidualTests& tests)
{
  const Trial wide = trials.at(1.0);
  if (wide.supported) {
    const Trial least = trials.atMinimumSupport(1.0);
    return surfaceOrNothing(trials, tests, least.supported ? least : wide);
  }
  const Trial lower = fitOfLowerDegree(trials, wide);
  const int degree = lower.fit.degree;
  if (degree == 0) return RadiusChoice::sparse(lower);
  // No wider than the lower degree needs: a few lone points are no surface all over the ball.
  const WeightKernel kernel = trials.settings().fit_kernel;
  const double rho = trials.minimumSupportRadius(lower.rho, degree, kernel);
  const Trial least = trials.at(rho, degree, kernel);
  return surfaceOrNothing(trials, tests, least.supported ? least : lower);
}

}  // namespace pcl_slim::detail

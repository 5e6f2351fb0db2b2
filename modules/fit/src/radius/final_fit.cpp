// SPDX-License-Identifier: BSD-3-Clause
#include "radius/final_fit.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

Trial
FinalFit::make(const RadiusChoice& choice)
{
  const FitSettings& settings = trials_.settings();
  const Trial& chosen = choice.trial;
  const bool at_minimum_support = choice.support_limited && chosen.supported;
  const WeightKernel kernel = at_minimum_support ? settings.wall_kernel : settings.fit_kernel;
  Trial result = chosen;
  if (!trials_.refit(trials_.samples().within(result.rho), kernel, result)) {
    return chosen;  // rounding, or the other kernel, cost a pivot: the accepted fit stands
  }
  if (settings.robust) fitRobustly(kernel, result);
  return result;
}

/** Fits again with weights against outliers; e stays what all points make it: cover takes in what
 * lies within 5 e, outlying points too. */
void
FinalFit::fitRobustly(WeightKernel kernel, Trial& trial)
{
  kernels::compactBall(trials_.samples().all(), static_cast<float>(trial.rho * trial.rho), robust_);
  const double spread_sq = trial.fit.residual_sq;
  for (int pass = 0; pass < trials_.constants().robust_passes; ++pass) {
    setRobustWeights(trial.fit);
    if (!trials_.refit(robust_, kernel, trial)) break;
  }
  trial.fit.residual_sq = std::max(trial.fit.residual_sq, spread_sq);
}

/** Cauchy-like weights; their scale is the noise. */
void
FinalFit::setRobustWeights(const LocalFit& fit)
{
  const RadiusConstants& constants = trials_.constants();
  const double unit = trials_.samples().gatherRadius();
  residuals_.resize(robust_.count + BallBuffer::kPadding);
  kernels::ballResiduals(robust_, fit, residuals_.data());
  const double scale_sq =
      constants.robust_scale * constants.robust_scale * trials_.noise() / (unit * unit);
  robust_.prior.assign(robust_.u.size(), 1.0f);
  for (std::size_t i = 0; i < robust_.count && scale_sq > 0; ++i) {
    const double q = 1.0 / (1.0 + residuals_[i] * residuals_[i] / scale_sq);
    robust_.prior[i] = static_cast<float>(q * q);
  }
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "radius/rule/feature_degree.h"

namespace pcl_slim::detail {

bool
liesBesideFeature(const TrialFits& trials, const Trial& trial)
{
  const RadiusConstants& constants = trials.constants();
  if (!trials.settings().find_detail || trial.fit.degree <= constants.feature_degree) return false;
  const double e_sq = trials.variance(trial), r = trials.radiusOf(trial);
  return e_sq > constants.feature_height * constants.feature_height * r * r &&
         e_sq > constants.feature_noise * trials.noise();
}

Trial
fitBesideFeature(TrialFits& trials, const Trial& trial)
{
  const RadiusConstants& constants = trials.constants();
  const int degree = constants.feature_degree;
  // Kappa is 1 for the expected error: what is left beside an edge is bias, not luck.
  Energy risk = trials.energy();
  risk.kappa = 1.0;
  Trial best;
  double least = constants.feature_gain * trials.energyOf(trial, risk), rho = trial.rho;
  for (int step = 0; step < constants.feature_steps; ++step, rho *= constants.feature_step) {
    const Trial low = trials.at(rho, degree, trials.settings().fit_kernel);
    const double enough = constants.feature_support * numCoefficients(degree);
    if (!low.supported || low.fit.n_eff < enough) break;
    const double cost = trials.energyOf(low, risk);
    if (cost >= least) continue;
    best = low;
    least = cost;
  }
  return best;
}

}  // namespace pcl_slim::detail

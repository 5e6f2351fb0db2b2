// SPDX-License-Identifier: BSD-3-Clause
#include "radius/fit_comparison.h"

#include <cmath>

#include "least_squares/mean_slope.h"
#include "least_squares/noise_bias.h"

namespace pcl_slim::detail {

/** The coefficients without what noise adds to them on average, which depends on the radius. */
std::array<double, kMaxCoefficients>
FitComparison::unbiased(const Trial& trial) const
{
  auto c = trial.fit.c;
  const double r = trials_.radiusOf(trial);
  undoNoiseBias(trials_.settings().constants.ball.bias, trial.fit.kernel, trial.fit.degree,
                trials_.noise() / (r * r), trial.rho, c.data());
  return c;
}

/** D^2 over the points of the closer fit, with its weights: its moments hold it. */
double
FitComparison::meanSquaredDifference(const Trial& simpler, const Trial& close) const
{
  auto difference = unbiased(simpler);
  const auto own = unbiased(close);
  for (std::size_t k = 0; k < own.size(); ++k) difference[k] -= own[k];
  const LocalFit& fit = close.fit;
  const double unit = trials_.samples().gatherRadius();
  return kernels::meanSquare(fit.moment_degree, fit.moments.data(), difference.data()) * unit *
         unit;
}

bool
FitComparison::acceptsSimpler(const Trial& simpler, const Trial& close, double trust) const
{
  const RadiusConstants& constants = trials_.constants();
  if (!(simpler.energy < constants.comparison_rise * close.energy)) return false;
  const double saved = close.fit.terms / close.fit.n_eff - simpler.fit.terms / simpler.fit.n_eff;
  // The rest of kappa insures against luck, of which there is little here.
  return meanSquaredDifference(simpler, close) < trust * constants.comparison_worth *
                                                     trials_.energy().kappa * trials_.noise() *
                                                     trials_.energy().correlation * saved;
}

Trial
FitComparison::widestAccepted(const Trial& middle, const Trial& right)
{
  const RadiusConstants& constants = trials_.constants();
  const bool flat = right.energy <= trials_.settings().lenience * middle.energy;
  const double trust = flat ? constants.comparison_trust : 1.0;
  if (acceptsSimpler(right, middle, trust) && !tests_.hidesDetail(right)) return right;
  const double step = std::pow(right.rho / middle.rho, 1.0 / constants.comparison_radii);
  Trial widest;
  double rho = middle.rho;
  for (int i = 1; i < constants.comparison_radii; ++i) {
    rho *= step;
    const Trial trial = trials_.at(rho);
    if (!trial.supported || !acceptsSimpler(trial, middle) || tests_.hidesDetail(trial)) break;
    widest = trial;
  }
  return widest;
}

Trial
FitComparison::lowestDegreeAccepted(const Trial& trial)
{
  const RadiusConstants& constants = trials_.constants();
  const bool enough = trial.fit.n_eff > constants.degree_support * trial.fit.terms;
  if (!trials_.settings().compare_nested || !enough || !tests_.isNoise(trial)) return trial;
  for (int degree = constants.least_degree; degree < trial.fit.degree; ++degree) {
    const Trial low = trials_.ofLowerDegree(trial, degree);
    if (low.supported && acceptsSimpler(low, trial)) return low;
  }
  return trial;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "radius/residual_tests.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

bool
ResidualTests::lacksFit(const Trial& left, const Trial& middle, double margin) const
{
  const double limit = trials_.settings().lack_of_fit;
  if (limit <= 0) return false;
  const double e_sq = std::min(trials_.variance(left), trials_.variance(middle));
  return e_sq > margin * limit * limit * trials_.noise();
}

/** Where detail is finer than every radius tried, E does not fall towards smaller ones and looks
 * like that of noise; neighbouring residuals tell. Detail that weighs less than the penalty would
 * cost more noise to resolve than it is worth. */
bool
ResidualTests::hidesDetail(const Trial& trial)
{
  const FitSettings& settings = trials_.settings();
  const RadiusConstants& constants = trials_.constants();
  if (!settings.find_detail || lacksFit(trial)) return false;
  const double correlation = trials_.energy().correlation;
  const double terms = correlation * numCoefficients(trial.fit.degree);
  if (trial.fit.n_eff < constants.detail_support * settings.support * terms) return false;

  BallSamples& samples = trials_.samples();
  const double unit = samples.gatherRadius(), inner = kGolden * trial.rho;
  const double least_cell = constants.detail_cell * std::sqrt(trials_.noise()) / unit;
  const auto found =
      structure_.measure(samples.within(inner), trial.fit, inner, least_cell, correlation);
  if (!(found.deviation > 0)) return false;
  if (found.share < constants.detail_deviations * found.deviation) return false;
  const double shared = found.share * trial.fit.residual_sq * unit * unit;
  return shared >
         constants.detail_worth * trials_.energy().penalty(trial.fit, trials_.radiusOf(trial));
}

}  // namespace pcl_slim::detail

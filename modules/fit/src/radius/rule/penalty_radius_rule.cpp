// SPDX-License-Identifier: BSD-3-Clause
#include "radius/rule/penalty_radius_rule.h"

#include <cmath>

#include "radius/rule/bracket.h"
#include "radius/trial_fits.h"

namespace pcl_slim::detail {
namespace {

/** \brief Whether a fit leaves more than noise and than any smooth surface would: a feature is
 * near. */
bool
liesBesideFeature(const TrialFits& trials, const Trial& trial)
{
  const RadiusConstants& constants = trials.constants();
  if (!trials.settings().find_detail || trial.fit.degree <= constants.feature_degree) return false;
  const double e_sq = trials.variance(trial), r = trials.radiusOf(trial);
  return e_sq > constants.feature_height * constants.feature_height * r * r &&
         e_sq > constants.feature_noise * trials.noise();
}

/** \brief The fit of a low degree in a smaller ball that beats a trial by its expected error.
 *
 * Across an edge no degree fits, and a lower one needs less room. \return an unsupported trial
 * where none does. Up to feature_steps fits. */
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

}  // namespace

RadiusChoice
PenaltyRadiusRule::choose()
{
  const RadiusChoice choice = chooseByEnergy();
  if (choice.kind != RadiusChoice::Kind::kLeaf) return choice;
  if (liesBesideFeature(trials_, choice.trial)) {
    const Trial low = fitBesideFeature(trials_, choice.trial);
    if (low.supported) return RadiusChoice::leaf(low);
  }
  if (choice.support_limited) return choice;
  if (!choice.without_detail && tests_.hidesDetail(choice.trial)) {
    return RadiusChoice::internal(trials_.right());
  }
  return RadiusChoice::leaf(comparison_.lowestDegreeAccepted(choice.trial));
}

RadiusChoice
PenaltyRadiusRule::chooseByEnergy()
{
  const Trial& right = trials_.right();
  if (!right.supported) return RadiusChoice::sparse(right);
  const Trial middle = trials_.middle();
  if (!middle.supported) return chooseAtMinimumSupport(trials_, right, right);
  const bool flat = isLenient(right, middle);
  if (tests_.isNoise(middle)) {
    if (trials_.settings().compare_nested) {
      const Trial wide = comparison_.widestAccepted(middle, right);
      if (wide.supported) return RadiusChoice::withoutDetail(wide);
    } else if (flat) {
      return RadiusChoice::leaf(right);  // E is flat down to the noise: the largest radius serves.
    }
  }
  if (trials_.energy().filledByNoise(trials_.rhoLeft() * trials_.samples().gatherRadius())) {
    return RadiusChoice::leaf(flat ? right : middle);
  }
  const Trial left = trials_.left();
  if (!left.supported) return chooseAtMinimumSupport(trials_, right, middle);
  if (tests_.lacksFit(left, middle)) return RadiusChoice::internal(right);
  return chooseInside(left, middle, right);
}

RadiusChoice
PenaltyRadiusRule::chooseInside(const Trial& left, const Trial& middle, const Trial& right)
{
  const Trial& least = left.energy < middle.energy ? left : middle;
  if (isLenient(right, least)) return RadiusChoice::leaf(right);
  if (left.energy < middle.energy) return RadiusChoice::internal(right);
  // A minimum lies inside (rule 4, first half).
  Bracket bracket{left, middle, right};
  bracket.narrow(trials_);
  if (trials_.settings().lenience > 1.0) {
    return RadiusChoice::leaf(largestLenient(bracket.b, right));
  }
  bracket.narrow(trials_);
  return RadiusChoice::leaf(bracket.b);
}

/** E of a wide ball is as good as the least: under noise E is flat, and its argmin picks balls that
 * are too small. */
bool
PenaltyRadiusRule::isLenient(const Trial& wide, const Trial& least) const
{
  return wide.energy <= trials_.settings().lenience * least.energy;
}

/** The largest radius up to right's with E <= lenience E_min, by bisection of log r. */
Trial
PenaltyRadiusRule::largestLenient(const Trial& best, const Trial& right)
{
  if (isLenient(right, best)) return right;
  Trial inside = best;
  double outside = right.rho;
  for (int step = 0; step < trials_.constants().lenient_steps; ++step) {
    const Trial trial = trials_.at(std::sqrt(inside.rho * outside));
    if (trial.supported && isLenient(trial, best)) {
      inside = trial;
    } else {
      outside = trial.rho;
    }
  }
  return inside;
}

bool
PenaltyRadiusRule::surelyInternal()
{
  const double margin = trials_.constants().sure_margin;
  const Trial& right = trials_.right();
  if (!right.supported) return false;
  const Trial middle = trials_.middle(), left = trials_.left();
  if (!middle.supported || !left.supported) return false;
  if (tests_.lacksFit(left, middle, margin)) return true;
  return margin * left.energy < middle.energy && margin * middle.energy < right.energy;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "radius/radius_search.h"

#include <algorithm>
#include <cmath>

#include "radius/rule/bracket.h"
#include "radius/rule/penalty_radius_rule.h"

namespace pcl_slim::detail {
namespace {

/** \brief The paper's rule: the least E(r) of eq. (3) on the interval of eq. (5), by rule (4). */
class PaperRadiusRule : public RadiusRule {
 public:
  explicit PaperRadiusRule(TrialFits& trials) : trials_(trials) {}

  RadiusChoice choose() override;

  /** \brief Never: the paper looks at all points of a ball. */
  bool surelyInternal() override { return false; }

  /** \brief The radius chosen, as it is. */

 private:
  RadiusChoice chooseAmong(const Trial& left, const Trial& middle, const Trial& right);

  TrialFits& trials_;
};

RadiusChoice
PaperRadiusRule::choose()
{
  const Trial& right = trials_.right();
  if (!right.supported) return RadiusChoice::sparse(right);
  const Trial middle = trials_.middle();
  if (!middle.supported) return chooseAtMinimumSupport(trials_, right, right);
  const Trial left = trials_.left();
  if (!left.supported) return chooseAtMinimumSupport(trials_, right, middle);
  return chooseAmong(left, middle, right);
}

/** Rule (4), with the clamp at r_r where E_l > E_m >= E_r, and Brent's parabolic steps. */
RadiusChoice
PaperRadiusRule::chooseAmong(const Trial& left, const Trial& middle, const Trial& right)
{
  if (left.energy > middle.energy && middle.energy >= right.energy) {
    return RadiusChoice::leaf(right);
  }
  const bool bracketed = left.energy > middle.energy && middle.energy < right.energy;
  const bool monotone = left.fit.residual_sq < middle.fit.residual_sq &&
                        middle.fit.residual_sq < right.fit.residual_sq;
  if (!bracketed || !monotone) return RadiusChoice::internal(right);
  const RadiusConstants& constants = trials_.constants();
  Bracket bracket{left, middle, right};
  for (int step = 0; step < constants.brent_steps && bracket.width() > constants.brent_width;
       ++step) {
    bracket.narrow(trials_);
  }
  return RadiusChoice::leaf(bracket.b);
}

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

/** \brief The best that degree and radius up to the gather radius allow a sparse ball.
 *
 * \return a support-limited leaf; or a sparse ball where no plane can be fitted, or where the few
 * points are scattered about the fit rather than on it. */
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

}  // namespace

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

RadiusSearch::RadiusSearch(const FitSettings& settings)
    : trials_(settings), tests_(trials_), final_(trials_)
{
  if (settings.paper) {
    rule_ = std::make_unique<PaperRadiusRule>(trials_);
  } else {
    rule_ = std::make_unique<PenaltyRadiusRule>(trials_, tests_);
  }
}

bool
RadiusSearch::isNarrowest() const
{
  const BallSamples& samples = trials_.samples();
  return kGolden * samples.rhoRight() * samples.gatherRadius() < trials_.settings().least_ball;
}

RadiusChoice
RadiusSearch::notNarrower(const RadiusChoice& choice)
{
  if (!(trials_.settings().least_ball > 0)) return choice;
  const bool internal = choice.kind == RadiusChoice::Kind::kInternal;
  if (internal ? !isNarrowest() : choice.kind != RadiusChoice::Kind::kLeaf) return choice;
  const BallSamples& samples = trials_.samples();
  const double least =
      std::min(trials_.settings().least_ball / samples.gatherRadius(), samples.rhoRight());
  if (!internal && choice.trial.rho >= least) return choice;
  const Trial trial = trials_.at(least);
  if (trial.supported) return RadiusChoice::leaf(trial);
  return internal ? RadiusChoice::leaf(trials_.right()) : choice;
}

RadiusChoice
RadiusSearch::search()
{
  return notNarrower(rule_->choose());
}

RadiusChoice
RadiusSearch::fallBack()
{
  return notNarrower(fallBackWhereSparse(trials_, tests_));
}

}  // namespace pcl_slim::detail

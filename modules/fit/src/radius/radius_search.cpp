// SPDX-License-Identifier: BSD-3-Clause
#include "radius/radius_search.h"

#include <algorithm>

#include "radius/rule/paper_radius_rule.h"
#include "radius/rule/penalty_radius_rule.h"
#include "radius/sparse_fallback.h"

namespace pcl_slim::detail {

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

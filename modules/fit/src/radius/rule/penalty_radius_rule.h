// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "One fit, step by step", 5 (Radius): the default rule, and the one where T is
// given.
#pragma once

#include "radius/fit_comparison.h"
#include "radius/rule/radius_rule.h"

namespace pcl_slim::detail {

/** \brief The default rule: the widest ball and the lowest degree that cost their points nothing.
 *
 * The choice goes by the penalised E(r); lack of fit and detail below the noise send a ball on to
 * smaller radii, and the edge of a feature to a lower degree. */
class PenaltyRadiusRule : public RadiusRule {
 public:
  PenaltyRadiusRule(TrialFits& trials, ResidualTests& tests)
      : trials_(trials), tests_(tests), comparison_(trials, tests)
  {
  }

  RadiusChoice choose() override;

  /** \brief E at all radii, or lack of fit, speaks for smaller ones by more than chance can. */
  bool surelyInternal() override;

 private:
  RadiusChoice chooseByEnergy();
  RadiusChoice chooseInside(const Trial& left, const Trial& middle, const Trial& right);
  Trial largestLenient(const Trial& best, const Trial& right);
  bool isLenient(const Trial& wide, const Trial& least) const;

  TrialFits& trials_;
  ResidualTests& tests_;
  FitComparison comparison_;
};

}  // namespace pcl_slim::detail

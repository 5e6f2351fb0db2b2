// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "One fit, step by step", 4 (the fit that is kept), and "Guards", Thin data and
// Outliers.
#pragma once

#include <vector>

#include "radius/rule/radius_rule.h"

namespace pcl_slim::detail {

/** \brief Makes the fit of a leaf that is kept. One per thread: it keeps its scratch memory. */
class FinalFit {
 public:
  explicit FinalFit(TrialFits& trials) : trials_(trials) {}

  /** \brief The fit at the radius that the rule keeps, with iterative refinement and, where asked,
   * robust weights. */
  Trial make(const RadiusChoice& choice, RadiusRule& rule);

 private:
  void fitRobustly(WeightKernel kernel, Trial& trial);
  void setRobustWeights(const LocalFit& fit);

  TrialFits& trials_;
  BallBuffer robust_;
  std::vector<float> residuals_;
};

/** \brief A trial's radius, or less where the ball would spread the leaf over empty space: it
 * shrinks to its points as far as support allows. O(points). */
double
radiusOfData(TrialFits& trials, const Trial& trial, WeightKernel kernel);

}  // namespace pcl_slim::detail

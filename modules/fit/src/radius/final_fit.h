// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "One fit, step by step", 4 (the fit that is kept), and "Guards", Outliers.
#pragma once

#include <vector>

#include "radius/rule/radius_rule.h"

namespace pcl_slim::detail {

/** \brief Makes the fit of a leaf that is kept. One per thread: it keeps its scratch memory. */
class FinalFit {
 public:
  explicit FinalFit(TrialFits& trials) : trials_(trials) {}

  /** \brief The chosen fit once more, with iterative refinement and, where asked, robust weights. */
  Trial make(const RadiusChoice& choice);

 private:
  void fitRobustly(WeightKernel kernel, Trial& trial);
  void setRobustWeights(const LocalFit& fit);

  TrialFits& trials_;
  BallBuffer robust_;
  std::vector<float> residuals_;
};

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Not reproduced": the rule of the paper's section 2, "Optimal surfel radius".
#pragma once

#include "radius/rule/radius_rule.h"

namespace pcl_slim::detail {

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

}  // namespace pcl_slim::detail

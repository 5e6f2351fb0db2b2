// SPDX-License-Identifier: BSD-3-Clause
#include "radius/rule/radius_rule.h"

namespace pcl_slim::detail {

RadiusChoice
chooseAtMinimumSupport(TrialFits& trials, const Trial& right, const Trial& middle)
{
  const double lenience = trials.constants().support_lenience;
  const Trial last = trials.atMinimumSupport(middle.rho);
  const auto serves = [&](const Trial& wider) {
    return !last.supported || wider.energy <= lenience * last.energy;
  };
  if (right.energy <= trials.settings().lenience * middle.energy && serves(right)) {
    return RadiusChoice::leaf(right);
  }
  return serves(middle) ? RadiusChoice::leaf(middle) : RadiusChoice::supportLimited(last);
}

}  // namespace pcl_slim::detail

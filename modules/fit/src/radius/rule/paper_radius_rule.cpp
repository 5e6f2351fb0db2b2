// SPDX-License-Identifier: BSD-3-Clause
#include "radius/rule/paper_radius_rule.h"

#include "radius/rule/bracket.h"

namespace pcl_slim::detail {

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

}  // namespace pcl_slim::detail

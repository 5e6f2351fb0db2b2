// SPDX-License-Identifier: BSD-3-Clause
#include "radius/rule/radius_rule.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {
namespace {

/** Abscissa of the minimum of the parabola through three points of (log rho, log E). */
double
parabolaMinimum(const Trial& a, const Trial& b, const Trial& c)
{
  const double xa = std::log(a.rho), xb = std::log(b.rho), xc = std::log(c.rho);
  const double fa = std::log(a.energy), fb = std::log(b.energy), fc = std::log(c.energy);
  const double p = (xb - xa) * (fb - fc), q = (xb - xc) * (fb - fa);
  const double denominator = p - q;
  const double x = std::abs(denominator) > 1e-300
                       ? xb - 0.5 * ((xb - xa) * p - (xb - xc) * q) / denominator
                       : xb;
  return std::exp(std::min(std::max(x, xa), xc));
}

}  // namespace

void
Bracket::narrow(TrialFits& trials)
{
  const Trial trial = trials.at(parabolaMinimum(a, b, c));
  if (!trial.supported || trial.rho == b.rho) return;
  if (trial.energy < b.energy) {
    (trial.rho < b.rho ? c : a) = b;
    b = trial;
  } else {
    (trial.rho < b.rho ? a : c) = trial;
  }
}

double
Bracket::width() const
{
  return std::log(c.rho / a.rho);
}

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

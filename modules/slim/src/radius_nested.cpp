// SPDX-License-Identifier: BSD-3-Clause
// Whether a wide ball costs its inner points anything: two fits compared on the same points.
#include <algorithm>
#include <cmath>

#include "radius_search.h"

namespace pcl_slim {

namespace {

constexpr double kMostRise =
    1.3;  ///< of E: beyond it the wide ball's rim is off too far for a leaf

}  // namespace

/** E compares two radii over two sets of points: a narrower ball's is often lower by luck, or because
 * the wide one's rim, which hardly counts once leaves are blended, bends more than a polynomial. On
 * the narrow ball's points alone noise cancels: its own fit has the least e^2 there, the wide one's is
 * higher by their mean square difference D^2. Were both unbiased, D^2 would be about the variance
 * that width saves, lambda P (1/n_narrow - 1/n_wide); where it is no more, width wins. O(points). */
bool
RadiusSearch::servesAsWell(const Trial& wide, const Trial& narrow)
{
  if (!settings_.compare_nested || !(wide.energy < kMostRise * narrow.energy)) return false;
  const BallBuffer& points = pointsWithin(narrow.rho);
  LocalFit difference = wide.fit;
  for (std::size_t k = 0; k < difference.c.size(); ++k) difference.c[k] -= narrow.fit.c[k];
  residuals_.resize(points.count + BallBuffer::kPadding);
  kernels::ballResiduals(points, difference, residuals_.data());
  const double inverse_sq = 1.0 / (narrow.rho * narrow.rho);
  double weight = 0, squares = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    const double g = evaluateKernel(settings_.fit_kernel, points.s_sq[i] * inverse_sq);
    const double apart = points.w[i] - residuals_[i];
    weight += g;
    squares += g * apart * apart;
  }
  const double cost = squares / weight * gather_radius_ * gather_radius_;
  const double saved = narrow.fit.terms / narrow.fit.n_eff - wide.fit.terms / wide.fit.n_eff;
  return cost < energy_.lambda * saved;
}

/** Between r_m and r_r, where both E and the search would go to smaller balls. */
Trial
RadiusSearch::betweenServing(const Trial& middle, const Trial& right)
{
  const Trial between = evaluate(std::sqrt(right.rho * middle.rho));
  return between.supported && servesAsWell(between, middle) ? between : Trial{};
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// How wide, and of how low a degree, a leaf may be that holds noise only: fits compared on the same
// points.
#include <algorithm>
#include <cmath>

#include "ball/noise_bias.h"
#include "least_squares/mean_slope.h"
#include "least_squares/nested_fit.h"
#include "radius/radius_search.h"

namespace pcl_slim::detail {

namespace {

constexpr double kMostRise =
    1.3;                         ///< of E: beyond it the wide ball's rim is off too far for a leaf
constexpr double kWorth = 0.46;  ///< of a saved variance, times kappa
constexpr double kTrust = 2.0;   ///< so much more where E speaks for the wide ball as well
constexpr int kRadii = 4;        ///< tried from r_r to r_m, r_r among them
constexpr int kLeastDegree = 2;
constexpr double kDegreeSupport = 9.0;  ///< n_eff per term from which a degree can be told too high

}  // namespace

/** The coefficients without what noise adds to them on average, which depends on the radius. */
std::array<double, kMaxCoefficients>
RadiusSearch::unbiased(const Trial& trial) const
{
  auto c = trial.fit.c;
  const double r = trial.rho * gather_radius_;
  undoNoiseBias(settings_.constants.ball.bias, trial.fit.degree, noise() / (r * r), trial.rho,
                c.data());
  return c;
}

/** D^2, the mean square difference of two fits over the points of the closer one, with its weights:
 * their moments hold it. */
double
RadiusSearch::apartSq(const Trial& plain, const Trial& close) const
{
  auto difference = unbiased(plain);
  const auto own = unbiased(close);
  for (std::size_t k = 0; k < own.size(); ++k) difference[k] -= own[k];
  const LocalFit& fit = close.fit;
  return kernels::meanSquare(fit.moment_degree, fit.moments.data(), difference.data()) *
         gather_radius_ * gather_radius_;
}

/** Whether a plainer fit, of a wider ball or a lower degree, costs the points of a closer one less than
 * it saves them. E compares radii over different points: a narrow ball's is often lower by luck, or
 * because the wide one's rim bends more than a polynomial, which hardly counts: where leaves are
 * blended by the weights they were fitted with, such errors of neighbours cancel to first order. On the
 * same points noise cancels: if both fits are unbiased, D^2 is about the variance that the plainer one
 * saves, lambda (P_close / n_close - P_plain / n_plain). \param[in] trust times as much may be lost. */
bool
RadiusSearch::servesAsWell(const Trial& plain, const Trial& close, double trust) const
{
  if (!(plain.energy < kMostRise * close.energy)) return false;
  const double saved = close.fit.terms / close.fit.n_eff - plain.fit.terms / plain.fit.n_eff;
  // The rest of kappa insures against luck, of which there is little here.
  return apartSq(plain, close) < trust * kWorth * energy_.kappa * noise() * saved;
}

/** The widest ball from r_r down to r_m, r_m left out, that serves r_m's points as well and hides no
 * structure: r_r, or else upwards from r_m. \return an unsupported trial where there is none. */
Trial
RadiusSearch::widestServing(const Trial& middle, const Trial& right)
{
  const bool flat = right.energy <= settings_.lenience * middle.energy;
  if (servesAsWell(right, middle, flat ? kTrust : 1.0) && !hidesStructure(right)) return right;
  const double step = std::pow(right.rho / middle.rho, 1.0 / kRadii);
  Trial widest;
  double rho = middle.rho;
  for (int i = 1; i < kRadii; ++i) {
    rho *= step;
    const Trial trial = evaluate(rho);
    if (!trial.supported || !servesAsWell(trial, middle) || hidesStructure(trial)) break;
    widest = trial;
  }
  return widest;
}

/** The fit of a lower degree to a trial's points. */
Trial
RadiusSearch::lowered(const Trial& trial, int degree)
{
  if (ball_->slope_weight > 0) return evaluate(trial.rho, degree, settings_.fit_kernel);
  Trial low;
  low.rho = trial.rho;
  low.fit = nestedFit(trial.fit, degree);
  low.supported = low.fit.degree == degree;
  if (low.supported) low.energy = energy_(low.fit, low.rho * gather_radius_, gather_radius_);
  return low;
}

/** The lowest degree that serves a leaf's points as well: under noise the high terms of a ball that
 * cannot be wide hold little else. */
Trial
RadiusSearch::leastDegree(const Trial& trial)
{
  const bool enough = trial.fit.n_eff > kDegreeSupport * trial.fit.terms;
  if (!settings_.compare_nested || !enough || !isNoise(trial)) return trial;
  for (int degree = kLeastDegree; degree < trial.fit.degree; ++degree) {
    const Trial low = lowered(trial, degree);
    if (low.supported && servesAsWell(low, trial)) return low;
  }
  return trial;
}

}  // namespace pcl_slim::detail

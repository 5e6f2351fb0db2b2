// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "One fit, step by step", 5 (Radius), and the rows "penalty", "residual" and
// "slope" of "Where the default departs from the paper".
#pragma once

#include <algorithm>
#include <limits>

#include "fit_constants.h"
#include "least_squares/local_fit.h"
#include "least_squares/noise_bias.h"

namespace pcl_slim::detail {

/** \brief What a radius costs: residual plus a penalty on small balls. All in local units. */
struct Energy {
  double lambda = 0;       ///< noise variance
  double correlation = 1;  ///< tau: this many points share one error and count as one
  double kappa = 0;        ///< Mallows' Cp: kappa lambda P / n_eff, where t_mdl is 0
  double t_mdl = 0;        ///< T_MDL L: the paper's penalty lambda (T L / r)^2
  double thick = 5.0;      ///< balls below this many sqrt(lambda) are noise-filled
  bool corrected = true;   ///< residual variance over n - P degrees of freedom (not in the paper)

  /** \brief E(r) of a fit with radius r; gather_radius is the unit the fit was made in. */
  double operator()(const LocalFit& fit, double r, double gather_radius,
                    const RadiusConstants& constants) const
  {
    double e_sq = variance(fit, gather_radius);
    if (corrected) {
      // Weights fall with height, too: a thin ball measures e^2 = s^2 / (1 + a s^2 / r^2) of a noise
      // variance s^2, and a noise-filled ball little but its own size.
      const double truncation = heightTruncation(fit.kernel);
      e_sq /= std::max(constants.least_seen_share, 1.0 - truncation * e_sq / (r * r));
      if (filledByNoise(r)) e_sq = std::max(e_sq, lambda);
      const double freedom = degreesOfFreedom(fit);
      if (!(freedom > 0)) return std::numeric_limits<double>::infinity();
      e_sq *= fit.n_eff / freedom;
    }
    return e_sq + fit.slope_misfit * gather_radius * gather_radius + penalty(fit, r);
  }

  /** \brief e^2 across the surface: over a slope s noise scatters heights by 1 + s^2 times
   * its variance. What a fit misses of the shape keeps its height. */
  double variance(const LocalFit& fit, double gather_radius) const
  {
    const double e_sq = fit.residual_sq * gather_radius * gather_radius;
    // With T given balls may shrink until they follow the noise, whose slopes must not excuse them.
    if (!corrected || t_mdl > 0) return e_sq;
    return std::max(e_sq / (1.0 + fit.slope_sq), e_sq - lambda * fit.slope_sq);
  }

  /** \brief The part of E(r) that small balls pay. */
  double penalty(const LocalFit& fit, double r) const
  {
    if (t_mdl > 0) return lambda * (t_mdl / r) * (t_mdl / r);  // eq. (3)
    return kappa * lambda * correlation * numCoefficients(fit.degree) / fit.n_eff;
  }

  /** \brief Degrees of freedom of a fit's residuals: each coefficient takes as many points as share one
   * error. */
  double degreesOfFreedom(const LocalFit& fit) const
  {
    const double freedom = fit.n_eff - correlation * numCoefficients(fit.degree);
    return correlation > 1 ? std::max(freedom, 0.25 * fit.n_eff) : freedom;
  }

  /** \brief Whether a ball of radius r is noise-filled: its e^2 depends more on its size than on the
   * noise. */
  bool filledByNoise(double r) const { return r * r < thick * thick * lambda; }
};

}  // namespace pcl_slim::detail

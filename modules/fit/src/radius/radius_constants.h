// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pcl_slim::detail {

/** \brief The tuning constants of the search for a ball's radius.
 *
 * Each group names the paragraph of docs/theory.md that explains it. "Ratio" means a number
 * without a unit; lambda is the noise variance, P the number of coefficients, n_eff the effective
 * number of points, e the RMS residual and r the radius.
 */
struct RadiusConstants {
  // "Noise that is not noise, and noise that fills the ball": e^2 seen through falling weights.
  double least_seen_share = 0.2;  ///< ratio; e^2 shows at least this share of the variance

  // "One fit, step by step", 3 (Levels): a ball that is divided after a look at part of its points.
  double sure_margin = 1.3;  ///< ratio of E, or of e^2, that a part of the points cannot miss

  // "One fit, step by step", 5 (Radius): a minimum of E inside the interval.
  int lenient_steps = 2;  ///< number of bisections of log r for the largest radius allowed

  // "Not reproduced": where the paper's rule ends its bracket.
  int brent_steps = 6;        ///< number of parabolic steps at most
  double brent_width = 0.05;  ///< ratio; width of the bracket in log r, far within which E is flat

  // "Guards", Minimum support.
  int support_steps = 8;          ///< number of steps towards the minimum-support radius at most
  double support_margin = 1.02;   ///< ratio; n_eff up to so many times the least support will do
  double support_aim = 1.01;      ///< ratio of n_eff to the least support that a step aims at
  double support_lenience = 1.3;  ///< ratio of E; a wider ball is taken up to so many times E there

  // "Guards", Thin data.
  double scattered_ratio = 0.02;  ///< e / r beyond which few points make no surface

  // "Two fits on the same points".
  double noise_like = 1.5;         ///< e^2 in units of lambda up to which a ball holds noise only
  double comparison_rise = 1.3;    ///< ratio of E beyond which the wide ball's rim is off too far
  double comparison_worth = 0.46;  ///< ratio of D^2 to the variance saved, times kappa
  double comparison_trust = 2.0;   ///< ratio; so much more where E speaks for the wide ball as well
  int comparison_radii = 4;        ///< number of radii from r_r down to r_m, r_r among them
  int least_degree = 2;            ///< lowest degree that is compared
  double degree_support = 9.0;     ///< n_eff / P from which a degree can be told to be too high

  // "Detail below the noise".
  double detail_support = 8.0;     ///< ratio of n_eff to the least support, for finer balls
  double detail_deviations = 3.0;  ///< ratio of shared variance to its deviation, at least
  double detail_worth = 0.5;       ///< ratio of the shared variance to the penalty on E, at least
  double detail_cell = 3.0;        ///< least width of a cell in units of sqrt(lambda)
  double points_per_cell = 8.0;    ///< number of points; more would hide fine detail
  int least_cells = 2;             ///< number of cells along a side
  int most_cells = 32;             ///< number of cells along a side
  double absorbed_share = 0.4;  ///< of P / n_eff; what a fit follows of the noise in its inner part

  // "Degree at features".
  int feature_degree = 2;        ///< the degree that is tried there
  int feature_steps = 4;         ///< number of radii tried for it
  double feature_step = 0.75;    ///< ratio of each of these radii to the last
  double feature_support = 1.5;  ///< n_eff / P asked of it
  double feature_noise = 1.15;   ///< e^2 in units of lambda that is more than noise
  double feature_height = 0.01;  ///< e / r that no smooth surface leaves
  double feature_gain = 0.9;     ///< ratio of expected errors that the lower degree must reach

  // "Guards", The fit that is kept, and outliers.
  int robust_passes = 2;      ///< number of fits with robust weights
  double robust_scale = 2.5;  ///< scale of the weights in deviations of the noise
};

}  // namespace pcl_slim::detail

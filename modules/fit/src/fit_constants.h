// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/cloud/detail/sides.h"

namespace pcl_slim::detail {

constexpr double kGolden = 0.6180339887498949;  ///< gamma of eq. (5): the golden section, no choice

/** \brief The values of the named presets, presets.h (docs/theory.md, "Where the default departs
 * from the paper", "T given" and "Sharp features"). */
struct PresetConstants {
  int degree = 4;                    ///< polynomial degree
  int sharp_degree = 2;              ///< the same with sharp features
  double kappa = 3.0;                ///< penalty: kappa lambda P / n_eff
  double sharp_kappa = 1.0;          ///< the same with sharp features
  double paper_t = 0.01;             ///< the paper's T_MDL [share of L]
  double support = 1.15;             ///< n_eff per coefficient below which nothing is fitted
  double lenience = 1.02;            ///< the largest r with E <= lenience min E is taken
  double lenience_with_t = 1.0;      ///< the same where T is given
  double lack_of_fit = 2.5;          ///< no leaf while e exceeds this many sqrt(lambda)
  double lack_of_fit_with_t = 10.0;  ///< the same where T is given
  double thick = 5.0;                ///< balls below this many sqrt(lambda) are noise-filled
  double thick_with_t = 4.0;         ///< the same where T is given
  float sharp_bound = 0.5f;          ///< the normal bound with sharp features [cosine]
};

/** \brief The tuning constants of the search for a ball's radius.
 *
 * Each group names the paragraph of docs/theory.md that explains it. "Ratio" means a number
 * without a unit; lambda is the noise variance, P the number of coefficients, n_eff the effective
 * number of points, e the RMS residual and r the radius.
 */
struct RadiusConstants {
  // "Balls of a few sigma": e^2 under falling weights.
  double least_seen_share = 0.2;  ///< ratio; e^2 shows at least this share of the variance

  // "One fit, step by step", 3 (Levels): a ball that is divided after a look at part of its points.
  double sure_margin = 1.3;  ///< ratio of E, or of e^2, that a part of the points cannot miss

  // "One fit, step by step", 5 (Radius): a minimum of E inside the interval.
  int lenient_steps = 2;  ///< number of bisections of log r for the largest radius allowed

  // "Not reproduced": where the paper's rule ends its bracket.
  int brent_steps = 6;        ///< number of parabolic steps at most
  double brent_width = 0.05;  ///< ratio; width of the bracket in log r, far within which E is flat

  // "Guards", Minimum support.
  int support_steps = 8;         ///< number of steps towards the minimum-support radius at most
  double support_margin = 1.02;  ///< ratio; n_eff up to this many times the least support will do
  double support_aim = 1.01;     ///< ratio of n_eff to the least support that a step aims at
  double support_lenience =
      1.3;  ///< ratio of E; a wider ball is taken up to this many times E there

  // "Guards", Thin data.
  double scattered_ratio = 0.02;  ///< e / r beyond which few points make no surface

  // "Two fits on the same points".
  double noise_like = 1.5;         ///< e^2 [lambda] up to which a ball contains only noise
  double comparison_rise = 1.3;    ///< ratio of E beyond which the wide ball's rim is off too far
  double comparison_worth = 0.46;  ///< ratio of D^2 to the variance saved, times kappa
  double comparison_trust = 2.0;   ///< factor on that if E favours the wide ball as well
  int comparison_radii = 4;        ///< number of radii from r_r down to r_m, r_r among them
  int least_degree = 2;            ///< lowest degree that is compared
  double degree_support = 9.0;     ///< n_eff / P from which a degree can be found to be too high

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
  double feature_support = 1.5;  ///< n_eff / P that it needs
  double feature_noise = 1.15;   ///< e^2 in units of lambda that is more than noise
  double feature_height = 0.01;  ///< e / r that no smooth surface leaves
  double feature_gain = 0.9;     ///< ratio of expected errors that the lower degree must reach

  // "Guards", The fit that is kept, and outliers.
  int robust_passes = 2;      ///< number of fits with robust weights
  double robust_scale = 2.5;  ///< scale of the weights in deviations of the noise
};

/** \brief Whether normals are measured apart from the points (docs/theory.md, "Normals as data").
 */
struct NormalErrorConstants {
  std::size_t samples = 1000;       ///< patches looked at
  std::size_t least_patches = 100;  ///< patches that a result takes
  std::size_t neighbors = 64;     ///< points of a patch: wider than most estimates of normals reach
  std::size_t least_points = 48;  ///< points of a patch on the sample's own side
  std::size_t tilt_points = 9;    ///< the sample and its nearest, for the tilt of heights
  std::size_t pairs = 4;          ///< nearest neighbours that the sample is paired with
  float own_side = 0.3f;          ///< least cosine with the sample's normal
  double least_cosine = 0.1;      ///< least cosine that a slope is read from
  double trim = 0.1;              ///< share of patches left out at either end of the mean
  double with_heights = 0.15;     ///< correlation with the points' tilt from which it repeats them
  double with_neighbors = 0.03;   ///< correlation with neighbours from which they repeat them
};

/** \brief Two sheets in one ball (docs/theory.md, "Sheets"). */
struct SheetConstants {
  int passes = 2;             ///< times a ball's sheets are separated
  double noise = 4.0;         ///< least e^2 of two separable sheets [lambda]
  int bins = 48;              ///< of the histogram of residuals, 128 at most
  double valley = 0.12;       ///< height of the valley over the lower peak's
  std::size_t points = 24;    ///< points that a histogram takes
  std::size_t counted = 512;  ///< points counted; larger balls are counted in strides
  double apart = 3.0;         ///< distance of the sides' means over the sides' own deviation
  double least_side = 0.05;   ///< share of the points on the smaller side
};

/** \brief What noise does to heights on average (docs/theory.md, paragraph of that name). */
struct BiasConstants {
  double most_share = 1.0 / 25;  ///< largest lambda / r^2 taken back: r = 5 sqrt(lambda)
};

/** \brief One ball (docs/theory.md, "One ball"). */
struct BallConstants {
  double lone_share =
      0.3;  ///< share of points within the normal bound, below which a normal is alone
  double lone_cosine = 0.3;  ///< mean cosine with them, below which it is ("Lone normals")
  std::size_t glance_blocks =
      512;                        ///< blocks of 16 points that give e^2 to some percent ("Levels")
  std::size_t glance_stride = 2;  ///< least stride of blocks at which the coarse check pays
  std::size_t line_points = 64;   ///< this many points without a plane are divided ("Levels")
  double off_center = 0.03;       ///< a fit that passes its centre farther off [r_r] moves the ball
  double largest_shift =
      0.3;  ///< the largest shift of a ball [r_r]; the cover's cells allow for it
  SheetConstants sheets;
  BiasConstants bias;
};

/** \brief The levels and the cover (docs/theory.md, "Levels" and "Cover"). */
struct CoverConstants {
  double paper_first_radius = 0.1;                  ///< r_r of level 1 [L]: the paper's L / 10
  double first_radius = 0.1 / (kGolden * kGolden);  ///< the default's: two levels wider
  double start_share = 0.5;         ///< most points in the first level's median ball
  double sharp_start_share = 0.15;  ///< the same with sharp features
  std::size_t start_samples = 31;   ///< balls whose median that is
  std::size_t start_slack = 4;      ///< blocks a ball may touch beyond that share
  int last_start = 30;              ///< the finest first level
  int last_level = 40;              ///< the finest level: r_r is 1e-9 L, support ends long before
  double least_radius = 1.0;        ///< [steps of the centres' grid]: no ball misses its own point
  double alpha = 2.0 / 3.0;         ///< a leaf covers within alpha r: the paper's
  double supported_alpha = 0.55;    ///< alpha of well supported leaves ...
  double well_supported = 16.0;     ///< ... which are those of more n_eff per coefficient
  double residual_bound = 5.0;      ///< a leaf covers points within this many e of it
  double residual_floor = 1e-6;     ///< [r] added to that, for the rounding of exact fits
};

/** \brief Common sides without normals (docs/theory.md, "Sides"). */
struct OrientConstants {
  std::size_t neighbors = 8;  ///< nearest leaves on each level that a leaf has edges to, 32 at most
  double reach = 0.9;         ///< of r + r': leaves whose centres are farther apart do not overlap
  float weak_edge = 0.5f;     ///< edges of more weight may lead across a gap
  double closed_flux = 0.4;   ///< flux above this share of its bound makes a closed body
  double flat_flux = 0.1;     ///< flux below this share of its bound leaves no inside
  double sheet = 3.0;  ///< [a leaf's RMS residual] points farther from it are of another sheet
  std::size_t blocks = 128;  ///< of points that vote on a leaf's side, at most
};

/** \brief Borders and holes (docs/theory.md, "Borders"). Lengths are in spacings of a surfel's points
 * unless brackets give another unit. */
struct TrimConstants {
  double known = 1.15;         ///< [r] points are gathered within
  double gate = 0.25;          ///< [r] points farther from the surfel are no points of it, ...
  double growth = 0.3;         ///< a sample owns this much beyond itself, plus half a cell
  double cell = 0.5;           ///< width of a raster's cells
  double clear = 0.3;          ///< depth inside data from which on a place is clear of any border
  double looked_at = 0.9;      ///< [r] gaps beyond do not open a surfel: its weight is next to 0
  int internal_side = 9;       ///< nodes a side of internal surfels' maps, which are drawn small
  std::size_t sampled = 1024;  ///< points of an internal ball from which on samples of them do
};

/** \brief Where the data end (docs/theory.md, "Borders"). */
struct BorderConstants {
  std::size_t near_points = 24;  ///< nearest ones, which give plane and sectors
  double noise = 5.0;            ///< [RMS noise] all nearer ones are among these
  double blind = 0.3;            ///< [their reach] nearer ones point anywhere
  double sector = 1.75;          ///< [radians] empty next to a border
  double turn = 0.4;             ///< [radians] discs are also tried this much to either side
  double edge = 0.8;       ///< least cosine between the planes of a point and of its surfel ...
  double exact = 0.06;     ///< ... where noise [its reach, over that of neighbours] is small enough
  double far = 10.0;       ///< [spacing] a gap as wide needs no other side, and no rim
  double disc = 1.2;       ///< [smallest hole] chance leaves narrower discs empty
  double near = 3.0;       ///< [spacing] points are counted on the other side of a gap
  double rim_share = 0.8;  ///< of the neighbours expected there
  int places = 12;         ///< in a surfel's gaps whose rims are looked at
};

/** \brief The search for a target error or a number of surfels (docs/theory.md, "The penalty, target
 * error and number of surfels"). */
struct PenaltySearchConstants {
  int most_covers = 12;           ///< covers that are tried
  double error_tolerance = 0.03;  ///< of the target error
  double count_tolerance = 0.05;  ///< of the number of surfels, below it
  double least_step = 0.1;        ///< a secant step keeps this share of the bracket from its ends
  double largest_error = 0.05;    ///< sqrt(lambda) [L] beyond which no surface is left
  double least_variance = 1e-24;  ///< lambda [local length squared] that log-log starts from
};

/** \brief Every tuning constant of the fit; nothing else decides. Paragraphs are those of
 * docs/theory.md. Lengths are in the units that square brackets name; what has no unit is a ratio
 * or a count. */
struct FitConstants {
  PresetConstants preset;
  NoiseConstants noise;
  SideConstants sides;
  NormalBoundConstants normal_bound;
  NormalErrorConstants normal_error;
  BallConstants ball;
  RadiusConstants radius;
  CoverConstants cover;
  OrientConstants orient;
  TrimConstants trim;
  BorderConstants border;
  PenaltySearchConstants penalty_search;
};

/** \brief What sums in float can resolve (docs/theory.md, "One ball"). No tuning: they follow from
 * the format of the numbers, and the kernels know them at compile time. */
struct FloatLimits {
  static constexpr double kPivot = 3e-6;         ///< relative pivots of the normal equations
  static constexpr double kResidual = 1e-3;      ///< share of sum w z^2 that differences keep
  static constexpr float kSlopeCosine = 0.01f;   ///< least cosine with w that a slope is read from
  static constexpr double kNormalLength = 1e-6;  ///< least length of a mean of unit normals
};

}  // namespace pcl_slim::detail

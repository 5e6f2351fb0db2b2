// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/cloud/detail/sides.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/leaf/detail/gates.h"

namespace pcl_slim::detail {

constexpr double kGolden = 0.6180339887498949;  ///< gamma of eq. (5): the golden section, no choice

/** \brief The values of the presets (docs/theory.md, "Where the default departs
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
  float sharp_bound = kSharpCosine;  ///< the normal bound with sharp features [cosine]
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
  double residual_bound = kErrorGate;  ///< a leaf covers points within this many e of it
  double residual_floor = 1e-6;        ///< [r] added to that, for the rounding of exact fits
};

/** \brief The search for sides before the cover (docs/sides.md, paragraph of that name): what can
 * be switched off. The other constants are next to their steps in measures/sides.cpp. */
struct SideSearchConstants {
  std::size_t least_plane_neighbors = 16;  ///< of a plane that points of doubtful sides move to
  double least_moved_noise = 0.7;          ///< least noise of the moved points [noise before]
  double follow_distance = 0.1;  ///< distance of leaves from the points [median gap of two sheets]
  double last_doubt = 0.3;  ///< largest doubt in a noisy cloud where no width of cells gives sides
};

/** \brief Common sides without normals (docs/sides.md, "Which side is out"). */
struct OrientConstants {
  std::size_t neighbors = 8;  ///< nearest leaves on each level that a leaf has edges to, 32 at most
  double reach = 0.9;         ///< of r + r': leaves whose centres are farther apart do not overlap
  double sheet = 3.0;  ///< [a leaf's RMS residual] points farther from it are of another sheet
  std::size_t blocks = 128;  ///< of points that vote on a leaf's side, at most
};

/** \brief The search for a target error or a number of surfels (docs/theory.md, "The penalty,
 * target error and number of surfels"). */
struct PenaltySearchConstants {
  int most_covers = 12;           ///< covers that are tried
  double error_tolerance = 0.03;  ///< of the target error
  double count_tolerance = 0.05;  ///< of the number of surfels, below it
  double least_step = 0.1;        ///< a secant step keeps this share of the bracket from its ends
  double largest_error = 0.05;    ///< sqrt(lambda) [L] beyond which no surface is left
  double least_variance = 1e-24;  ///< lambda [local length squared] that log-log starts from
};

/** \brief The tuning constants that fitWithConstants() may override. Those of one step alone, such
 * as RadiusConstants, TrimConstants and BorderConstants, stand at that step. Paragraphs are those
 * of docs/theory.md. Lengths are in the units that square brackets name; what has no unit is a
 * ratio or a count. */
struct FitConstants {
  PresetConstants preset;
  NoiseConstants noise;
  SideConstants sides;
  SideSearchConstants side_search;
  NormalBoundConstants normal_bound;
  BallConstants ball;
  CoverConstants cover;
  OrientConstants orient;
  PenaltySearchConstants penalty_search;
};

/** \brief fitSurface() with other tuning constants than the library's: for measuring what each is
 * worth. \param[out] kept the store itself, if it is to keep the sides and places found */
Error fitWithConstants(const FitConstants& constants, const PointStore& store,
                       const FitParams& params, SLIMSurface& surface,
                       FitStatistics* statistics = nullptr, Progress* progress = nullptr,
                       PointStore* kept = nullptr);

}  // namespace pcl_slim::detail

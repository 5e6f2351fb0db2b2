// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace pcl_slim::detail {

/** \brief How a patch is parted where two sheets run through it (docs/theory.md, "Sheets"). */
struct PatchSheetConstants {
  int passes = 4;    ///< rounds of two-means on the heights
  double gap = 1.0;  ///< a gap this many times the larger spread of the two sides parts sheets
  std::size_t factor = 2;  ///< so many times the neighbours are asked for where a sheet was dropped
};

/** \brief How noise that neighbours share is told from detail (docs/theory.md, "Noise that
 * neighbours share"). Growth is the binary logarithm of the factor by which the residual variance
 * grows from k neighbours to 2 k, the median over the places. */
struct SharedNoiseConstants {
  std::size_t places = 300;    ///< places where residual variances are compared
  std::size_t most_part = 16;  ///< a patch holds at most 1 / so much of the cloud's points
  double white = 0.25;         ///< least growth at the first k that can be shared noise
  double plateau = 0.15;       ///< growth at which noise shows all of itself
  double rise = 0.3;           ///< growth this far above its least is a surface's detail
  double steep = 1.0;          ///< growth, after the first, that no noise shows
  double slow = 0.55;          ///< growth up to which a least one will do for a plateau ...
  double fall = 0.78;          ///< ... if it has fallen to this share of the greatest before

  double slack = 1.4;     ///< growth over the least that shows as much of the noise
  double creases = 0.25;  ///< by how much more the trimmed mean grows where creases spoil it

  std::size_t patches = 100;      ///< patches on which the number of sharing neighbours is measured
  std::size_t least_points = 80;  ///< points of such a patch ...
  std::size_t most_points = 2560;  ///< ... which are all looked at up to so many
  double cells = 32;               ///< of equal size, into which a patch's points fall
  double least = 1.5;              ///< fewer neighbours than that share nothing
  /// Of more points fits count the geometric mean with this, where no detail shows: a wide tau rounds
  /// edges, and a part of it costs smooth parts little.
  double counted = 12;
  double given_patch = 32;  ///< points of a patch over a given number that share
};

/** \brief How a coordinate that a sensor rounds is recognised (docs/theory.md, "Steps"). */
struct StepConstants {
  std::size_t scouts = 8192;            ///< points whose coordinates are looked at first
  double least_points = 50;             ///< points per level, on average
  std::size_t narrow = 20, wide = 160;  ///< points of the patches whose variances are compared
  double least_ratio = 0.25;            ///< variance over that of rounding, (step n)^2 / 12 ...
  double full_ratio = 0.9;              ///< ... all of which patches must show, ...
  double pure_ratio = 2.0;              ///< ... up to which there is little else, ...
  double most_ratio = 5.0;              ///< ... and beyond which rounding does not matter
  double growth = 1.4;     ///< from narrow to wide patches, where there is something else
  double correlation = 2;  ///< points that share a step's error, at least
};

/** \brief The measurement of a cloud's noise level (docs/theory.md, "Noise"). */
struct NoiseConstants {
  std::size_t first_neighbors = 20;  ///< points of the smallest patch
  double least_width = 0.5;          ///< of a patch, over its length, that is no line
  std::size_t most_part = 8;         ///< a patch holds at most 1 / so much of the cloud's points
  std::size_t patch_points = 320;    ///< points looked at in a patch; larger patches are sampled
  std::size_t samples = 500;         ///< patches of the smallest size
  std::size_t least_samples = 100;   ///< patches of a large size
  double trim = 0.1;                 ///< share of patches left out at either end of a trimmed mean
  double patch_noise = 0.2;    ///< sqrt(lambda) over the patch's radius above which noise fills it
  double filled_patch = 0.25;  ///< the same ratio, below which noise plainly does not fill a patch
  /// Surface relief keeps more than this share of that ratio in twice as many points; noise has .8.
  double relief = 0.9;
  /// A cubic's squared bias grows by this when the number of points doubles (radius to the eighth).
  double bias_growth = 16.0;
  double floor = 1e-11;  ///< least sqrt(lambda) [L of the bulk]: float positions resolve no less

  std::size_t paper_samples = 1000;  ///< neighbourhoods of the paper's estimate
  std::size_t paper_neighbors = 10;  ///< neighbours of each, the sample left out
  double paper_floor = 1e-6;         ///< least sqrt(lambda) of the paper's estimate [L]

  std::size_t points_per_run = 128;  ///< points that one entry of a noise profile stands for
  std::size_t most_runs = 8192;      ///< entries of a noise profile
  std::size_t window = 8;            ///< runs to either side that an entry rests on
  float least_ratio = 0.001f;        ///< least noise ratio of an entry; its inverse is the largest
  double uneven = 2;          ///< variance over the cloud's from which noise passes for detail
  double uneven_share = 0.1;  ///< share of places of so much noise that makes a profile worth it

  PatchSheetConstants sheets;
  SharedNoiseConstants shared;
  StepConstants steps;
};

/** \brief The normal bound (docs/theory.md, "Sheets"). */
struct NormalBoundConstants {
  std::size_t blocks = 1000;     ///< blocks looked at, evenly strided
  std::size_t least_points = 8;  ///< points that a block's mean normal takes
  double one_sheet = 0.5;        ///< a mean normal shorter than this mixes sheets
  double deviations = 3.0;       ///< deviations of the normals' errors that the bound falls by
  double widest = 0.6435;        ///< largest such fall [rad]: asin(0.6)
};

}  // namespace pcl_slim::detail

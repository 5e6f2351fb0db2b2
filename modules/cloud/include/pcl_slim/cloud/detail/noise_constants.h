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

/** \brief The measurement of a cloud's noise level (docs/theory.md, "Noise"). */
struct NoiseConstants {
  std::size_t first_neighbors = 20;    ///< points of the smallest patch
  std::size_t most_neighbors = 20480;  ///< points of the largest patch
  std::size_t most_part = 8;           ///< a patch holds at most 1 / so much of the cloud's points
  std::size_t patch_points = 320;      ///< points looked at in a patch; larger patches are sampled
  std::size_t samples = 500;           ///< patches of the smallest size
  std::size_t least_samples = 100;     ///< patches of a large size
  std::size_t scouts = 25;             ///< patches that tell whether noise fills them
  double trim = 0.1;           ///< share of patches left out at either end of a trimmed mean
  double patch_noise = 0.2;    ///< sqrt(lambda) over the patch's radius above which noise fills it
  double filled_patch = 0.25;  ///< the same ratio, below which noise plainly does not fill a patch
  /// Surface relief keeps more than this share of that ratio in twice as many points; noise has .8.
  double relief = 0.9;
  /// A cubic's squared bias grows by this when the number of points doubles (radius to the eighth).
  double bias_growth = 16.0;
  double least_share = 1e-4;  ///< share of the residual variance that always counts as noise
  double floor = 1e-11;       ///< least sqrt(lambda) [L]: float positions resolve no less

  std::size_t paper_samples = 1000;  ///< neighbourhoods of the paper's estimate
  std::size_t paper_neighbors = 10;  ///< neighbours of each, the sample left out
  double paper_floor = 1e-6;         ///< least sqrt(lambda) of the paper's estimate [L]

  std::size_t points_per_run = 128;  ///< points that one entry of a noise profile stands for
  std::size_t most_runs = 8192;      ///< entries of a noise profile
  std::size_t window = 8;            ///< runs to either side that an entry rests on
  float least_ratio = 0.001f;        ///< least noise ratio of an entry; its inverse is the largest

  PatchSheetConstants sheets;
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

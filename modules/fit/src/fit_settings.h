// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "fit_constants.h"
#include "pcl_slim/fit/fit.h"
#include "radius/energy.h"

namespace pcl_slim::detail {

/** \brief Everything the inner steps need to know, in local units; fixed during a fit. The presets
 * fill it (presets.h). */
struct FitSettings {
  FitConstants constants;

  int degree = constants.preset.degree;
  Energy energy;
  WeightKernel fit_kernel = WeightKernel::kPower4;    ///< weights while searching and in general
  WeightKernel wall_kernel = WeightKernel::kPower2;   ///< at minimum support, where bias rules
  WeightKernel cover_kernel = WeightKernel::kPower7;  ///< G of the coverage
  double support = constants.preset.support;          ///< n_eff per coefficient that a fit takes
  double lenience = constants.preset.lenience;  ///< the largest r with E <= lenience min E is taken
  double lack_of_fit =
      constants.preset.lack_of_fit;  ///< e goes on over so many sqrt(lambda); 0: no
  bool find_detail = true;           ///< look for detail below the noise, and for features
  bool compare_nested = true;        ///< let a wide ball stand that costs the inner points nothing
  double residual_bound = constants.cover.residual_bound;  ///< a leaf covers within so many e; 0: r
  double alpha = constants.cover.alpha;                    ///< a leaf covers within alpha r ...
  double supported_alpha =
      constants.cover.alpha;  ///< ... or this, where many points stand behind it
  double gamma = 0.1;         ///< a point is covered at this coverage
  double diagonal = 1.0;      ///< L
  double first_radius = constants.cover.paper_first_radius;  ///< r_r of level 1 over L
  double start_share = constants.cover.start_share;  ///< of the points in level 1's median ball
  double noise = 0;       ///< variance of points about the surface, in space; 0: not known
  double least_ball = 0;  ///< > 0: no leaf's ball is narrower, a local length
  double center_grid = 0x1p-22;
  std::vector<float> noise_profile;  ///< noise ratios of runs of points; empty: all 1
  bool with_normals = false;
  double normal_error = 0;  ///< > 0: normals are data too, this many radians off
  float min_dot = 0.0f;     ///< the normal bound: normals nearer than this belong together
  bool skip_lone_normals = true;
  bool split_sheets = false;
  bool internal_only = false;  ///< every ball is kept at r_r, for finer ones to stand below
  bool robust = false;
  bool paper = false;
  std::uint64_t seed = 1;

  FitSettings() = default;
  explicit FitSettings(const FitConstants& values) : constants(values)
  {
    energy.thick = values.preset.thick;
  }

  /** \brief The noise ratio about point i of n: the noise variance there over the cloud's. */
  double noiseRatioAt(std::size_t i, std::size_t n) const
  {
    return noise_profile.empty() ? 1.0 : noise_profile[i * noise_profile.size() / n];
  }

  /** \brief Smaller balls may miss the point that they are about, for their centres stand on a grid. */
  double leastRadius() const { return constants.cover.least_radius * center_grid; }

  /** \brief Whether balls of level k are as wide as the least ball asked for. */
  bool allows(int k) const { return levelRadius(k) >= least_ball; }

  /** \brief Whether balls of level k, and the narrower ones that they mark, hold their own points. */
  bool resolves(int k) const { return levelRadius(k) >= 2 * leastRadius(); }

  /** \brief r_r of level k (eq. 5). */
  double levelRadius(int k) const { return first_radius * diagonal * std::pow(kGolden, k - 1); }
};

}  // namespace pcl_slim::detail

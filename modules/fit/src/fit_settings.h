// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "fit_constants.h"
#include "pcl_slim/fit/fit.h"
#include "radius/energy.h"

namespace pcl_slim::detail {

constexpr double kGolden = 0.6180339887498949;  ///< gamma of eq. (5)

/** \brief Everything the inner steps need to know, in local units; fixed during a fit. */
struct FitSettings {
  FitConstants constants;
  int degree = 4;
  Energy energy;
  WeightKernel fit_kernel = WeightKernel::kPower4;    ///< weights while searching and in general
  WeightKernel wall_kernel = WeightKernel::kPower2;   ///< at minimum support, where bias rules
  WeightKernel cover_kernel = WeightKernel::kPower7;  ///< G of the overlap measure
  double support = 1.15;       ///< n_eff per coefficient below which nothing is fitted
  double lenience = 1.02;      ///< take the largest r with E <= lenience min E
  double lack_of_fit = 2.5;    ///< go finer while e exceeds this many sqrt(lambda); 0: never
  bool find_detail = true;     ///< look for detail below the noise, and for features
  bool compare_nested = true;  ///< let a wide ball stand that costs the inner points nothing
  double residual_gate = 5.0;  ///< a leaf covers points within so many e
  double alpha = 2.0 / 3.0;    ///< a leaf covers within alpha r ...
  double supported_alpha = 2.0 / 3.0;  ///< ... or this, where many points stand behind it
  double gamma = 0.1;
  double diagonal = 1.0;      ///< L
  double first_radius = 0.1;  ///< r_r of level 1 over L: r_0 = L / 10 in the paper
  double start_share = 0.5;   ///< the first level's median ball holds at most so many of the points
  double noise = 0;           ///< variance of points about the surface, in space; 0: not known
  double center_grid = 0x1p-22;
  std::vector<float> noise_profile;  ///< lambda of runs of points over energy.lambda; empty: even
  bool with_normals = false;
  double normal_error = 0;  ///< > 0: normals are data too, this many radians off
  float min_dot = 0.0f;     ///< normals nearer than this belong together
  bool skip_lone_normals = true;
  bool split_sheets = false;
  bool robust = false;
  bool paper = false;
  std::uint64_t seed = 1;

  /** \brief Noise about point i of n, as a share of the cloud's. */
  double loudnessAt(std::size_t i, std::size_t n) const
  {
    return noise_profile.empty() ? 1.0 : noise_profile[i * noise_profile.size() / n];
  }

  /** \brief r_r of level k (eq. 5). */
  double levelRadius(int k) const { return first_radius * diagonal * std::pow(kGolden, k - 1); }
};

}  // namespace pcl_slim::detail

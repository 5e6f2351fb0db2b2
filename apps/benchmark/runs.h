// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "benchmark/treat.h"

namespace pcl_slim::comparison {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/** \brief Errors over all points. A point the method gave no result for counts at the place it
 * had; normals and curvature are counted where the method gives them, away from open borders. */
struct Errors {
  double position = kNone, worst = kNone;  ///< RMS and largest distance [Scene::unit]
  double normal = kNone;                   ///< RMS angle regardless of sign, degrees
  double curvature = kNone;                ///< RMS error of mean curvature / RMS mean curvature
};

/** \brief A setting, what it cost and how near to the truth it came. */
struct Run {
  Setting setting;
  double cpu = 0, wall = 0;  ///< seconds around the call; median over repeats
  double peak_bytes = -1;    ///< rise of resident memory; negative: unknown
  std::uint64_t kept = 0;    ///< points without a result
  Errors errors;
};

/** \brief How far a method's result is from the truth, over the points that the scene judges. */
Errors
measure(const Scene& scene, const Treated& treated);

/** \brief How far the scene's points are from the truth as they come. */
Errors
inputErrors(const Scene& scene);

/** \brief Treats a scene in one way, measured.
 * \param[in] repeats at least 1; times are medians. A run that takes more than two seconds is not
 * repeated. */
Result<Run>
runSetting(const Scene& scene, const Setting& setting, int repeats = 1);

}  // namespace pcl_slim::comparison

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief How far lines of curvature must stand out of the noise: those in space and those in
 * pictures follow the same rule.
 *
 * Significance of a place on a line is its prominence in deviations of the noise
 * (CurvatureNoise), averaged along the line over kMeanReach radii of the leaves to both sides. A
 * stretch of a line is kept where it is at least everywhere, if it reaches somewhere. Noise alone
 * makes an RMS of 1 to 2 without the average. */
struct LineSignificance {
  static constexpr double kAside = 0.5;       ///< where prominence is measured [radii]
  static constexpr double kMeanReach = 0.45;  ///< [radii]

  double everywhere = 2.0;
  double somewhere = 6.5;  ///< at least everywhere
};

/** \brief Curvature k on a line less the mean of k at kAside radii to both sides, across the line.
 * The mean of both: the larger of two is the one that noise favours. */
inline double lineProminence(double k, double k_before, double k_behind) {
  return k - 0.5 * (k_before + k_behind);
}

/** \brief What noise of a surface's points does to differences of its curvature. */
class CurvatureNoise {
 public:
  /** \brief Takes lambda; a surface without noise has the rounding errors of stored points. */
  explicit CurvatureNoise(const SurfaceInfo& info)
      : sigma_(std::max(std::sqrt(std::max(info.lambda, 0.0)), kStorePrecision) * info.diagonal) {}

  /** \brief A difference of curvatures kAside radii apart in deviations of the noise, which are 60
   * sigma / (r^2 sqrt(n_eff)): measured on spheres and tori.
   * \param[in] difference [1/local length]
   * \param[in] radius, effective_count of the leaves there, local units; the count as
   * equivalentCount() */
  double significance(double difference, double radius, double effective_count) const {
    return difference * radius * radius * std::sqrt(effective_count) / (kFactor * sigma_);
  }

 private:
  static constexpr double kStorePrecision = 1e-9;  ///< of L
  static constexpr double kFactor = 60.0;

  double sigma_;  ///< local units
};

}  // namespace pcl_slim

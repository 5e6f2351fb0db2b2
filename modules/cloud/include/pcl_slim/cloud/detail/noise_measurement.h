// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/cloud/detail/noise_constants.h"
#include "pcl_slim/cloud/point_store.h"

namespace pcl_slim::detail {

/** \brief A measured noise level, and the patches that showed it. */
struct NoiseLevel {
  double variance = 0;        ///< lambda, squared local lengths
  double patch_radius = 0;    ///< median radius of the patches, local length
  std::size_t neighbors = 0;  ///< points of such a patch; 0: the store has too few points
  std::size_t patches = 0;    ///< patches measured, of any size
};

/** \brief NoiseEstimator::kCubicResidual. Nothing for stores of fewer than 12 points. */
NoiseLevel
measureNoise(const PointStore& store, const NoiseConstants& constants, int threads);

/** \brief NoiseEstimator::kMinEigenvalue10. Nothing for stores of fewer than 12 points. */
NoiseLevel
measurePaperNoise(const PointStore& store, const NoiseConstants& constants, int threads);

/** \brief noiseProfile() over patches of a level's size. Empty where that is 0. */
std::vector<float>
measureNoiseProfile(const PointStore& store, const NoiseLevel& level,
                    const NoiseConstants& constants, int threads);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/cloud/detail/noise_constants.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief A measured noise level, and the patches that showed it. */
struct NoiseLevel {
  double variance = 0;           ///< lambda, squared local lengths
  double error = 0;              ///< relative standard error of its root
  double patch_radius = 0;       ///< median radius of the patches, local length
  std::size_t neighbors = 0;     ///< points of such a patch; 0: the store has too few points
  std::size_t patches = 0;       ///< patches measured, of any size
  std::size_t line = 0;          ///< points of a patch that is a line; 0: the smallest are none
  double correlation = 1;        ///< tau: points that share their errors; 1: white noise
  double correlation_error = 0;  ///< relative standard error of tau
  double dependence = 1;         ///< of these, as many as a fit takes for one
  double step = 0;               ///< of quantised coordinates, local length; 0: none was found
  std::size_t frames = 0;        ///< whose noise it is; 0: that of the cloud as a whole
  bool uneven = false;           ///< places have more noise, which a fit would take for detail
};

/** \brief NoiseEstimator::kCubicResidual. Nothing for stores of fewer than 12 points. */
PCL_SLIM_EXPORT NoiseLevel
measureNoise(const PointStore& store, const NoiseConstants& constants, int threads);

/** \brief Recognises noise that neighbours share, which measureNoise() takes along as if it were
 * the surface's. \param[in] white result of measureNoise(). \return white itself where noise is
 * white or cannot be distinguished from detail, else variance, patches and number of sharing neighbours of
 * the noise as a whole. O(places k) to the k that shows it all. */
PCL_SLIM_EXPORT NoiseLevel
recognizeSharedNoise(const PointStore& store, const NoiseLevel& white,
                     const NoiseConstants& constants, int threads);

/** \brief The same of a cloud that is merged from frames, by the largest of these: points of two frames share no error.
 * A frame is the points of one number or, where they are not numbered, of one sensor position. recognizeSharedNoise()
 * of a cloud whose points have neither, and of one whose frames have white noise. */
PCL_SLIM_EXPORT NoiseLevel
recognizeFrameNoise(const PointStore& store, const NoiseLevel& white,
                    const NoiseConstants& constants, int threads);

/** \brief The noise that a given number of points share, on patches wide enough to show all of it. */
PCL_SLIM_EXPORT NoiseLevel
measureSharedNoise(const PointStore& store, double correlation, const NoiseConstants& constants,
                   int threads);

/** \brief Rounding in one direction. */
struct StepNoise {
  double step = 0;            ///< median, local length; 0: none was found
  std::size_t neighbors = 0;  ///< points of the patches that show all of it
};

/** \brief The direction in which points are rounded so coarsely that the noise is mostly rounding, as sensors that quantise
 * depth make it; the cloud may be turned. O(n log n) for clouds with few levels, of 8192 points for
 * others. */
PCL_SLIM_EXPORT StepNoise
measureSteps(const PointStore& store, const NoiseConstants& constants, int threads);

/** \brief NoiseEstimator::kMinEigenvalue10. Nothing for stores of fewer than 12 points. */
PCL_SLIM_EXPORT NoiseLevel
measurePaperNoise(const PointStore& store, const NoiseConstants& constants, int threads);

/** \brief noiseProfile() over patches of a level's size. Empty where that is 0. */
PCL_SLIM_EXPORT std::vector<float>
measureNoiseProfile(const PointStore& store, const NoiseLevel& level,
                    const NoiseConstants& constants, int threads);

/** \brief The profile for uneven noise: ratios above 1 where the noise is more than the level's, 1
 * elsewhere and where the excess grows with the patch as detail does. */
PCL_SLIM_EXPORT std::vector<float>
measureRaisedProfile(const PointStore& store, const NoiseLevel& level,
                     const NoiseConstants& constants, int threads);

/** \brief RMS error along the ray from a sensor, a + b z + c z^2 at distance z; local lengths. */
struct RangeError {
  Vector3 sensor{};
  bool own_sensors = false;  ///< each point's, as the store has them
  double a = 0, b = 0, c = 0;
};

/** \brief Noise variances across the surface, squared local lengths, of runs of points along the
 * Morton curve: a range error's share along the normals of small patches. */
PCL_SLIM_EXPORT std::vector<float>
modelledNoise(const PointStore& store, const RangeError& error, const NoiseConstants& constants,
              int threads);

}  // namespace pcl_slim::detail

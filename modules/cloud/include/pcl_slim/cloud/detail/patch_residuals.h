// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief A place as a sensor sees it. */
struct SensorRay {
  double range = 0;   ///< distance from the sensor [local length]
  double cosine = 1;  ///< of the angle between ray and surface normal, >= 0
};

/** \brief The rays to runs of points along the Morton curve.
 * Normals are those of planes through every fourth point of a run and, where these are thick, of
 * the runs around: O(n), without a search for neighbours.
 * \param[in] sensor local position; none: each point's own, which the store must have
 * \param[in] runs their number; 0: as many as a noise profile has */
PCL_SLIM_EXPORT std::vector<SensorRay> raysToRuns(const PointStore& store,
                                                  const std::optional<Vector3>& sensor,
                                                  std::size_t runs, const NoiseConstants& constants,
                                                  int threads);

/** \brief Residual variances of cubics on a narrow and a wide patch at a place. */
struct PlaceResiduals {
  std::array<double, 2> variances{{-1, -1}};  ///< [squared local length]; < 0: unknown
  SensorRay ray;
};

/** \brief The same at evenly strided places.
 * \param[in] sizes number of points of a patch, ascending
 * \param[in] places number of places; no more than there are points
 * \param[in] rays raysToRuns(); empty: the sensor is not known
 * \param[out] radius median radius of the wide patches [local length]
 * \return one entry for each place, in Morton order. O(places k log n). */
PCL_SLIM_EXPORT std::vector<PlaceResiduals> residualsAtPlaces(
    const PointStore& store, const std::array<std::size_t, 2>& sizes, std::size_t places,
    const std::vector<SensorRay>& rays, const NoiseConstants& constants, int threads,
    double& radius);

/** \brief Variance across the surface of the error a + b z + c z^2 along rays [local length], each
 * the mean of the runs around. O(runs). */
PCL_SLIM_EXPORT std::vector<float> rangeNoise(const std::vector<SensorRay>& rays,
                                              const std::array<double, 3>& error,
                                              const NoiseConstants& constants, int threads);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
// What a fit learns of a cloud before it covers it: its noise, the error of its normals, its sides.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "fit_constants.h"
#include "fit_plan.h"
#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief A cloud's errors as given by the user or measured: lambda, the noise profile, the normal
 * bound and what normals weigh as data. checkNormals() must have passed. */
CloudMeasures measureCloud(const PointStore& store, const FitParams& params,
                           const FitConstants& constants, int threads);

/** \brief The viewpoint given, in local units. */
std::optional<Vector3> localViewpoint(const PointStore& store, const FitParams& params);

/** \brief An error where normals are to be data and there are none. */
Error checkNormals(const PointStore& store, const FitParams& params);

/** \brief The noise of a frame by its sensor's. */
struct SensedNoise {
  NoiseLevel level;
  std::vector<float> profile;  ///< variances of runs of points; empty: the level's
};

/** \brief Compares a frame with FitParams::sensor_noise (docs/noise.md, "A sensor's next frame").
 * \param[in,out] statistics get the result of the check \return nothing where none is given or the
 * frame does not agree with it. O(n + places). */
std::optional<SensedNoise> noiseOfSensor(const PointStore& store, const FitParams& params,
                                         const NoiseConstants& constants, int threads,
                                         NoiseStatistics& statistics);

/** \brief The noise of a sensor by one of its frames. \param[in] level, measures of the frame, as
 * measured \return nothing for merged frames and for exact points. O(n + places). */
std::optional<SensorNoise> describeSensor(const PointStore& store, const FitParams& params,
                                          const NoiseLevel& level, const CloudMeasures& measures,
                                          const NoiseConstants& constants, int threads);

/** \brief Whether normals are measured apart from the points (docs/theory.md, "Normals as data").
 */
struct NormalErrorConstants {
  std::size_t samples = 1000;       ///< patches looked at
  std::size_t least_patches = 100;  ///< patches that a result takes
  std::size_t neighbors = 64;     ///< points of a patch: wider than most estimates of normals reach
  std::size_t least_points = 48;  ///< points of a patch on the sample's own side
  std::size_t tilt_points = 9;    ///< the sample and its nearest, for the tilt of heights
  std::size_t pairs = 4;          ///< nearest neighbours that the sample is paired with
  float own_side = 0.3f;          ///< least cosine with the sample's normal
  double least_cosine = 0.1;      ///< least cosine that a slope is read from
  double trim = 0.1;              ///< share of patches left out at either end of the mean
  double with_heights = 0.15;     ///< correlation with the points' tilt from which it repeats them
  double with_neighbors = 0.03;   ///< correlation with neighbours from which they repeat them
};

/** \brief The error of normals, and whether they add information to the points' places. */
struct NormalError {
  double radians = 0;         ///< RMS angle to a smooth surface through the neighbours' normals
  double with_heights = 0;    ///< correlation with the tilt that the points' own noise suggests
  double with_neighbors = 0;  ///< correlation between nearest neighbours

  /** \brief Normals measured apart from the points show neither correlation. Those computed from
   * noisy points, or from a mesh over them, follow the points' noise and share it with their
   * neighbours: they would be counted twice. */
  bool independent(const NormalErrorConstants& constants = {}) const {
    return radians > 0 && with_heights < constants.with_heights &&
           with_neighbors < constants.with_neighbors;
  }
};

/** \brief Compares normals with cubics on patches of 64 neighbours about 1000 points, evenly
 * strided; all 0 where fewer than 100 patches are usable (docs/theory.md, "Normals as data").
 * O(patches log points); the same for any number of threads. */
NormalError measureNormalError(const PointStore& store, const NormalErrorConstants& constants,
                               int threads);

/** \brief What is known of the sides of a cloud's points before the cover. */
struct CloudSides {
  /// The points as the cover reads them: with sides, and moved where that helps; none: as they are.
  std::optional<PointStore> for_cover;
  std::optional<PointStore> after_cover;  ///< with the sides after it; none: those of the cover
  CloudMeasures measures;                 ///< of the cloud with its sides
  SideStatistics statistics;

  const PointStore& coverStore(const PointStore& points) const {
    return for_cover ? *for_cover : points;
  }
  const PointStore& storeAfterCover(const PointStore& points) const {
    return after_cover ? *after_cover : coverStore(points);
  }
};

/** \brief Finds sides of the points of a cloud without normals where balls would meet both sides of
 * thin parts, and measures the cloud anew with them (docs/sides.md, "Sides before the cover").
 * \param[in] measures made without sides */
CloudSides sidesBeforeCover(const PointStore& store, const FitParams& params,
                            const FitConstants& constants, int threads, CloudMeasures measures);

}  // namespace pcl_slim::detail

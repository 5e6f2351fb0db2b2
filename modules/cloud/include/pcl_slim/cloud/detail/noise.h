// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim::detail {

/** \brief Separation of a patch that contains two sheets (docs/theory.md, "Sheets"). */
struct PatchSheetConstants {
  int passes = 4;  ///< iterations of two-means on the heights
  /// Least gap between the heights of two sheets, as a multiple of the larger range of heights on
  /// either side.
  double gap = 1.0;
  /// Factor of the number of neighbours after a sheet was dropped, which restores the patch's size.
  std::size_t neighbor_factor = 2;
};

/** \brief Separation of noise that neighbours share from detail (docs/noise.md,
 * "Plateaus").
 *
 * A growth is the binary logarithm of the factor by which a figure grows from patches of k points
 * to patches of 2 k points. */
struct SharedNoiseConstants {
  std::size_t places = 300;        ///< number of places, where no error shows how many it takes
  std::size_t most_places = 6400;  ///< largest number of places, used where the error is too large
  std::size_t cells = 32;          ///< number of squares that a patch is cut into
  /// The power is constant if it grows by less than this share of its greatest growth so far. A
  /// later plateau counts only then.
  double constant_power_ratio = 0.8;
  /// The same for thin parts with sides that were found. Their patches end at borders, where the
  /// power of a shape slows down, too.
  double sided_constant_power_ratio = 0.5;
  double trim = 0.15;  ///< share of the places left out at either end of the mean of a size
  /// Correlation from which it counts in full [points]. It does not count below kLeastCorrelation.
  double full_correlation = 2;
  double white_correlation = 1.05;  ///< largest correlation of white noise [points]
  /// Largest growth of the variance that white noise shows by chance.
  double white_growth = 0.2;
};

/** \brief Measurement of a cloud's noise level (docs/noise.md, "White noise"). */
struct NoiseConstants {
  std::size_t first_neighbors = 20;  ///< number of points of the smallest patch
  /// The largest patch contains this part of the cloud: one eighth.
  std::size_t most_part = 8;
  /// Most points of a patch that are used. Of a larger patch every second, fourth, ... is used.
  std::size_t patch_points = 320;
  std::size_t least_samples = 100;  ///< least number of patches of one size; a curve's at first
  double trim = 0.1;                ///< share of the patches left out at either end of a mean
  /// sqrt(lambda) over the radius of the patch above which noise fills the patch. A patch of twice
  /// as many points is measured then.
  double patch_noise = 0.4;
  /// Factor by which the squared bias of a cubic grows when the number of points doubles. The bias
  /// grows like the eighth power of the radius.
  double bias_growth = 16.0;

  /// Least ratio of a local noise variance to the cloud's. Its inverse is the largest.
  float least_ratio = 0.05f;

  PatchSheetConstants sheets;
  SharedNoiseConstants shared;
};

/** \brief The normal bound (docs/theory.md, "Sheets"). */
struct NormalBoundConstants {
  /// Tilt by which errors of the normals lower the bound [standard deviations of the normals].
  double deviations = 3.0;
};

/** \brief A noise level, and the patches that it was measured on. */
struct NoiseLevel {
  double variance = 0;        ///< lambda [squared local length]
  double error = 0;           ///< relative standard error of sqrt(lambda)
  double patch_radius = 0;    ///< median radius of the patches [local length]
  std::size_t neighbors = 0;  ///< points of such a patch; 0: the store has too few points
  std::size_t patches = 0;    ///< number of patches measured, of any size
  /// Largest number of points whose patches are lines; 0: the smallest patches are no lines.
  std::size_t line = 0;
  double correlation = 1;        ///< tau: number of points that share an error; 1: white noise
  double correlation_error = 0;  ///< relative standard error of tau
  /// Number of points that a fit counts as one independent point; less than a large tau.
  double dependence = 1;
  double step = 0;         ///< step of quantised coordinates [local length]; 0: none was found
  std::size_t frames = 0;  ///< number of frames measured; 0: the cloud was measured as a whole
};

/** \brief Measures noise by NoiseEstimator::kCubicResidual. \return an empty level for stores of
 * fewer than 12 points. */
PCL_SLIM_EXPORT NoiseLevel measureNoise(const PointStore& store, const NoiseConstants& constants,
                                        int threads);

/** \brief Measures noise that neighbours share. measureNoise() sees only the part of it that
 * differs from point to point.
 * \param[in] white result of measureNoise()
 * \return white itself where the noise is white or cannot be separated from detail; else variance,
 * patches and correlation of all noise. O(places k) for the widest patch's k. */
PCL_SLIM_EXPORT NoiseLevel recognizeSharedNoise(const PointStore& store, const NoiseLevel& white,
                                                const NoiseConstants& constants, int threads);

/** \brief Measures shared noise of a cloud that is merged from frames, in the largest frames one
 * by one, because points of two frames share no error. A frame is the points of one frame number
 * or, without numbers, of one sensor position. Calls recognizeSharedNoise() for a cloud without
 * either, and for one whose frames have white noise. */
PCL_SLIM_EXPORT NoiseLevel recognizeFrameNoise(const PointStore& store, const NoiseLevel& white,
                                               const NoiseConstants& constants, int threads);

/** \brief Measures noise of a given correlation, on patches wide enough to show all of it. */
PCL_SLIM_EXPORT NoiseLevel measureSharedNoise(const PointStore& store, double correlation,
                                              const NoiseConstants& constants, int threads);

/** \brief Rounding of the points along one direction. */
struct StepNoise {
  double step = 0;            ///< median step [local length]; 0: none was found
  std::size_t neighbors = 0;  ///< points of a patch that is wide enough to show all of it
};

/** \brief Finds rounding so coarse that most of the noise is rounding, as in the depth of some
 * sensors. The cloud may have any orientation. O(n log n) for clouds on few levels; other clouds
 * are rejected after 100 places. */
PCL_SLIM_EXPORT StepNoise measureSteps(const PointStore& store, const NoiseConstants& constants,
                                       int threads);

/** \brief Measures noise by NoiseEstimator::kMinEigenvalue10. \return an empty level for stores
 * of fewer than 12 points. */
PCL_SLIM_EXPORT NoiseLevel measurePaperNoise(const PointStore& store, int threads);

/** \brief noiseProfile() over patches of a level's size. \return empty for a size of 0. */
PCL_SLIM_EXPORT std::vector<float> measureNoiseProfile(const PointStore& store,
                                                       const NoiseLevel& level,
                                                       const NoiseConstants& constants,
                                                       int threads);

/** \brief How white noise varies over a cloud, as noiseProfile(), by empirical Bayes.
 *
 * A place's noise is the median of 17 patches around it. Its logarithm over the cloud's is drawn
 * towards 0 by its standard error over the scatter of all places: noise that is alike everywhere
 * gives one level, a mixture its parts. A place counts where its noise does not depend on the size of
 * the patch, as that of detail and edges does. \return ratios between 1e-6 and 20;
 * empty where the differences are within two standard errors of chance. O(n / 128 patches of k and
 * of 2 k points).
 * \param[in] known the noise varies: it is measured without this test */
PCL_SLIM_EXPORT std::vector<float> measureNoiseField(const PointStore& store,
                                                     const NoiseLevel& level, bool known,
                                                     const NoiseConstants& constants, int threads);

/** \brief The normal bound: the largest cosine of two normals that count as normals of different
 * sheets.
 *
 * 1. Exact normals: -0.25, a turn of 104 degrees, so that faces at right angles are one rounded
 *    surface.
 * 2. Noisy normals: lower by three standard deviations of their errors, to -0.6 at least, so that a
 *    ball on a bent surface keeps the points with the worst normals.
 * 3. Sides that were found instead of given: 0 in place of -0.25.
 *
 * Errors are measured by the median angle between normals and the mean of their block, which edges
 * and curvature of less than half of the surface do not change. O(1000 blocks).
 */
PCL_SLIM_EXPORT float normalBound(const PointStore& store,
                                  const NormalBoundConstants& constants = {});

}  // namespace pcl_slim::detail

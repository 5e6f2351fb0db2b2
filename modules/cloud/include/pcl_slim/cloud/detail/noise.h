// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief How a patch is separated where it contains two sheets (docs/theory.md, "Sheets"). */
struct PatchSheetConstants {
  int passes = 4;    ///< rounds of two-means on the heights
  double gap = 1.0;  ///< a gap this many times the larger spread of the two sides parts sheets
  std::size_t factor = 2;  ///< factor of the number of neighbours where a sheet was dropped
};

/** \brief How noise that neighbours share is distinguished from detail (docs/theory.md, "Noise that
 * neighbours share"). Growth is the binary logarithm of the factor by which a figure grows from
 * patches of k points to patches of 2 k. */
struct SharedNoiseConstants {
  std::size_t places = 300;        ///< places where patches are compared ...
  std::size_t most_places = 6400;  ///< ... and up to this many where the noise is in doubt
  std::size_t cells = 32;          ///< of equal size, into which a patch's points fall
  /// Growth of the power, as a share of the greatest growth before, at which it is not constant;
  /// the same of thin parts with sides that were found.
  double slowing = 0.8, sided_slowing = 0.5;
  double trim = 0.15;   ///< share of patches left out at either end of a size's mean
  double all = 2;       ///< neighbours that share noise from which they count in full
  double white = 1.05;  ///< number of points up to which noise counts as white
  double chance = 0.2;  ///< growth from the smallest patches' variance that white noise may show
};

/** \brief The measurement of a cloud's noise level (docs/theory.md, "Noise"). */
struct NoiseConstants {
  std::size_t first_neighbors = 20;  ///< points of the smallest patch
  std::size_t most_part = 8;         ///< a patch contains at most the cloud's points over this
  std::size_t patch_points = 320;    ///< points used of a patch; larger patches are sampled
  std::size_t least_samples = 100;   ///< patches of a large size
  double trim = 0.1;                 ///< share of patches left out at either end of a trimmed mean
  double patch_noise = 0.4;  ///< sqrt(lambda) over the patch's radius above which noise fills it
  /// A cubic's squared bias grows by this when the number of points doubles (radius to the eighth).
  double bias_growth = 16.0;

  std::size_t paper_samples = 1000;  ///< neighbourhoods of the paper's estimate
  std::size_t paper_neighbors = 10;  ///< neighbours of each, the sample left out
  double paper_floor = 1e-6;         ///< least sqrt(lambda) of the paper's estimate [L]

  float least_ratio =
      0.05f;  ///< least noise ratio of an entry of a profile; its inverse is the largest

  PatchSheetConstants sheets;
  SharedNoiseConstants shared;
};

/** \brief The normal bound (docs/theory.md, "Sheets"). */
struct NormalBoundConstants {
  double deviations = 3.0;  ///< deviations of the normals' errors that the bound falls by
};

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
PCL_SLIM_EXPORT NoiseLevel measureNoise(const PointStore& store, const NoiseConstants& constants,
                                        int threads);

/** \brief Recognises noise that neighbours share, which measureNoise() takes along as if it were
 * the surface's. \param[in] white result of measureNoise(). \return white itself where noise is
 * white or cannot be distinguished from detail, else variance, patches and number of sharing
 * neighbours of the noise as a whole. O(places k) to the k that shows it all. */
PCL_SLIM_EXPORT NoiseLevel recognizeSharedNoise(const PointStore& store, const NoiseLevel& white,
                                                const NoiseConstants& constants, int threads);

/** \brief The same of a cloud that is merged from frames, by the largest of these: points of two
 * frames share no error. A frame is the points of one number or, where they are not numbered, of
 * one sensor position. recognizeSharedNoise() of a cloud whose points have neither, and of one
 * whose frames have white noise. */
PCL_SLIM_EXPORT NoiseLevel recognizeFrameNoise(const PointStore& store, const NoiseLevel& white,
                                               const NoiseConstants& constants, int threads);

/** \brief The noise that a given number of points share, on patches wide enough to show all of it.
 */
PCL_SLIM_EXPORT NoiseLevel measureSharedNoise(const PointStore& store, double correlation,
                                              const NoiseConstants& constants, int threads);

/** \brief Rounding in one direction. */
struct StepNoise {
  double step = 0;            ///< median, local length; 0: none was found
  std::size_t neighbors = 0;  ///< points of the patches that show all of it
};

/** \brief The direction in which points are rounded so coarsely that the noise is mostly rounding,
 * as sensors that quantise depth make it; the cloud may be turned. O(n log n) for clouds with few
 * levels, of 8192 points for others. */
PCL_SLIM_EXPORT StepNoise measureSteps(const PointStore& store, const NoiseConstants& constants,
                                       int threads);

/** \brief NoiseEstimator::kMinEigenvalue10. Nothing for stores of fewer than 12 points. */
PCL_SLIM_EXPORT NoiseLevel measurePaperNoise(const PointStore& store,
                                             const NoiseConstants& constants, int threads);

/** \brief noiseProfile() over patches of a level's size. Empty where that is 0. */
PCL_SLIM_EXPORT std::vector<float> measureNoiseProfile(const PointStore& store,
                                                       const NoiseLevel& level,
                                                       const NoiseConstants& constants,
                                                       int threads);

/** \brief The profile for uneven noise: ratios above 1 where the noise is more than the level's, 1
 * elsewhere and where the excess grows with the patch as detail does. */
PCL_SLIM_EXPORT std::vector<float> measureRaisedProfile(const PointStore& store,
                                                        const NoiseLevel& level,
                                                        const NoiseConstants& constants,
                                                        int threads);

/** \brief RMS error along the ray from a sensor, a + b z + c z^2 at distance z; local lengths. */
struct RangeError {
  Vector3 sensor{};
  bool own_sensors = false;  ///< each point's, as the store has them
  double a = 0, b = 0, c = 0;
};

/** \brief Noise variances across the surface, squared local lengths, of runs of points along the
 * Morton curve: a range error's share along the normals of small patches. */
PCL_SLIM_EXPORT std::vector<float> modelledNoise(const PointStore& store, const RangeError& error,
                                                 const NoiseConstants& constants, int threads);

/** \brief The normal bound: the cosine up to which two normals of a store count as those of
 * different sheets.
 *
 * Exact normals part sheets that turn by more than 104 degrees: -0.25, so that faces at right
 * angles are one rounded surface. Three deviations of the normals' own errors may go below it, so
 * that a ball that bends keeps the points whose normals happen to be worst; never below -0.6. Sides
 * that were found, not given, part at right angles. Errors are the median angle between normals and
 * the mean over their block, so edges and curvature of most of the surface matter little. O(1000
 * blocks).
 */
PCL_SLIM_EXPORT float normalBound(const PointStore& store,
                                  const NormalBoundConstants& constants = {});

}  // namespace pcl_slim::detail

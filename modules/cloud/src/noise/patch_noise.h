// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "noise/patch.h"
#include "pcl_slim/cloud/detail/noise_constants.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

/** \brief The k points of a search nearest to a sample; where the store has normals, those whose
 * normal is opposed to the sample's are left out. \param[in] about as in NeighborSearch::nearestSet() */
void
patchAbout(const PointStore& store, NeighborSearch& search, std::size_t sample, std::size_t k,
           Patch& patch, double about = 0);

/** \brief A squared radius that probably contains factor times the points of a patch, on a surface. */
inline double
probableSquare(double radius, double factor)
{
  constexpr double kMargin = 1.4;
  return kMargin * factor * radius * radius;
}

/** \brief A cubic height field over a patch's two main axes, in units of the patch's radius. */
struct PatchCubic {
  PatchPoints places;  ///< of the points: along the normal and the two axes, lesser first
  AlignedVector<double> residuals;  ///< of the heights; kPadding more than places
  double variance = 0;  ///< of the residuals per degree of freedom, squared local lengths
};

/** \brief Fits a cubic to a patch by least squares. \return false where there are too few points. */
bool
fitCubic(const Patch& patch, PatchCubic& cubic);

/** \brief The variance of isotropic noise whose residuals a patch shows. A patch is a ball about one of
 * its points and cuts heights off: of a plane's noise s a radius R >= 2.2 s leaves s^2 (1 - 2 q - 22 q^2),
 * with q the residuals' variance over R^2, to one per cent of s (docs/theory.md, "Noise"). */
double
uncutVariance(double variance, double radius);

/** \brief The same of many places along the Morton curve, with the mean of q about each.
 * \param[in,out] variances < 0: not known */
void
putBackCutOff(const std::vector<double>& radii, const NoiseConstants& constants, int threads,
              std::vector<double>& variances);

/** \brief The stride of the points looked at for patches of k points. */
inline std::size_t
patchStride(std::size_t k, const NoiseConstants& constants)
{
  return std::max<std::size_t>(1, k / constants.patch_points);
}

/** \brief Fits a cubic to the patch of k points about a sample, to the sample's own sheet where two run
 * through it. \return false: too few points. \param[in] search over every patchStride(k)-th point
 * \param[in] about as in NeighborSearch::nearestSet() \param[out] radius of the patch */
bool
fitPatch(const PointStore& store, NeighborSearch& search, std::size_t sample, std::size_t k,
         const NoiseConstants& constants, PatchCubic& cubic, double& radius, double about = 0);

/** \brief Residual variance of a cubic on the patch of k points about a sample, in squared local
 * lengths; < 0: too few points. \param[in] search over every patchStride(k)-th point \param[out]
 * radius of the patch */
double
patchVariance(const PointStore& store, NeighborSearch& search, std::size_t sample, std::size_t k,
              const NoiseConstants& constants, double& radius);

/** \brief The points of the smallest patches: first_neighbors, doubled until half of them are no
 * lines. Where rings of a turning lidar are many spacings apart, no noise shows along one of them. */
std::size_t
smallestPatch(const PointStore& store, const NoiseConstants& constants, int threads);

/** \brief Mean of the values that are not negative, without a share of the largest and as many of
 * the smallest; 0 of none. Sorts them. */
double
trimmedMean(std::vector<double>& values, double trim);

/** \brief Relative standard error of that mean, by the values' winsorized variance (Tukey and McLaughlin
 * 1963); 0 of fewer than two. */
double
trimmedMeanError(std::vector<double> values, double trim);

/** \brief Trimmed means over windows about each of the values, which are in Morton order. */
std::vector<float>
windowedMeans(const std::vector<double>& values, const NoiseConstants& constants, int threads);

/** \brief Whether a variance grows no more from k to 2 k neighbours than white noise's may. */
inline bool
isFlat(double narrow, double wider, const NoiseConstants& constants)
{
  return wider <= std::exp2(constants.shared.chance) * narrow;
}

/** \brief Calls measure(search, sample, s) at evenly strided points, s counting them. */
template <typename Measure>
std::vector<double>
sampleStore(const PointStore& store, std::size_t samples, std::size_t stride, int threads,
            const Measure& measure)
{
  samples = std::min(samples, store.size());
  std::vector<double> values(samples);
  std::vector<NeighborSearch> searches(static_cast<std::size_t>(threads),
                                       NeighborSearch(store, stride));
  parallelFor(samples, threads, 4, [&](std::size_t s, int thread) {
    const std::size_t sample = (2 * s + 1) * store.size() / (2 * samples);
    values[s] = measure(searches[static_cast<std::size_t>(thread)], sample, s);
  });
  return values;
}

}  // namespace pcl_slim::detail

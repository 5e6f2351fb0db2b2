// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief How a cloud's noise variance is measured. */
enum class NoiseEstimator : unsigned char {
  kCubicResidual,   ///< residual of an unweighted cubic on 20 or more neighbours (the default)
  kMinEigenvalue10  ///< mean smallest eigenvalue of the 10-neighbour covariance (Ohtake et al. 2005)
};

/** \brief Noise variance lambda of a cloud, in squared local lengths.
 *
 * kCubicResidual: residual variance RSS / (k - 10) of a cubic height field in the frame of its
 * neighbourhood, k = 20 and doubled while half of the patches are lines, as on a lidar's rings, or
 * noise fills the patch, with what the patch's end cuts off put back; the mean over 100 to 500
 * evenly strided samples without the largest and smallest 10 %. Of wide patches 320 to 640 points
 * are looked at, spread evenly. What grows with k like a cubic's bias is taken off, so that clean
 * data show no noise. Where normals are given, neighbours of opposed normal are left out.
 * kMinEigenvalue10: the paper's lambda over 1000 samples (its mean covariance). Never below (1e-6
 * L)^2 for the paper's, (1e-11 L)^2 for the default. 0 if the store has fewer than 12 points.
 * O(samples k).
 */
PCL_SLIM_EXPORT double estimateNoise(const PointStore& store, NoiseEstimator estimator,
                                     int threads = 0);

/** \brief How noise varies over a cloud: variances over the whole cloud's, for runs of points along
 * the Morton curve.
 *
 * Entry j of m is that of the points from j n / m on; it is the trimmed mean of 17 patches, at
 * places that follow each other along the curve and so are close together; accurate to about a
 * tenth. Between 1/1000 and 1000. Empty if the store has fewer than 12 points. O(n / 128 patches),
 * at most 8192.
 */
PCL_SLIM_EXPORT std::vector<float> noiseProfile(const PointStore& store, int threads = 0);

}  // namespace pcl_slim

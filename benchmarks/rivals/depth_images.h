// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "rivals/mls.h"

namespace pcl_slim::rivals {

/** \brief Points of a depth image, row by row, without gaps. */
struct DepthImage {
  std::vector<Vector3> points;
  std::size_t columns = 0;
};

/** \brief pcl::FastBilateralFilter, without normals.
 * \param[in] sigma_s deviation in the image [pixels] \param[in] sigma_r of depth [m] */
std::vector<Vector3> smoothByBilateralFilter(const DepthImage& image, double sigma_s,
                                             double sigma_r);

/** \brief Unit normals by pcl::IntegralImageNormalEstimation, average 3D gradient; NaN where it
 * gives none. \param[in] size of its smoothing [pixels] */
std::vector<Vector3> normalsByIntegralImages(const DepthImage& image, double size);

}  // namespace pcl_slim::rivals

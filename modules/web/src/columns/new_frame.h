// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

/** \brief A ball with the normal of its frame. */
struct FramedBall {
  Vector3 center, normal;
  double radius;
};

/** \brief Rewrites a polynomial for a ball and frame that differ a little: the same heights, but for the
 * product of tilt and height. \param[in] c numCoefficients(degree) values */
std::array<double, kMaxCoefficients>
inNewFrame(int degree, const float* c, const FramedBall& from, const FramedBall& to);

/** \brief The same for values over the plane that are no heights, such as colours. */
std::array<double, kMaxCoefficients>
valuesInNewFrame(int degree, const float* c, const FramedBall& from, const FramedBall& to);

}  // namespace pcl_slim::detail

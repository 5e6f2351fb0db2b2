// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "pcl_slim/core/export.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

/** \brief A ball with the normal of its frame. */
struct SurfelFrame {
  Vector3 center, normal;
  double radius;
};

/** \brief Rewrites a polynomial for a ball and frame that differ a little: the same heights, but
 * for the product of tilt and height. \param[in] c numCoefficients(degree) values */
PCL_SLIM_EXPORT std::array<double, kMaxCoefficients> inNewFrame(int degree, const float* c,
                                                                const SurfelFrame& from,
                                                                const SurfelFrame& to);

/** \brief Rewrites a surfel's colours (kColorBytes) for another ball and frame. */
PCL_SLIM_EXPORT void recolorInNewFrame(const SurfelFrame& from, const SurfelFrame& to,
                                       std::uint8_t* bytes);

}  // namespace pcl_slim::detail

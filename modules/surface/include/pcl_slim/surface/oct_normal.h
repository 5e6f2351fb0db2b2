// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief Steps of a code's coordinate to each side, 2^22: codes are exact in float, and rounding a
 * decoded normal to float moves it by at most an eighth of a step, so that encoding it again finds
 * the same grid point. */
constexpr double kOctGrid = 4194304.0;

/** \brief A unit normal as two numbers: its place on the octahedron |x| + |y| + |z| = 1, folded
 * open to the square [-1, 1]^2, on a grid of step 2^-22 (any direction is within 6.2e-7 rad).*/
struct OctNormal {
  float a = 0.0f, b = 0.0f;
};

/** \brief The grid normal nearest to a direction (any length but 0). O(1).
 *
 * encodeNormal(decodeNormal(q)) gives q back for every q this function made, and the normal
 * turned round has exactly the code of the opposite grid normal. No grid normal has z = 0, so
 * that the sign of z, on which LocalFrame hangs, is never lost. A zero or non-finite direction
 * counts as +z.
 * \param[in] grid steps of a coordinate to each side, a whole number
 */
PCL_SLIM_EXPORT OctNormal encodeNormal(const std::array<double, 3>& normal, double grid = kOctGrid);

/** \brief Unit normal of a code: computed in double, rounded to float. */
PCL_SLIM_EXPORT std::array<float, 3> decodeNormal(OctNormal code);

/** \brief The float normal a surfel gets so that two numbers describe it exactly. */
PCL_SLIM_EXPORT std::array<float, 3> snapNormal(const std::array<double, 3>& normal);

}  // namespace pcl_slim

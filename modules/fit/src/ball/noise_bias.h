// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fit_constants.h"

namespace pcl_slim::detail {

/** \brief Takes back what noise does to the heights of a least-squares fit, on average.
 *
 * Points are off sideways as well: the mean height of those that end up at (u, v) is
 * h + lambda/2 (h_uu + h_vv) for isotropic noise (errors in variables; waves are worn down, spheres
 * shrink). And weights fall with a point's distance in space, which favours heights near the
 * centre's: they are drawn to it by 1 / (1 + 2 (m + 1) lambda / r^2) for the kernel (1 - s^2)^m; m
 * is taken as 4, the default kernel's, for the few fits at minimum support too. O(P).
 *
 * \param[in] share lambda / r^2, the noise variance in units of the ball; balls that the noise
 * fills would amplify it, so no more is taken back than constants.most_share says
 * \param[in,out] c numCoefficients(degree) values in units of r
 */
void
undoNoiseBias(const BiasConstants& constants, int degree, double share, float* c);

/** \brief The same for coefficients in another unit of length. \param[in] rho r in that unit */
void
undoNoiseBias(const BiasConstants& constants, int degree, double share, double rho, double* c);

}  // namespace pcl_slim::detail

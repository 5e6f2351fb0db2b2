// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fit_constants.h"
#include "pcl_slim/surface/weight_kernel.h"

namespace pcl_slim::detail {

/** \brief How fast weights G(s) that fall with the distance in space fall with a point's height.
 *
 * Over a plane they fall by 1 - a/2 (height / r)^2 to second order, so that noise of variance lambda
 * is seen as lambda / (1 + a lambda / r^2). \return a = 2 G(0) / (the integral of G over s^2):
 * 2 (m + 1) for (1 - s^2)^m. */
double
heightTruncation(WeightKernel kernel);

/** \brief Takes back what noise does to the heights of a least-squares fit, on average.
 *
 * Points are off sideways as well: the mean height of those that end up at (u, v) is
 * h + lambda/2 (h_uu + h_vv) for isotropic noise (errors in variables; waves are worn down, spheres
 * shrink). And weights fall with a point's distance in space, which favours heights near the centre's:
 * they are drawn to it by 1 / (1 + a lambda / r^2), a from heightTruncation(). O(P).
 *
 * \param[in] kernel the weights of the fit
 * \param[in] share lambda / r^2, the noise variance in units of the ball; balls that the noise
 * fills would amplify it, so no more than constants.most_share is taken back
 * \param[in,out] c numCoefficients(degree) values in units of r
 */
void
undoNoiseBias(const BiasConstants& constants, WeightKernel kernel, int degree, double share,
              float* c);

/** \brief The same for coefficients in another unit of length. \param[in] rho r in that unit */
void
undoNoiseBias(const BiasConstants& constants, WeightKernel kernel, int degree, double share,
              double rho, double* c);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/query/projection.h"

namespace pcl_slim::detail {

/** \brief Mean and Gaussian curvature of a level set (eq. 8, left).
 * \param[in] g gradient; \param[in] length its length, > 0; \param[in] h Hessian: xx xy xz yy yz zz.
 * Positive where the surface bends away from g. */
std::array<float, 2>
meanAndGaussian(const double g[3], double length, const double h[6]);

/** \brief Eigenvalues and eigenvectors of the same level set's shape operator. */
PrincipalFrame
principalCurvatures(const double g[3], double length, const double h[6]);

/** \brief Fills in dk/dt along each principal direction t: (T(t,t,t) - 3 k H(t,n)) / |g|.
 * \param[in] third third derivatives: xxx xxy xxz xyy xyz xzz yyy yyz yzz zzz. */
void
setExtremality(const double g[3], double length, const double h[6], const double third[10],
               PrincipalFrame& principal);

}  // namespace pcl_slim::detail

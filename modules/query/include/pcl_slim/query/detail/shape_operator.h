// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/core/export.h"
#include "pcl_slim/core/symmetric.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/query/projection.h"

namespace pcl_slim::detail {

/** \brief Mean and Gaussian curvature of a level set (eq. 8, left).
 * \param[in] g gradient; \param[in] length its length, > 0; \param[in] h Hessian.
 * Positive where the surface bends away from g. */
PCL_SLIM_EXPORT std::array<float, 2>
meanAndGaussian(const Vector3& g, double length, const Symmetric3<double>& h);

/** \brief Eigenvalues and eigenvectors of the same level set's shape operator. */
PCL_SLIM_EXPORT PrincipalFrame
principalCurvatures(const Vector3& g, double length, const Symmetric3<double>& h);

/** \brief Fills in dk/dt along each principal direction t: (T(t,t,t) - 3 k H(t,n)) / |g|.
 * \param[in] third third derivatives: xxx xxy xxz xyy xyz xzz yyy yyz yzz zzz. */
PCL_SLIM_EXPORT void
setExtremality(const Vector3& g, double length, const Symmetric3<double>& h, const double third[10],
               PrincipalFrame& principal);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/surface/weight_kernel.h"

namespace pcl_slim::detail {

struct BallBuffer;

/** \brief A weighted least-squares polynomial and the measures the radius search needs. */
struct LocalFit {
  static constexpr int kMaxMoments = 45;

  int degree = 0;                               ///< 0: nothing could be fitted
  WeightKernel kernel = WeightKernel::kPower4;  ///< the weights it was made with
  std::array<double, kMaxCoefficients> c{};     ///< in units of the gather radius
  double residual_sq = 0;                       ///< e^2 = sum w f^2 / sum w, gather radius squared
  double n_eff = 0;                             ///< (sum w)^2 / sum w^2
  double slope_sq = 0;                          ///< mean of |grad h|^2, weights w
  double terms = 0;  ///< coefficients that the heights decide: their number, fewer with slopes
  double slope_misfit = 0;  ///< slope_weight times the mean square slope missed, like residual_sq
  bool fell_by_pivot = false;  ///< the points, not the pivots, allowed the requested degree
  double least_pivot = 1;      ///< over its diagonal entry; set for refined fits
  int moment_degree = 0;       ///< the requested degree; moments go up to twice that
  std::array<double, kMaxMoments> moments{};  ///< sum w u^i v^j, in rows of fixed i (momentIndex)
};

/** \brief The fit of a lower degree to the same points with the same weights.
 *
 * No point is looked at: its normal equations are part of the higher degree's, whose moments and
 * solution are at hand, and the least residual grows by the mean square of the two fits'
 * difference. For heights alone: slopes as data have moments of their own, which are not kept.
 * \param[in] degree below fit.degree. \return a fit of degree 0 where it cannot be solved. O(P^3).
 */
LocalFit
nestedFit(const LocalFit& fit, int degree);

namespace kernels {

/** \brief Fits heights w over (u, v) with weights G(s / rho) to the points within rho.
 *
 * Minimises sum w (f^2 + slope_weight n_w |grad h - slope|^2): where normals are data, positions
 * and normals are combined by their variances (Nehab et al. 2005). Falls back to the highest lower
 * degree whose n_eff and pivots allow it. \param[in] support points n_eff needed per coefficient.
 * \param[in] refine one step of iterative refinement, for the fit that is kept. */
LocalFit
fitBall(const BallBuffer& ball, int degree, float rho, WeightKernel kernel, double support,
        bool refine);

/** \brief n_eff = (sum w)^2 / sum w^2 of the weights G(s / rho); 0 for an empty ball. */
double
effectiveCount(const BallBuffer& ball, float rho, WeightKernel kernel);

}  // namespace kernels
}  // namespace pcl_slim::detail

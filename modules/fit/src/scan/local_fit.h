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
  double terms = 0;  ///< coefficients that the heights decide: their number, fewer beside slopes
  double slope_misfit = 0;  ///< slope_weight times the mean square slope missed, like residual_sq
  bool fell_by_pivot = false;  ///< the degree asked for had the points, not the pivots
  double least_pivot = 1;      ///< over its diagonal entry; told for refined fits
  int moment_degree = 0;       ///< the degree asked for: moments go up to twice that
  std::array<double, kMaxMoments> moments{};  ///< sum w u^i v^j, in rows of fixed i (momentIndex)
};

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

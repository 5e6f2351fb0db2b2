// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace pcl_slim {

/** \brief Radial weight G(s), s = distance / radius; 1 at the centre, 0 from s = 1 on.
 *
 * The polynomial kernels (1 - s^2)^m need no exponential; m = 7 is nearly the paper's
 * spline-patched Gaussian. Small m uses the rim of the ball, which lowers bias; large m makes
 * blends smoother (docs/theory.md gives the measurements behind the defaults).
 */
enum class WeightKernel : unsigned char {
  kPower2 = 2,    ///< (1 - s^2)^2
  kPower4 = 4,    ///< (1 - s^2)^4
  kPower7 = 7,    ///< (1 - s^2)^7
  kGaussian = 16  ///< Ohtake et al. 2005: exp(-8 s^2) for s < 1/2, then 16 e^-2 (1 - s)^4
};

/** \brief G at the squared relative distance s_sq = (distance / radius)^2. */
inline double evaluateKernel(WeightKernel kernel, double s_sq) {
  if (!(s_sq < 1.0)) return 0.0;
  if (kernel == WeightKernel::kGaussian) {
    if (s_sq < 0.25) return std::exp(-8.0 * s_sq);
    const double d = 1.0 - std::sqrt(s_sq);
    return 16.0 * std::exp(-2.0) * d * d * d * d;
  }
  const double q = 1.0 - s_sq;
  const double q2 = q * q;
  switch (kernel) {
    case WeightKernel::kPower2: return q2;
    case WeightKernel::kPower4: return q2 * q2;
    default: return q2 * q2 * q2 * q;
  }
}

}  // namespace pcl_slim

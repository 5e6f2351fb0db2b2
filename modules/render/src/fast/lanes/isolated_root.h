// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "pcl_slim/query/detail/polynomial_roots.h"

namespace pcl_slim::detail {

/** \brief The root in [low, high] nearest to aim (of equals the first), by isolating every one.
 * With front_only only roots at which the polynomial falls count.
 * \param[in] a five coefficients, those above the degree 0 \return 1 if there is one, else 0. */
inline float
isolatedRoot(int degree, const double* a, double low, double high, double aim, bool front_only,
             float& root)
{
  if (!(low <= high)) return 0.0f;
  Roots roots;
  if (degree == 3)
    rootsInInterval<3>(a, low, high, roots);
  else
    rootsInInterval<4>(a, low, high, roots);
  double best = HUGE_VAL;
  for (int i = 0; i < roots.count; ++i) {
    if (front_only && !(evaluateDerivative<4>(a, roots.at[i]) < 0.0)) continue;
    const double distance = std::abs(roots.at[i] - aim);
    if (!(distance < best)) continue;
    best = distance;
    root = static_cast<float>(roots.at[i]);
  }
  return best < HUGE_VAL ? 1.0f : 0.0f;
}

}  // namespace pcl_slim::detail

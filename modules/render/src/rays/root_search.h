// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "pcl_slim/query/detail/polynomial_roots.h"

namespace pcl_slim::detail {

/** \brief The smallest root that counts from low_front on at which the polynomial falls, or from
 * low_behind on at which it rises, up to high; infinity if there is none.
 * \param[in] a five coefficients, those above the degree 0 \param[in] counts bool(root) */
template <typename Counts>
double
firstOfRoots(int degree, const double* a, double low_front, double low_behind, double high,
             const Counts& counts)
{
  Roots roots;
  const double low = low_front < low_behind ? low_front : low_behind;
  if (degree == 3)
    rootsInInterval<3>(a, low, high, roots);
  else
    rootsInInterval<4>(a, low, high, roots);
  for (int i = 0; i < roots.count; ++i) {
    const bool falls = evaluateDerivative<4>(a, roots.at[i]) < 0.0;
    if (roots.at[i] >= (falls ? low_front : low_behind) && counts(roots.at[i])) return roots.at[i];
  }
  return HUGE_VAL;
}

}  // namespace pcl_slim::detail

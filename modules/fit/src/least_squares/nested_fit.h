// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "scan/local_fit.h"

namespace pcl_slim::detail {

/** \brief The fit of a lower degree to the same points with the same weights.
 *
 * No point is looked at: its normal equations are part of the higher degree's, whose moments and
 * solution are at hand, and the least residual grows by the mean square of the two fits'
 * difference. For heights alone: slopes as data have moments of their own, which are not kept.
 * \param[in] degree below fit.degree. \return a fit of degree 0 where it cannot be solved. O(P^3).
 */
LocalFit
nestedFit(const LocalFit& fit, int degree);

}  // namespace pcl_slim::detail

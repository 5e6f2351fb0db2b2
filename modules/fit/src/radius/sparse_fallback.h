// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Guards", Thin data: a ball whose points do not carry the full degree at r_r.
#pragma once

#include "radius/residual_tests.h"
#include "radius/rule/radius_rule.h"

namespace pcl_slim::detail {

/** \brief The best that degree and radius up to the gather radius allow a sparse ball.
 *
 * \return a support-limited leaf; or a sparse ball where no plane can be fitted, or where the few
 * points are scattered about the fit rather than on it. */
RadiusChoice
fallBackWhereSparse(TrialFits& trials, const ResidualTests& tests);

}  // namespace pcl_slim::detail

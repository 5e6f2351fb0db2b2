// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fit_settings.h"
#include "pcl_slim/core/progress.h"

namespace pcl_slim::detail {

/** \brief Solves for the penalty that meets FitParams::target_error or max_surfels.
 *
 * The error a user allows is treated as if it were noise: covers are run while the variance
 * settings.energy.lambda is moved by secant steps in log-log until the RMS residual meets the
 * target within 3 %, or the leaves number at most max_surfels (and, where reachable, 95 % of it).
 * \return an error where no penalty reaches the goal, naming what is reachable.
 */
Error
solvePenalty(const PointStore& store, const FitParams& params, FitSettings& settings, int threads,
             Progress* progress);

}  // namespace pcl_slim::detail

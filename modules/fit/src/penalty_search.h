// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fit_settings.h"
#include "pcl_slim/core/progress.h"

namespace pcl_slim::detail {

/** \brief Multiplies the noise variance settings.energy.lambda by FitParams::noise_factor, or by the factor
 * that meets FitParams::target_error or max_surfels; without any of these it stays.
 *
 * The error a user allows is treated as if it were noise: covers are run while the factor is moved by secant
 * steps in log-log until the RMS residual meets the target within 3 %, or the leaves number at most
 * max_surfels (and, where reachable, 95 % of it). Factors have six decimal digits, so that one which is
 * printed gives the same fit. \param[out] factor the one used; 0: none
 * \return an error where no factor reaches the goal, naming what is reachable.
 */
Error
applyNoiseFactor(const PointStore& store, const FitParams& params, FitSettings& settings,
                 int threads, Progress* progress, double& factor);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fit_settings.h"
#include "pcl_slim/core/progress.h"

namespace pcl_slim {

/** \brief Solves for the penalty that meets FitParams::target_error or max_surfels.
 *
 * max_surfels: bisects log kappa (or T) over whole covers until at most so many leaves remain.
 * target_error: bisects over a sample of balls. Changes settings.energy. \return an error where
 * no penalty reaches the goal, naming what is reachable.
 */
Error
solvePenalty(const PointStore& store, const FitParams& params, FitSettings& settings, int threads,
             Progress* progress);

}  // namespace pcl_slim

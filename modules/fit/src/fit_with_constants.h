// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fit_constants.h"
#include "pcl_slim/fit/fit.h"

namespace pcl_slim::detail {

/** \brief fitSurface() with other tuning constants than the library's: for measuring what each is
 * worth. */
Error
fitWithConstants(const FitConstants& constants, const PointStore& store, const FitParams& params,
                 SLIMSurface& surface, FitStatistics* statistics = nullptr,
                 Progress* progress = nullptr);

/** \brief The same of a store that keeps the sides found. */
Error
fitWithConstants(const FitConstants& constants, PointStore& store, const FitParams& params,
                 SLIMSurface& surface, FitStatistics* statistics = nullptr,
                 Progress* progress = nullptr);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cover/level_cover.h"
#include "pcl_slim/fit/fit.h"

namespace pcl_slim::detail {

/** \brief Counts what a finished fit holds: points, surfels, and what its cover did. The times and
 * what was measured of the cloud are the fit's own to write. O(points + surfels). */
void
countFit(const PointStore& store, const LevelCover& cover, const SLIMSurface& surface,
         FitStatistics& stats);

/** \brief Why a fit has no leaf, and what helps; no error where it has some. */
Error
checkLeaves(const PointStore& store, const FitStatistics& stats);

}  // namespace pcl_slim::detail

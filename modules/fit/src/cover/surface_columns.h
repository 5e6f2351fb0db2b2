// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cover/level_cover.h"

namespace pcl_slim::detail {

/** \brief Writes a finished cover's surfels into a surface's columns, and how it was made into its
 * info; links are still to be built. O(surfels). */
void
fillSurface(const PointStore& store, const FitSettings& settings, const LevelCover& cover,
            int threads, SLIMSurface& surface);

}  // namespace pcl_slim::detail

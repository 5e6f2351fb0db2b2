// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/cloud/store_frame.h"
#include "pcl_slim/fit/tile_fit.h"

namespace pcl_slim::detail {

/** \brief The coarsest level of which a tile's median ball has at most so many of the tile's points, but
 * no finer one than balls of 32 sqrt(lambda), which average noise well.
 *
 * Counts 31 balls on some 65,000 of the points, chosen by their places: the points' order changes
 * nothing. \param[out] gathered by level, the most points that one of these balls reaches. O(points). */
int
firstLevel(const CloudView& core, const StoreFrame& frame, const LevelRadii& radii,
           std::uint64_t most_points, double lambda, std::vector<std::uint64_t>& gathered);

/** \brief Whether balls of a level are wide enough to begin with where memory asks for narrow ones: those
 * of less than 16 sqrt(lambda) do not average noise. */
bool
isFirstLevel(const LevelRadii& radii, int level, double lambda);

}  // namespace pcl_slim::detail

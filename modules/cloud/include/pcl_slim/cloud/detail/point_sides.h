// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "pcl_slim/cloud/detail/side_constants.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim::detail {

/** \brief Gives points near others that face the other way a side and a normal of their own. A cell gives all of
 * its points one normal, and one side or two at a plane between two sheets; where sheets meet, as at the edge of
 * a blade, many cells have the wrong side, and cells with a bit of another sheet any normal. Points on the
 * sheet of those of their nearest points that face the other way turn, round by round until none is left: sides
 * spread from the cells that have the right one. Then points have the normals of planes of least squares of
 * their neighbours on the sheet. O(n k); same result for any number of threads.
 * \param[in] on_rods stored points whose normals stay, as Sides::on_rods; empty: none
 * \param[in,out] normals of the stored points; 0: no side, left out */
PCL_SLIM_EXPORT void
settleSides(const PointStore& store, const std::vector<char>& on_rods,
            const SideConstants& constants, int threads,
            std::vector<std::array<float, 3>>& normals);

}  // namespace pcl_slim::detail

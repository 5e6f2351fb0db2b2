// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fit_settings.h"
#include "pcl_slim/cloud/point_store.h"

namespace pcl_slim::detail {

/** \brief Gives the surfels that data do not fill their trim maps (docs/theory.md, "Borders").
 *
 * Every surfel's ball is gathered once more, and searched for gaps; those that may have one are
 * measured. Internal surfels, which level of detail draws small, get coarse maps. Surfels in
 * parallel; the same bytes for any number of threads.
 * \param[in] hole_size diameter of the smallest hole kept, in spacings of a surfel's points
 * \param[in,out] stats its threads are used, trim_candidates counted
 */
void
makeTrimMaps(const PointStore& store, const FitSettings& settings, double hole_size,
             FitStatistics& stats, SLIMSurface& surface);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/fit/tile_fit.h"
#include "pcl_slim/stream/ranks.h"
#include "tiles/tile_loader.h"

namespace pcl_slim::detail {

/** \brief Measures the traits of a cloud on disk.
 *
 * The sample is 32 windows of 32,768 points, each of whole cells that follow each other along the Morton
 * curve: at full density, so that patches of neighbours are the cloud's own. Where noise fills the
 * widest patch that a window has room for, windows of 4, 16, ... times as many points take their
 * place, of which every 4th, 16th, ... is kept; in the end they are the whole cloud. Clouds of about
 * as few points as the windows have are taken whole. A function of the points' set alone. Rank 0 has the
 * statistics, all have the traits.
 */
Result<MeasuredTraits>
measureSampledTraits(const TileLoader& loader, const StoreFrame& frame, const FitParams& params,
                     Ranks& ranks, std::uint64_t& thinning);

}  // namespace pcl_slim::detail

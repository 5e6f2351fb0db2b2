// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/fit/tile_fit.h"
#include "pcl_slim/stream/tile_plan.h"
#include "ranks/fitted_tiles.h"
#include "scratch/tile_store.h"

namespace pcl_slim::detail {

/** \brief The results of prepare() that fits of tiles need in addition to the points. */
struct KeptPlan {
  StoreFrame frame;
  PointRecord record;
  CloudTraits traits;
  FitStatistics noise;  ///< what was measured, without times
  PointStoreStatistics points;
  std::uint64_t thinning = 1;
  TilePlan plan;  ///< tiles are made again from the cells
  std::vector<int> first_levels;
  std::vector<std::uint64_t> halos, balls;
};

/** \brief Writes a plan into a folder. \param[in] identity of source and parameters */
Error
savePlan(const std::string& folder, const std::string& identity, const KeptPlan& plan);

/** \brief Reads a plan. \return whether the folder has one of this identity that is whole; an error is not
 * returned: the plan is made again then. */
bool
loadPlan(const std::string& folder, const std::string& identity, KeptPlan& plan);

/** \brief Keeps the surfels of a tile in a folder. */
Error
saveTile(const std::string& folder, const std::string& identity, std::size_t tile,
         const FittedTile& made);

/** \brief Reads a tile that was kept under the same identity. \return whether there is one that is whole */
bool
loadTile(const std::string& folder, const std::string& identity, std::size_t tile,
         FittedTile& made);

}  // namespace pcl_slim::detail

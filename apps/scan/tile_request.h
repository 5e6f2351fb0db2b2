// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "common/options.h"
#include "common/progress_bar.h"
#include "common/report.h"
#include "pcl_slim/filters/io/record_layout.h"
#include "pcl_slim/stream/stream_fit.h"
#include "scan/fit_job.h"

namespace pcl_slim {

/** \brief How a program fits a scan by tiles, and whether it does. */
struct TileRequest {
  std::uint64_t points = StreamParams().tile_points;  ///< of a tile; 0: never by tiles
  bool asked = false;                                 ///< the user gave the tile's points
  std::string scratch;
  std::uint64_t max_memory = 0;  ///< megabytes; 0: no limit
};

/** \brief Adds -tile_points and -scratch. The job must outlive the table's parse(). */
void
declareTileOptions(OptionTable& options, TileRequest& tiles);

/** \brief Whether a scan of so many points is worked on in parts without being asked: it has more than
 * two tiles' points, or does not fit into memory. */
bool
wantsTiles(std::uint64_t points, const TileRequest& tiles);

/** \brief Opens a scan for a fit by tiles.
 *
 * Tiles are used where the user asks for them, where the scan has no header to load it by, where it has
 * more than two tiles' points, and where a fit in memory would exceed the limit.
 * \param[out] source the scan, or null: it is to be fitted in memory.
 * \return an error where the user asks for what tiles cannot do, or the limit is too low for them. */
Error
openForTiles(const std::string& path, const FitJob& job, const TileRequest& tiles, Console& console,
             std::unique_ptr<PointSource>& source);

/** \brief Fits by tiles; says and reports what was done and what was skipped. */
Error
fitByTiles(PointSource& source, const FitJob& job, const TileRequest& tiles, Console& console,
           Report& report, SLIMSurface& surface);

}  // namespace pcl_slim

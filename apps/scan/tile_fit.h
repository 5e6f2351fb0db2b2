// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/options.h"
#include "common/program.h"
#include "pcl_slim/filters/io/record_layout.h"
#include "pcl_slim/stream/stream_fit.h"
#include "pcl_slim/surface/slim_blocks.h"
#include "scan/fit_job.h"

namespace pcl_slim {

/** \brief How a program fits a scan by tiles, and whether it does. */
struct TileRequest {
  std::uint64_t points = StreamParams().tile_points;  ///< of a tile; 0: never by tiles
  bool asked = false;                                 ///< the user gave the tile's points
  bool painted = false;       ///< another cloud's colours are to be painted on the surface
  std::string scratch, plan;  ///< folders; plan: of a fit that can be continued, or none
  std::string range;          ///< "A:B": fit these tiles only
  std::string source_name;    ///< the scan's path, size and date: set by openForTiles()
  Ranks* ranks = nullptr;     ///< of a job, which fits by tiles always; null: one process
};

/** \brief What a fit by tiles makes. */
struct TiledSurface {
  SLIMSurface
      surface;  ///< all surfels; none where they were written, or some tiles were fitted only
  std::vector<std::size_t>
      begins;            ///< first surfel of the levels above the tiles', and of each tile
  bool partial = false;  ///< only some tiles were to be fitted, or another rank has the surface
};

/** \brief Adds -plan and -tiles, for programs whose fit may be divided. */
void declarePlanOptions(OptionTable& options, TileRequest& tiles);

/** \brief Adds -tile_points and -scratch. The job must outlive the table's parse(). */
void declareTileOptions(OptionTable& options, TileRequest& tiles);

/** \brief Whether a scan of this many points is fitted by tiles by default: it has more than
 * two tiles' points, or does not fit into memory. */
bool wantsTiles(std::uint64_t points, const TileRequest& tiles);

/** \brief Opens a scan for a fit by tiles.
 *
 * Tiles are used where the user requests them, where the scan has no header to load it by, where it
 * has more than two tiles' points, and where a fit in memory would exceed the limit.
 * \param[out] source the scan, of several ranks this one's share of it, or null: it is to be fitted
 * in memory.
 * \return an error where the user requests what tiles cannot do, or the limit is too low for them.
 */
Error openForTiles(const std::string& path, const FitJob& job, TileRequest& tiles, Console& console,
                   std::unique_ptr<PointSource>& source);

/** \brief Fits by tiles; prints and reports what was done and what was skipped.
 * \param[in,out] writer takes the surfels, tile by tile, as far as they can be written before all
 * are known; null: all are kept in made. */
Error fitByTiles(PointSource& source, const FitJob& job, const TileRequest& tiles, Console& console,
                 Report& report, SlimBlockWriter* writer, TiledSurface& made);

/** \brief The end of work that reads its scan while it goes on: of one that cannot be read, or cannot
 * be fitted by tiles, the end is as of one that could not be loaded. */
Exit exitOfTiles(const Error& error);

/** \brief Removes what -plan keeps from its folder, once the surface is written. */
void removePlan(const std::string& folder);

}  // namespace pcl_slim

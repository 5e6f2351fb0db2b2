// SPDX-License-Identifier: BSD-3-Clause
#include "scan/tile_request.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "common/run_program.h"
#include "scan/fit_report.h"

namespace pcl_slim {

namespace {

constexpr std::uint64_t kMostTile = 1000000000;
constexpr std::uint64_t kTilesOfCloud = 2;  ///< a cloud of more tiles' points is fitted by them
constexpr double kBytesInMemory = 60;       ///< a point, that a fit in memory takes at least
constexpr double kBytesByTiles = 55;        ///< a point of the largest tile, likewise

/** What about a job cannot be done by tiles. */
Error
checkJob(const FitJob& job, const TileRequest& tiles)
{
  if (job.normal_neighbours > 0) {
    return {ErrorCode::kBadArgument,
            "-estimate_normals is not possible by tiles: leave it, or give -tile_points 0"};
  }
  if (!job.trajectory.empty()) {
    return {ErrorCode::kBadArgument,
            "-trajectory is not possible by tiles: give one -viewpoint, or -tile_points 0"};
  }
  if (!job.frames.empty() || !job.frame_field.empty()) {
    const std::string option = job.frames.empty() ? "-frame_field" : "-frames";
    return {ErrorCode::kBadArgument,
            option + " is not possible by tiles: leave it, or give -tile_points 0"};
  }
  return streamParams(job, tiles).validate();
}

/** What identifies a file and its state: a changed file differs in it. */
std::string
nameOf(const std::string& path)
{
  namespace fs = std::filesystem;
  std::error_code code;
  return fs::absolute(path, code).string() + " " + std::to_string(fs::file_size(path, code)) + " " +
         std::to_string(fs::last_write_time(path, code).time_since_epoch().count());
}

bool
fitsInMemory(std::uint64_t points, const TileRequest& tiles)
{
  const double bytes = kBytesInMemory * static_cast<double>(points);
  return tiles.max_memory == 0 || bytes <= 0x1p20 * static_cast<double>(tiles.max_memory);
}

}  // namespace

StreamParams
streamParams(const FitJob& job, const TileRequest& tiles)
{
  StreamParams params;
  params.fit = job.params;
  params.tile_points = tiles.points;
  params.scratch = tiles.scratch;
  params.state = tiles.plan;
  params.ranks = tiles.ranks;
  return params;
}

bool
wantsTiles(std::uint64_t points, const TileRequest& tiles)
{
  return points > kTilesOfCloud * tiles.points || !fitsInMemory(points, tiles);
}

void
declarePlanOptions(OptionTable& options, TileRequest& tiles)
{
  options.text("plan", &tiles.plan, "DIR",
               "folder that keeps points and tiles until the surface is made: the same command "
               "continues from them");
  options.text(
      "tiles", &tiles.range, "A:B|K/N",
      "with -plan: fit tiles A to before B only, or the K-th of N shares from 0 on, and keep "
      "them; OUT is not written");
}

void
declareTileOptions(OptionTable& options, TileRequest& tiles)
{
  options.integer("tile_points", &tiles.points, 0, kMostTile,
                  "points of a tile: scans of more than two tiles, and those that do not fit into "
                  "memory, are fitted tile by tile; if given, all are; 0: none");
  options.text("scratch", &tiles.scratch, "DIR", "folder for the points while tiles are fitted");
}

Error
openForTiles(const std::string& path, const FitJob& job, TileRequest& tiles, Console& console,
             std::unique_ptr<PointSource>& source)
{
  source.reset();
  const bool raw = isRawPointFile(path);
  if (tiles.points == 0 && !raw && tiles.ranks == nullptr) return {};
  if (tiles.plan.empty() && !tiles.range.empty())
    return {ErrorCode::kBadArgument, "-tiles needs -plan: name the folder that keeps them"};
  const Error impossible = checkJob(job, tiles);
  const bool needed = tiles.asked || raw || !tiles.plan.empty() || tiles.ranks != nullptr;
  if (impossible) return needed ? impossible : Error();
  Result<RecordLayout> layout = recordLayoutOf(path, job.use_normals);
  // Loading the scan reports any other defect than a form that cannot be streamed.
  if (!layout) return needed ? layout.error() : Error();
  const bool fits = fitsInMemory(layout->count, tiles);
  if (layout->has_sensors && !layout->normal && job.viewpoint.empty()) {
    const Error own{ErrorCode::kBadArgument,
                    "the sensors of single points (vp_x vp_y vp_z) are not used by tiles: give one "
                    "-viewpoint, or -tile_points 0"};
    return needed || !fits ? own : Error();
  }
  if (!needed && !wantsTiles(layout->count, tiles)) return {};
  const auto points = static_cast<double>(std::min(layout->count, tiles.points));
  if (Error error =
          checkMemory(kBytesByTiles * points,
                      "fitting tiles of " + std::to_string(tiles.points) + " points", kTileRelief))
    return error;
  if (!needed) {
    console.note(std::string("  the scan ") +
                 (fits ? "has more points than two tiles" : "does not fit into memory") +
                 ": it is fitted by tiles");
  }
  if (job.color && layout->colors) console.note("  a fit by tiles leaves the scan's colours out");
  tiles.source_name = nameOf(path);
  const Ranks* ranks = tiles.ranks;
  source = std::make_unique<RecordSource>(
      std::move(*layout), static_cast<std::uint64_t>(ranks != nullptr ? ranks->rank() : 0),
      static_cast<std::uint64_t>(ranks != nullptr ? ranks->size() : 1));
  return {};
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "scan/tile_request.h"

#include <algorithm>
#include <utility>

#include "common/memory_limit.h"
#include "scan/fit_report.h"

namespace pcl_slim {

namespace {

constexpr std::uint64_t kMostTile = 1000000000;
constexpr std::uint64_t kTilesOfCloud = 2;  ///< a cloud of more tiles' points is fitted by them
constexpr double kBytesInMemory = 60;       ///< a point, that a fit in memory takes at least
constexpr double kBytesByTiles = 55;        ///< a point of the largest tile, likewise
constexpr const char* kTileRelief = "give fewer -tile_points";

StreamParams
streamParams(const FitJob& job, const TileRequest& tiles)
{
  StreamParams params;
  params.fit = job.params;
  params.tile_points = tiles.points;
  params.scratch = tiles.scratch;
  return params;
}

/** What about a job cannot be done by tiles. */
Error
checkJob(const FitJob& job, const TileRequest& tiles)
{
  if (job.normal_neighbours > 0) {
    return {ErrorCode::kBadArgument,
            "-estimate_normals is not possible by tiles: leave it, or give -tile_points 0"};
  }
  return streamParams(job, tiles).validate();
}

bool
fitsInMemory(std::uint64_t points, const TileRequest& tiles)
{
  const double bytes = kBytesInMemory * static_cast<double>(points);
  return tiles.max_memory == 0 || bytes <= 0x1p20 * static_cast<double>(tiles.max_memory);
}

void
reportTiles(const StreamStatistics& statistics, const StreamFit& fit, Report& report)
{
  std::uint64_t most = 0;
  for (std::size_t t = 0; t < fit.plan().tiles.size(); ++t)
    most = std::max(most, fit.loadedPoints(t));
  report.json()["tiles"] = {{"count", statistics.tiles},
                            {"halo_points", statistics.halo_points},
                            {"most_points", most},
                            {"noise_thinning", statistics.noise_thinning},
                            {"passes", statistics.passes},
                            {"scratch_read", statistics.scratch_read},
                            {"scratch_written", statistics.scratch_written}};
  report.time("measure", statistics.seconds_measure);
  report.time("sort", statistics.seconds_sort);
  report.time("plan", statistics.seconds_plan);
  report.time("load_tiles", statistics.seconds_load);
}

/** Fits all tiles into one surface without links. */
Error
fitAll(StreamFit& fit, Console& console, SLIMSurface& surface)
{
  for (std::size_t t = 0; t < fit.plan().tiles.size(); ++t) {
    SLIMSurface tile;
    if (Error error = fit.fit(t, tile, &console.progress())) return error;
    surface.append(tile);
  }
  return {};
}

}  // namespace

bool
wantsTiles(std::uint64_t points, const TileRequest& tiles)
{
  return points > kTilesOfCloud * tiles.points || !fitsInMemory(points, tiles);
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
openForTiles(const std::string& path, const FitJob& job, const TileRequest& tiles, Console& console,
             std::unique_ptr<PointSource>& source)
{
  source.reset();
  const bool raw = isRawPointFile(path);
  if (tiles.points == 0 && !raw) return {};
  const Error impossible = checkJob(job, tiles);
  const bool needed = tiles.asked || raw;
  if (impossible) return needed ? impossible : Error();
  Result<RecordLayout> layout = recordLayoutOf(path, job.use_normals);
  // Other defects than a form that cannot be streamed are told by who loads the scan.
  if (!layout) return needed ? layout.error() : Error();
  const bool fits = fitsInMemory(layout->count, tiles);
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
  source = std::make_unique<RecordSource>(std::move(*layout));
  return {};
}

Error
fitByTiles(PointSource& source, const FitJob& job, const TileRequest& tiles, Console& console,
           Report& report, SLIMSurface& surface)
{
  Stopwatch watch;
  report.json()["points"] = source.size();
  report.json()["normals"] = source.hasNormals() ? "fields" : "none";
  console.begin("Fitting by tiles");
  StreamFit fit(streamParams(job, tiles));
  Error error = fit.prepare(source, &console.progress());
  if (!error) {
    error =
        checkMemory(static_cast<double>(fit.workingBytes()),
                    "fitting tiles of " + std::to_string(tiles.points) + " points", kTileRelief);
  }
  if (!error) error = fitAll(fit, console, surface);
  if (error) {
    console.failed();
    return error;
  }
  Stopwatch links;
  surface.buildLinks(job.params.threads);
  if (!fit.frame().with_normals && job.params.orient)
    orientSurfels(fit.frame(), job.params, surface);
  const StreamStatistics& statistics = fit.statistics();
  FittedPoints fitted;
  fitted.stored = statistics.fit.points;
  fitted.diagonal = fit.frame().diagonal * fit.frame().scale;
  fitted.store_bytes = fit.workingBytes();
  fitted.statistics = statistics.points;
  report.time("fit", watch.seconds());
  reportFit(fitted, surface, statistics.fit, report);
  reportTiles(statistics, fit, report);
  report.time("links", links.seconds());
  console.done(watch.seconds(), std::to_string(statistics.fit.leaves) + " leaves, " +
                                    counted(statistics.tiles, "tile"));
  const std::string skipped = skippedText(statistics.points);
  if (!skipped.empty()) console.note("  " + skipped);
  console.note("  " + noiseText(fitted.diagonal, statistics.fit));
  for (const std::string& note : coverNotes(statistics.fit)) console.note(note);
  if (statistics.fit.leaves > 0) return {};
  return {
      ErrorCode::kNoSurface,
      "the points lie along lines or scattered, nowhere along a surface: give more points beside "
      "them"};
}

}  // namespace pcl_slim

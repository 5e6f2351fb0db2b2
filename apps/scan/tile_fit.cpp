// SPDX-License-Identifier: BSD-3-Clause
// A fit by tiles as a program does it: what is said, reported and kept.
#include <algorithm>
#include <charconv>
#include <filesystem>
#include <utility>

#include "common/memory_limit.h"
#include "scan/fit_report.h"
#include "scan/tile_request.h"

namespace pcl_slim {

namespace {

namespace fs = std::filesystem;

void
reportTiles(const StreamStatistics& statistics, const StreamFit& fit, Report& report)
{
  std::uint64_t most = 0;
  for (std::size_t t = 0; t < fit.plan().tiles.size(); ++t)
    most = std::max(most, fit.loadedPoints(t));
  report.json()["tiles"] = {{"count", statistics.tiles},
                            {"kept", statistics.kept_tiles},
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

/** Which tiles are to be fitted: [first, second). */
Result<std::pair<std::size_t, std::size_t>>
rangeOf(const std::string& text, std::size_t tiles)
{
  if (text.empty()) return std::pair<std::size_t, std::size_t>{0, tiles};
  std::size_t begin = 0, end = 0;
  const char *at = text.data(), *last = at + text.size();
  const auto first = std::from_chars(at, last, begin);
  const bool colon = first.ec == std::errc() && first.ptr != last && *first.ptr == ':';
  const auto second = colon ? std::from_chars(first.ptr + 1, last, end) : first;
  if (colon && second.ec == std::errc() && second.ptr == last && begin <= end && end <= tiles)
    return std::pair<std::size_t, std::size_t>{begin, end};
  return Error{ErrorCode::kBadArgument, "-tiles '" + text + "' is no range A:B of the " +
                                            std::to_string(tiles) +
                                            " tiles, 0:" + std::to_string(tiles)};
}

/** One run of a program over some or all tiles. */
class TileRun {
 public:
  TileRun(const FitJob& job, const TileRequest& tiles, Console& console, SlimBlockWriter* writer,
          TiledSurface& made)
      : job_(job), tiles_(tiles), console_(console), writer_(writer), made_(made)
  {
  }

  Error run(PointSource& source, StreamFit& fit)
  {
    if (Error error = fit.prepare(source, &console_.progress())) return error;
    const double bytes = static_cast<double>(fit.workingBytes());
    const std::string what = "fitting tiles of " + std::to_string(tiles_.points) + " points";
    if (Error error = checkMemory(bytes, what, kTileRelief)) return error;
    const auto range = rangeOf(tiles_.range, fit.plan().tiles.size());
    if (!range) return range.error();
    made_.partial = range->second - range->first < fit.plan().tiles.size();
    const bool oriented = fit.frame().with_normals || !job_.params.orient;
    const bool faces = job_.params.has_viewpoint || fit.frame().sensor;
    writes_ = writer_ != nullptr && !made_.partial && (oriented || faces);
    for (std::size_t t = range->first; t < range->second; ++t) {
      if (Error error = fitOne(fit, t)) return error;
    }
    return made_.partial ? Error() : finish(fit);
  }

  std::uint64_t written() const { return writes_ ? writer_->surfels() : made_.surface.size(); }

 private:
  Error fitOne(StreamFit& fit, std::size_t t)
  {
    SLIMSurface tile;
    if (Error error = fit.fit(t, tile, &console_.progress())) return error;
    if (made_.partial) return {};
    if (writes_) {
      turn(fit, tile);
      return add(fit, t, tile);
    }
    made_.begins.push_back(made_.surface.size());
    made_.surface.append(tile);
    return {};
  }

  /** Gives surfels a common side, which needs links. */
  void turn(const StreamFit& fit, SLIMSurface& surface) const
  {
    surface.buildLinks(job_.params.threads);
    if (!fit.frame().with_normals && job_.params.orient)
      orientSurfels(fit.frame(), job_.params, surface);
  }

  Error add(const StreamFit& fit, std::size_t t, const SLIMSurface& tile)
  {
    const TilePlan::Tile& own = fit.plan().tiles[t];
    return writer_->add(tile, own.first_key, own.end_key);
  }

  /** Joins what could not be written tile by tile. */
  Error finish(const StreamFit& fit)
  {
    if (writes_) return {};
    turn(fit, made_.surface);
    if (writer_ == nullptr) return {};
    made_.begins.push_back(made_.surface.size());
    for (std::size_t t = 0; t + 1 < made_.begins.size(); ++t) {
      const SLIMSurface tile = made_.surface.slice(made_.begins[t], made_.begins[t + 1]);
      if (Error error = add(fit, t, tile)) return error;
    }
    return {};
  }

  const FitJob& job_;
  const TileRequest& tiles_;
  Console& console_;
  SlimBlockWriter* writer_;
  TiledSurface& made_;
  bool writes_ = false;  ///< tiles are written as they come
};

FittedPoints
pointsOf(const StreamFit& fit)
{
  const StreamStatistics& statistics = fit.statistics();
  FittedPoints fitted;
  fitted.stored = statistics.fit.points;
  fitted.diagonal = fit.frame().diagonal * fit.frame().scale;
  fitted.store_bytes = fit.workingBytes();
  fitted.statistics = statistics.points;
  return fitted;
}

/** Says what became of all tiles. */
void
tell(const StreamFit& fit, Console& console)
{
  const StreamStatistics& statistics = fit.statistics();
  const std::string skipped = skippedText(statistics.points);
  if (!skipped.empty()) console.note("  " + skipped);
  console.note("  " + noiseText(pointsOf(fit).diagonal, statistics.fit));
  for (const std::string& note : coverNotes(statistics.fit)) console.note(note);
}

}  // namespace

Error
fitByTiles(PointSource& source, const FitJob& job, const TileRequest& tiles, Console& console,
           Report& report, SlimBlockWriter* writer, TiledSurface& made)
{
  const Stopwatch watch;
  report.json()["points"] = source.size();
  report.json()["normals"] = source.hasNormals() ? "fields" : "none";
  console.begin("Fitting by tiles");
  StreamParams params = streamParams(job, tiles);
  params.source_name = tiles.source_name;
  StreamFit fit(std::move(params));
  TileRun run(job, tiles, console, writer, made);
  if (Error error = run.run(source, fit)) {
    console.failed();
    return error;
  }
  const StreamStatistics& statistics = fit.statistics();
  report.time("fit", watch.seconds());
  reportFit(pointsOf(fit), made.surface, statistics.fit, report);
  const auto& levels = statistics.fit.leaves_per_level;
  report.json()["surfels"] = run.written();
  report.json()["levels"] =
      std::count_if(levels.begin(), levels.end(), [](auto n) { return n > 0; });
  reportTiles(statistics, fit, report);
  console.done(watch.seconds(), std::to_string(statistics.fit.leaves) + " leaves, " +
                                    counted(statistics.tiles, "tile"));
  if (made.partial) {
    console.note("  of the " + counted(statistics.tiles, "tile") + " " + tiles.range +
                 " are fitted and kept in '" + tiles.plan + "'");
    return {};
  }
  tell(fit, console);
  if (statistics.fit.leaves > 0) return {};
  return {
      ErrorCode::kNoSurface,
      "the points lie along lines or scattered, nowhere along a surface: give more points beside "
      "them"};
}

Error
fitByTiles(PointSource& source, const FitJob& job, const TileRequest& tiles, Console& console,
           Report& report, SLIMSurface& surface)
{
  TiledSurface made;
  const Error error = fitByTiles(source, job, tiles, console, report, nullptr, made);
  surface = std::move(made.surface);
  return error;
}

void
removePlan(const std::string& folder)
{
  std::error_code code;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, code)) {
    const std::string name = entry.path().filename().string();
    const bool ours = name == "plan" || name == "points" || name.rfind("tile-", 0) == 0;
    if (ours) fs::remove(entry.path(), code);
  }
}

}  // namespace pcl_slim

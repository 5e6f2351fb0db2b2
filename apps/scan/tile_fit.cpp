// SPDX-License-Identifier: BSD-3-Clause
// A fit by tiles as a program does it: whether a scan is fitted so, what is printed, reported and
// kept.
#include "scan/tile_fit.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <utility>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/filters/io/point_file_pieces.h"
#include "pcl_slim/filters/io/point_units.h"

namespace pcl_slim {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostTile = 1000000000;
constexpr std::uint64_t kTilesOfCloud = 2;  ///< a cloud of more tiles' points is fitted by them
constexpr double kBytesInMemory = 60;       ///< a point, that a fit in memory takes at least
constexpr double kBytesByTiles = 55;        ///< a point of the largest tile, likewise

/** What helps where memory is too small for a tile. */
constexpr const char* kTileRelief = "give fewer -tile_points or -threads";

StreamParams streamParams(const FitJob& job, const TileRequest& tiles) {
  StreamParams params;
  params.fit = job.params;
  params.tile_points = tiles.points;
  params.scratch = tiles.scratch;
  params.state = tiles.plan;
  params.ranks = tiles.ranks;
  return params;
}

/** What about a job cannot be done by tiles. */
Error checkJob(const FitJob& job, const TileRequest& tiles) {
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
  if (tiles.painted) {
    return {ErrorCode::kBadArgument,
            "-colors is not possible by tiles: leave it, or give -tile_points 0"};
  }
  return streamParams(job, tiles).validate();
}

/** What identifies a file and its state: a changed file differs in it. */
std::string nameOf(const std::string& path) {
  std::error_code code;
  return fs::absolute(path, code).string() + " " + std::to_string(fs::file_size(path, code)) + " " +
         std::to_string(fs::last_write_time(path, code).time_since_epoch().count());
}

/** Whether the first points of a scan are lengths, and its columns unnamed. A form that cannot be read in
 * pieces is checked where it is loaded. */
Error checkBegin(const std::string& path, const InputOptions& input) {
  constexpr std::size_t kMostPoints = 20000;
  if (!input.file.columns.empty()) {
    return {ErrorCode::kBadArgument, "'" + path + "' says what its values are; leave -columns out"};
  }
  PointFileReader reader;
  PointFile piece;
  if (input.units == "length" || reader.open(path) || reader.next(kMostPoints, piece)) return {};
  return checkLengths(piece, path);
}

bool fitsInMemory(std::uint64_t points) {
  return isWithinMemoryLimit(kBytesInMemory * static_cast<double>(points));
}

}  // namespace

bool wantsTiles(std::uint64_t points, const TileRequest& tiles) {
  return points > kTilesOfCloud * tiles.points || !fitsInMemory(points);
}

void declarePlanOptions(OptionTable& options, TileRequest& tiles) {
  options.text("plan", &tiles.plan, "DIR",
               "folder that keeps points and tiles until the surface is made: the same command "
               "continues from them",
               FileUse::kKept);
  options.text(
      "tiles", &tiles.range, "A:B|K/N",
      "with -plan: fit tiles A to before B only, or the K-th of N shares from 0 on, and keep "
      "them; OUT is not written");
}

void declareTileOptions(OptionTable& options, TileRequest& tiles) {
  options.integer("tile_points", &tiles.points, 0, kMostTile,
                  "points of a tile: scans of more than two tiles, and those that do not fit into "
                  "memory, are fitted tile by tile; if given, all are; 0: none");
  options.text("scratch", &tiles.scratch, "DIR", "folder for the points while tiles are fitted",
               FileUse::kScratch);
}

Error openForTiles(const std::string& path, const FitJob& job, TileRequest& tiles, Console& console,
                   std::unique_ptr<PointSource>& source) {
  source.reset();
  const bool raw = isRawPointFile(path);
  if (tiles.points == 0 && !raw && tiles.ranks == nullptr) return {};
  if (tiles.plan.empty() && !tiles.range.empty())
    return {ErrorCode::kBadArgument, "-tiles needs -plan: name the folder that keeps them"};
  const Error impossible = checkJob(job, tiles);
  const bool needed = tiles.asked || raw || !tiles.plan.empty() || tiles.ranks != nullptr;
  if (impossible) return needed ? impossible : Error();
  if (isStream(path)) {
    if (!needed) return {};
    return {ErrorCode::kBadArgument, "'" + path +
                                         "' is a pipe, which can be read once only, and tiles are "
                                         "read from several times: write it to a file"};
  }
  Result<RecordLayout> layout = recordLayoutOf(path, job.use_normals);
  // Loading the scan reports any other defect than a form that cannot be streamed.
  if (!layout) return needed ? layout.error() : Error();
  const bool fits = fitsInMemory(layout->count);
  if (layout->has_sensors && !layout->normal && !job.params.viewpoint) {
    const Error own{ErrorCode::kBadArgument,
                    "the sensors of single points (vp_x vp_y vp_z) are not used by tiles: give one "
                    "-viewpoint, or -tile_points 0"};
    return needed || !fits ? own : Error();
  }
  if (!needed && !wantsTiles(layout->count, tiles)) return {};
  if (Error error = checkBegin(path, job.input)) return error;
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

namespace {

constexpr std::size_t kTilesOfThread = 2;  ///< fewer leave threads idle at the end

void reportTiles(const StreamStatistics& statistics, const StreamFit& fit, int at_once,
                 Report& report) {
  std::uint64_t most = 0;
  for (std::size_t t = 0; t < fit.plan().tiles.size(); ++t)
    most = std::max(most, fit.loadedPoints(t));
  report.set("tiles", {{"count", statistics.tiles},
                       {"kept", statistics.kept_tiles},
                       {"halo_points", statistics.halo_points},
                       {"most_points", most},
                       {"at_once", at_once},
                       {"noise_thinning", statistics.noise_thinning},
                       {"passes", statistics.passes},
                       {"coarse_surfels", statistics.coarse_surfels},
                       {"scratch_read", statistics.scratch_read},
                       {"scratch_written", statistics.scratch_written}});
  report.time("measure", statistics.seconds_measure);
  report.time("sort", statistics.seconds_sort);
  report.time("plan", statistics.seconds_plan);
  report.time("load_tiles", statistics.seconds_load);
}

/** What one rank of a job did. */
struct RankFigures {
  double tiles, points, cpu_seconds, exchange_seconds, bytes_sent, halo_bytes_sent, peak_rss_mb;
};

/** Brings the figures of all ranks into the report of the first. */
void reportRanks(const StreamFit& fit, Ranks& ranks, Report& report) {
  const auto [first, end] = fit.ownTiles();
  std::uint64_t points = 0;
  for (std::size_t t = first; t < end; ++t) points += fit.plan().tiles[t].points;
  const RankFigures own{static_cast<double>(end - first),
                        static_cast<double>(points),
                        static_cast<double>(std::clock()) / CLOCKS_PER_SEC,
                        ranks.secondsExchanged(),
                        static_cast<double>(ranks.bytesSent()),
                        static_cast<double>(fit.statistics().halo_sent),
                        peakMemoryMb()};
  std::vector<Ranks::Bytes> messages(static_cast<std::size_t>(ranks.size()));
  messages[0].resize(sizeof(own));
  std::memcpy(messages[0].data(), &own, sizeof(own));
  ranks.exchange(messages);
  ReportValue::List list;
  for (const Ranks::Bytes& message : messages) {
    RankFigures rank{};
    if (message.size() == sizeof(rank)) std::memcpy(&rank, message.data(), sizeof(rank));
    list.push_back({{"tiles", static_cast<std::uint64_t>(rank.tiles)},
                    {"points", static_cast<std::uint64_t>(rank.points)},
                    {"cpu_seconds", rank.cpu_seconds},
                    {"exchange_seconds", rank.exchange_seconds},
                    {"bytes_sent", static_cast<std::uint64_t>(rank.bytes_sent)},
                    {"halo_bytes_sent", static_cast<std::uint64_t>(rank.halo_bytes_sent)},
                    {"peak_rss_mb", rank.peak_rss_mb}});
  }
  report.set("ranks", list);
}

/** Two numbers with a character between them. */
bool parsePair(const std::string& text, char between, std::size_t& first, std::size_t& second) {
  const char *at = text.data(), *last = at + text.size();
  const auto begin = std::from_chars(at, last, first);
  if (begin.ec != std::errc() || begin.ptr == last || *begin.ptr != between) return false;
  const auto end = std::from_chars(begin.ptr + 1, last, second);
  return end.ec == std::errc() && end.ptr == last;
}

/** The tiles of one of some shares of about as many points: the largest tile left goes to the share
 * that has the least. */
std::vector<std::size_t> shareOf(const StreamFit& fit, std::size_t share, std::size_t shares) {
  std::vector<std::size_t> order(fit.plan().tiles.size());
  for (std::size_t t = 0; t < order.size(); ++t) order[t] = t;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return fit.loadedPoints(a) > fit.loadedPoints(b);
  });
  std::vector<std::uint64_t> loads(shares, 0);
  std::vector<std::size_t> own;
  for (const std::size_t t : order) {
    const auto least = std::min_element(loads.begin(), loads.end());
    *least += fit.loadedPoints(t);
    if (static_cast<std::size_t>(least - loads.begin()) == share) own.push_back(t);
  }
  return own;
}

/** Which tiles are to be fitted. */
Result<std::vector<std::size_t>> wantedTiles(const std::string& text, const StreamFit& fit) {
  constexpr std::size_t kMostShares = 1000000;
  const std::size_t tiles = fit.plan().tiles.size();
  std::size_t begin = 0, end = 0;
  if (parsePair(text, '/', begin, end) && begin < end && end <= kMostShares)
    return shareOf(fit, begin, end);
  const bool range =
      text.empty() || (parsePair(text, ':', begin, end) && begin <= end && end <= tiles);
  if (!range) {
    const std::string all = std::to_string(tiles);
    return Error{ErrorCode::kBadArgument, "-tiles '" + text + "' is no range A:B of the " + all +
                                              " tiles, 0:" + all + ", and no share K/N, 0/4"};
  }
  std::vector<std::size_t> wanted;
  for (std::size_t t = begin; t < (text.empty() ? tiles : end); ++t) wanted.push_back(t);
  return wanted;
}

/** One run of a program over some or all tiles. */
class TileRun {
 public:
  TileRun(const FitJob& job, const TileRequest& tiles, Console& console, SlimBlockWriter* writer,
          TiledSurface& made)
      : job_(job), tiles_(tiles), console_(console), writer_(writer), made_(made) {}

  Error run(PointSource& source, StreamFit& fit) {
    if (Error error = fit.prepare(source, &console_.progress())) return error;
    const int threads = resolveThreads(job_.params.threads);
    const double bytes = static_cast<double>(fit.workingBytes(threads));
    const std::string what = "fitting tiles of " + std::to_string(tiles_.points) + " points";
    if (Error error = checkMemory(bytes, what, kTileRelief)) return error;
    const auto wanted = wantedTiles(tiles_.range, fit);
    if (!wanted) return wanted.error();
    const bool elsewhere = tiles_.ranks != nullptr && tiles_.ranks->rank() != 0;
    made_.partial = !tiles_.range.empty() || elsewhere;
    const bool oriented = fit.frame().with_normals || !job_.params.orient;
    const bool faces = job_.params.viewpoint || fit.frame().sensor;
    writes_ = writer_ != nullptr && !made_.partial && (oriented || faces);
    if (Error error = keepCoarse(fit)) return error;
    const auto take = [&](std::size_t t, const SLIMSurface& tile) { return keep(fit, t, tile); };
    const auto [first, end] = fit.ownTiles();
    at_once_ = tilesAtOnce(fit, std::min(wanted->size(), end - first));
    if (Error error = fit.fit(*wanted, at_once_, take, &console_.progress())) return error;
    return made_.partial ? Error() : finish(fit);
  }

  int atOnce() const { return at_once_; }
  std::uint64_t written() const { return writes_ ? writer_->surfels() : made_.surface.size(); }

 private:
  /** The levels above the tiles' first go in front of these. */
  Error keepCoarse(const StreamFit& fit) {
    SLIMSurface coarse = fit.coarse();
    if (made_.partial) return {};
    made_.surface.info = coarse.info;
    if (writes_) {
      turn(fit, coarse);
      return writer_->add(coarse, 0, 0);
    }
    made_.begins.push_back(0);
    made_.surface.append(coarse);
    return {};
  }

  /** One a thread, where memory has room for them and there are enough to keep all threads busy. */
  int tilesAtOnce(const StreamFit& fit, std::size_t tiles) const {
    const int threads = resolveThreads(job_.params.threads);
    const double bytes = threads * static_cast<double>(fit.workingBytes());
    const bool many = tiles >= kTilesOfThread * static_cast<std::size_t>(threads);
    return many && bytes <= memoryLeft() ? threads : 1;
  }

  Error keep(const StreamFit& fit, std::size_t t, const SLIMSurface& tile) {
    if (made_.partial) return {};
    if (writes_) {
      SLIMSurface turned = tile;
      turn(fit, turned);
      return add(fit, t, turned);
    }
    made_.begins.push_back(made_.surface.size());
    made_.surface.append(tile);
    return {};
  }

  /** Gives surfels a common side, which needs links. */
  void turn(const StreamFit& fit, SLIMSurface& surface) const {
    surface.buildLinks(job_.params.threads);
    if (!fit.frame().with_normals && job_.params.orient)
      orientSurfels(fit.frame(), job_.params, surface);
  }

  Error add(const StreamFit& fit, std::size_t t, const SLIMSurface& tile) {
    const TilePlan::Tile& own = fit.plan().tiles[t];
    return writer_->add(tile, own.first_key, own.end_key);
  }

  /** Joins what could not be written tile by tile. */
  Error finish(const StreamFit& fit) {
    if (writes_) return {};
    turn(fit, made_.surface);
    if (writer_ == nullptr) return {};
    made_.begins.push_back(made_.surface.size());
    for (std::size_t t = 0; t + 1 < made_.begins.size(); ++t) {
      const SLIMSurface tile = made_.surface.slice(made_.begins[t], made_.begins[t + 1]);
      Error error = t == 0 ? writer_->add(tile, 0, 0) : add(fit, t - 1, tile);
      if (error) return error;
    }
    return {};
  }

  const FitJob& job_;
  const TileRequest& tiles_;
  Console& console_;
  SlimBlockWriter* writer_;
  TiledSurface& made_;
  int at_once_ = 1;
  bool writes_ = false;  ///< tiles are written as they come
};

FittedPoints pointsOf(const StreamFit& fit) {
  const StreamStatistics& statistics = fit.statistics();
  FittedPoints fitted;
  fitted.stored = statistics.fit.points;
  fitted.diagonal = fit.frame().diagonal * fit.frame().scale;
  fitted.store_bytes = fit.workingBytes();
  fitted.statistics = statistics.points;
  return fitted;
}

/** Prints and reports the totals over all tiles. */
void printNotes(const StreamFit& fit, Console& console) {
  const StreamStatistics& statistics = fit.statistics();
  const std::string skipped = skippedText(statistics.points);
  if (!skipped.empty()) console.note("  " + skipped);
  console.note("  " + noiseText(pointsOf(fit).diagonal, statistics.fit));
  printSideNotes(statistics.fit.sides.source, {}, console);
  for (const std::string& note : coverNotes(statistics.fit)) console.note(note);
}

}  // namespace

Error fitByTiles(PointSource& source, const FitJob& job, const TileRequest& tiles, Console& console,
                 Report& report, SlimBlockWriter* writer, TiledSurface& made) {
  report.set("points", source.size());
  report.set("normals", source.hasNormals() ? "fields" : "none");
  console.begin("Fitting by tiles");
  StreamParams params = streamParams(job, tiles);
  params.source_name = tiles.source_name;
  StreamFit fit(std::move(params));
  TileRun run(job, tiles, console, writer, made);
  if (Error error = run.run(source, fit)) return console.failed(error);
  const StreamStatistics& statistics = fit.statistics();
  if (statistics.remade)
    console.warn("what '" + tiles.plan + "' keeps is damaged: points and plan were made again");
  report.time("fit", console.seconds());
  reportFit(pointsOf(fit), made.surface, statistics.fit, report);
  const auto& levels = statistics.fit.leaves_per_level;
  report.set("surfels", run.written());
  report.set("levels", std::count_if(levels.begin(), levels.end(), [](auto n) { return n > 0; }));
  reportTiles(statistics, fit, run.atOnce(), report);
  if (tiles.ranks != nullptr) reportRanks(fit, *tiles.ranks, report);
  console.done(std::to_string(statistics.fit.leaves) + " leaves, " +
               counted(statistics.tiles, "tile"));
  if (made.partial) {
    console.note("  of the " + counted(statistics.tiles, "tile") + " " + tiles.range +
                 " are fitted and kept in '" + tiles.plan + "'");
    return {};
  }
  printNotes(fit, console);
  if (statistics.fit.leaves > 0) return {};
  return {
      ErrorCode::kNoSurface,
      "the points lie along lines or scattered, nowhere along a surface: give more points beside "
      "them"};
}

Exit exitOfTiles(const Error& error) {
  const bool usage = error.code == ErrorCode::kBadInput || error.code == ErrorCode::kBadArgument;
  return usage ? Exit::usage(error) : Exit(error);
}

void removePlan(const std::string& folder) {
  std::error_code code;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, code)) {
    const std::string name = entry.path().filename().string();
    const bool ours = name == "plan" || name == "points" || name.rfind("tile-", 0) == 0;
    if (ours) fs::remove(entry.path(), code);
  }
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/stream/stream_fit.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "stream_state.h"

namespace pcl_slim {

using namespace detail;

namespace {

// A point takes the most while it is sorted; then balls take as much again where they are wide.
constexpr std::uint64_t kBytesOfSorting = 40;  ///< keys, their order and the store's columns
constexpr std::uint64_t kBytesOfFit = 38;      ///< the store and marks of what is covered
/// A ball's columns and those of its inner part, and a tenth: balls are counted at 31 places of a
/// tile, and others are fuller.
constexpr std::uint64_t kBytesInBall = 40;
constexpr std::uint64_t kBytesOfNormal = 12;

/** The identity of a cloud and parameters: kept plans and tiles must agree in it. */
std::string identityOf(const PointSource& source, const StreamParams& params) {
  const FitParams& f = params.fit;
  const int local = f.local_noise ? 1 + *f.local_noise : 0;
  const auto* penalty = std::get_if<PenaltyWeight>(&f.size);
  const auto* threshold = std::get_if<MDLThreshold>(&f.size);
  const std::optional<double> kappa = penalty ? penalty->kappa : std::nullopt;
  const double t_mdl = threshold ? threshold->t : 0;
  char text[600];
  std::snprintf(
      text, sizeof(text),
      "%llu %d %d %llu %d %.17g %.17g %.17g %.17g %.17g %.17g %.17g %d %d %d %.17g %d %.17g %d "
      "%.17g %llu ",
      static_cast<unsigned long long>(source.size()), static_cast<int>(source.scalar()),
      source.hasNormals(), static_cast<unsigned long long>(params.tile_points),
      f.degree.value_or(0), kappa.value_or(0), t_mdl, f.lambda.value_or(0), f.noise.value_or(0),
      f.cover_radius.value_or(0), f.cover_threshold, f.least_radius.value_or(0), f.sharp_features,
      f.robust, local, f.noise_correlation.value_or(0), f.normals_as_data,
      f.normal_error.value_or(0), f.trim, f.hole_size, static_cast<unsigned long long>(f.seed));
  return text + params.source_name;
}

/** Reports a share of a long computation's progress, and passes cancellation on to it. */
class PartialProgress {
 public:
  PartialProgress(Progress* whole, float begin, float end)
      : part_([this, whole, begin, end](float fraction, const char* stage) {
          if (whole == nullptr) return;
          whole->report(begin + fraction * (end - begin), stage);
          if (whole->cancelled()) part_.cancel();
        }) {}

  Progress& part() { return part_; }

 private:
  Progress part_;
};

/** \brief Tiles that are fitted at the same time, a thread each, and given away in order. */
class TileQueue {
 public:
  TileQueue(StreamState& state, const std::vector<std::size_t>& tiles, const StreamFit::Sink& sink,
            Progress* progress)
      : state_(state), tiles_(tiles), sink_(sink), progress_(progress) {}

  /** \brief Fits all. \param[in] at_once how many at the same time */
  Error fit(int at_once);

 private:
  void work();
  bool take(std::size_t& place);
  Error fitOne(std::size_t place);
  Error giveAway();
  bool stopped() const { return progress_ != nullptr && progress_->cancelled(); }

  StreamState& state_;
  const std::vector<std::size_t>& tiles_;
  const StreamFit::Sink& sink_;
  Progress* progress_;
  const std::thread::id caller_ = std::this_thread::get_id();
  std::mutex mutex_;
  std::size_t next_ = 0, given_ = 0;  ///< places among the tiles
  std::map<std::size_t, FittedTile> ready_;
  Error error_;
};

Error TileQueue::fit(int at_once) {
  parallelFor(static_cast<std::size_t>(at_once), at_once, 1, [&](std::size_t, int) {
    try {
      work();
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      next_ = tiles_.size();
      throw;
    }
  });
  return stopped() ? cancelled() : error_;
}

/** One thread's share: fits what is next until nothing is left or some tile has failed. */
void TileQueue::work() {
  for (std::size_t place; take(place);) {
    Error error = fitOne(place);
    if (!error) continue;
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!error_) error_ = std::move(error);
    next_ = tiles_.size();
  }
}

bool TileQueue::take(std::size_t& place) {
  const std::lock_guard<std::mutex> lock(mutex_);
  place = next_;
  if (next_ == tiles_.size() || stopped()) return false;
  ++next_;
  return true;
}

Error TileQueue::fitOne(std::size_t place) {
  Progress watched([&](float, const char*) {
    if (stopped()) watched.cancel();
  });
  FittedTile made;
  if (Error error = state_.fitTile(tiles_[place], 1, made, watched)) return error;
  const std::lock_guard<std::mutex> lock(mutex_);
  ready_.emplace(place, std::move(made));
  return giveAway();
}

/** Gives away the tiles whose turn it is. */
Error TileQueue::giveAway() {
  for (auto first = ready_.begin(); first != ready_.end() && first->first == given_ && !error_;
       first = ready_.erase(first), ++given_) {
    if (Error error = state_.give(tiles_[given_], first->second, sink_)) return error;
  }
  const auto done = static_cast<float>(given_) / static_cast<float>(tiles_.size());
  if (progress_ != nullptr && std::this_thread::get_id() == caller_)
    progress_->report(0.12f + 0.88f * done, "covering");
  return {};
}

}  // namespace

Error StreamParams::validate() const {
  if (tile_points < kLeastTile) {
    return {ErrorCode::kBadArgument, "tiles of " + std::to_string(tile_points) +
                                         " points are too small: give " +
                                         std::to_string(kLeastTile) + " or more"};
  }
  constexpr std::uint64_t kMost = 1000000000;
  if (tile_points > kMost) {
    return {ErrorCode::kBadArgument, "tiles of " + std::to_string(tile_points) +
                                         " points are too large: give 10^9 or fewer"};
  }
  if (ranks != nullptr && ranks->size() > 1 && !state.empty()) {
    return {ErrorCode::kBadArgument,
            "ranks keep no tiles for a later run: leave the folder that keeps them"};
  }
  return checkTileParams(fit);
}

StreamFit::StreamFit(StreamParams params)
    : state_(std::make_unique<StreamState>(std::move(params))) {}
StreamFit::~StreamFit() = default;

/** Takes the plan and the points of an earlier run. \return whether there are any of this cloud. */
bool detail::StreamState::takeKept(PointSource& source) {
  KeptPlan kept;
  if (!keeps() || !loadPlan(params.state, identity, kept)) return false;
  kept.plan.makeTiles(params.tile_points);
  const std::size_t tiles = kept.plan.tiles.size();
  if (kept.first_levels.size() != tiles || kept.halos.size() != tiles || kept.balls.size() != tiles)
    return false;
  FittedTile above;
  stats.remade = !loadTile(params.state, identity, tiles, above) ||
                 store.open(kept.plan, kept.record, params.state, kept.checksums);
  if (stats.remade) return false;
  coarse = std::move(above.surface);
  frame = kept.frame;
  frame.sensor = source.sensor();
  plan = std::move(kept.plan);
  shareTiles();
  traits = kept.traits;
  radii = levelRadii(frame, params.fit);
  first_levels = std::move(kept.first_levels);
  halos = std::move(kept.halos);
  balls = std::move(kept.balls);
  sum.sum() = kept.noise;
  if (kept.noise.sides.source == SideSource::kOrigin) frame.sensor.emplace();
  stats.points = kept.points;
  stats.noise_thinning = kept.thinning;
  stats.tiles = tiles;
  return true;
}

Error detail::StreamState::keep() const {
  KeptPlan kept;
  kept.frame = frame;
  kept.record = store.record();
  kept.traits = traits;
  kept.noise = sum.sum();
  kept.points = stats.points;
  kept.thinning = stats.noise_thinning;
  kept.plan = plan;
  kept.first_levels = first_levels;
  kept.halos = halos;
  kept.balls = balls;
  kept.checksums = store.checksums();
  FittedTile above;
  above.surface = coarse;
  if (Error error = saveTile(params.state, identity, plan.tiles.size(), above)) return error;
  return savePlan(params.state, identity, kept);
}

Error StreamFit::prepare(PointSource& source, Progress* progress) {
  StreamState& s = *state_;
  if (Error error = s.params.validate()) return error;
  if (source.size() == 0 && s.isAlone()) return badInput("the cloud holds no points: give some");
  if (source.hasSensors()) {
    return {ErrorCode::kBadArgument,
            "a fit by tiles knows one sensor for all points: give a viewpoint in place of sensors"};
  }
  if (source.hasFrameNumbers()) {
    return {ErrorCode::kBadArgument,
            "a fit by tiles does not measure frames one by one: leave out their numbers"};
  }
  s.identity = identityOf(source, s.params);
  if (s.takeKept(source)) return {};
  Stopwatch watch;
  if (Error error = s.measureFrame(source, progress)) return error;
  s.stats.seconds_measure = watch.seconds();
  watch = {};
  if (Error error = s.countCells(source, progress)) return error;
  if (Error error = s.sortPoints(source, progress)) return error;
  s.stats.seconds_sort = watch.seconds();
  watch = {};
  if (Error error = s.measureNoise()) return error;
  s.sum.sum().seconds.noise += watch.seconds();
  watch = {};
  if (Error error = s.survey(progress)) return error;
  s.stats.seconds_plan = watch.seconds();
#ifdef __GLIBC__
  malloc_trim(0);  // gives the passes' memory back for the tiles
#endif
  return s.keeps() ? s.keep() : Error();
}

const StoreFrame& StreamFit::frame() const {
  return state_->frame;
}

const TilePlan& StreamFit::plan() const {
  return state_->plan;
}

const CloudTraits& StreamFit::traits() const {
  return state_->traits;
}

std::pair<std::size_t, std::size_t> StreamFit::ownTiles() const {
  return {state_->firstTile(), state_->endTile()};
}

int StreamFit::firstLevel(std::size_t tile) const {
  return state_->first_levels[tile];
}

const SLIMSurface& StreamFit::coarse() const {
  return state_->coarse;
}

std::uint64_t StreamFit::loadedPoints(std::size_t tile) const {
  return state_->plan.tiles[tile].points + state_->halos[tile];
}

std::uint64_t StreamFit::workingBytes(int threads) const {
  const PointRecord& record = state_->store.record();
  const std::uint64_t normal = record.normals ? kBytesOfNormal : 0;
  const std::uint64_t in_balls = (kBytesInBall + 2 * normal) * static_cast<std::uint64_t>(threads);
  std::uint64_t most = 0;
  for (std::size_t t = 0; t < state_->plan.tiles.size(); ++t) {
    const std::uint64_t points = loadedPoints(t);
    const std::uint64_t fit = points * (kBytesOfFit + normal) + state_->balls[t] * in_balls;
    most = std::max({most, points * (record.bytes() + kBytesOfSorting), fit});
  }
  return most;
}

Error detail::StreamState::fitAnew(std::size_t tile, int with_threads, FittedTile& made,
                                   Progress& progress) const {
  const Stopwatch watch;
  std::vector<unsigned char> records;
  if (Error error = load(tile, with_threads, records)) return error;
  Result<PointStore> points = PointStore::build(store.record().view(records), frame, with_threads);
  if (!points) return points.error();
  made.halo_points = records.size() / store.record().bytes() - plan.tiles[tile].points;
  std::vector<unsigned char>().swap(records);
  made.seconds_load = watch.seconds();
  TileJob job;
  job.first_key = plan.tiles[tile].first_key;
  job.end_key = plan.tiles[tile].end_key;
  job.first_level = first_levels[tile];
  job.traits = traits;
  FitParams fit = params.fit;
  fit.threads = with_threads;
  if (Error error = pcl_slim::fitTile(std::move(*points), fit, job, made.surface, &made.statistics,
                                      &progress))
    return error;
  made.surface.info.num_points = plan.points;
  return {};
}

/** Fits a tile, unless an earlier run has kept it. */
Error detail::StreamState::fitTile(std::size_t tile, int with_threads, FittedTile& made,
                                   Progress& progress) const {
  if (keeps() && loadTile(params.state, identity, tile, made)) return {};
  if (Error error = fitAnew(tile, with_threads, made, progress)) return error;
  return keeps() ? saveTile(params.state, identity, tile, made) : Error();
}

void detail::StreamState::addTile(std::size_t tile, const FittedTile& made) {
  sum.add(made.statistics, made.surface);
  stats.points.duplicates +=
      plan.tiles[tile].points - made.statistics.points - made.statistics.outliers;
  stats.halo_points += made.halo_points;
  stats.seconds_load += made.seconds_load;
  stats.kept_tiles += made.kept ? 1 : 0;
}

Error detail::StreamState::fitNext(std::size_t tile, FittedTile& made, Progress* progress) const {
  const auto share = [&](std::size_t t) {
    return 0.12f + 0.88f * static_cast<float>(t) / static_cast<float>(plan.tiles.size());
  };
  PartialProgress partial(progress, share(tile), share(tile + 1));
  if (progress != nullptr && progress->cancelled()) return cancelled();
  if (Error error = fitTile(tile, threads, made, partial.part()))
    return progress != nullptr && progress->cancelled() ? cancelled() : error;
  return {};
}

/** Gives a tile away, or puts it where rank 0 will take it from. */
Error detail::StreamState::give(std::size_t tile, const FittedTile& made,
                                const StreamFit::Sink& sink) {
  if (ranks().rank() != 0) return fitted.add(tile, made, params.scratch);
  addTile(tile, made);
  return sink(tile, made.surface);
}

Error StreamFit::fit(std::size_t tile, SLIMSurface& surface, Progress* progress) {
  FittedTile made;
  if (Error error = state_->fitNext(tile, made, progress)) return error;
  state_->addTile(tile, made);
  surface = std::move(made.surface);
  return {};
}

Error StreamFit::fit(const std::vector<std::size_t>& tiles, int at_once, const Sink& sink,
                     Progress* progress) {
  StreamState& s = *state_;
  std::vector<std::size_t> own;
  std::copy_if(tiles.begin(), tiles.end(), std::back_inserter(own),
               [&](std::size_t t) { return s.owns(t); });
  if (at_once > 1) {
    if (Error error = TileQueue(s, own, sink, progress).fit(at_once)) return error;
  }
  for (std::size_t i = 0; i < own.size() && at_once <= 1; ++i) {
    FittedTile made;
    if (Error error = s.fitNext(own[i], made, progress)) return error;
    if (Error error = s.give(own[i], made, sink)) return error;
  }
  return s.gatherTiles(tiles, sink);
}

const StreamStatistics& StreamFit::statistics() const {
  StreamState& s = *state_;
  s.stats.fit = s.sum.sum();
  SideSource& sides = s.stats.fit.sides.source;
  if (!s.frame.with_normals && s.params.fit.viewpoint)
    sides = SideSource::kViewpoint;
  else if (sides == SideSource::kNone && s.params.fit.orient)
    sides = SideSource::kOutward;
  s.stats.coarse_surfels = s.coarse.size();
  s.stats.fit.internals += s.coarse.size();
  s.stats.scratch_read = s.store.file().bytesRead() + s.halo.file().bytesRead();
  s.stats.scratch_written = s.store.file().bytesWritten() + s.halo.file().bytesWritten();
  return s.stats;
}

Error fitTiles(PointSource& source, const StreamParams& params, SLIMSurface& surface,
               StreamStatistics* statistics, Progress* progress) {
  surface.clear();
  StreamFit fit(params);
  if (Error error = fit.prepare(source, progress)) return error;
  surface.append(fit.coarse());
  for (std::size_t t = 0; t < fit.plan().tiles.size(); ++t) {
    SLIMSurface tile;
    if (Error error = fit.fit(t, tile, progress)) return error;
    surface.append(tile);
  }
  surface.buildLinks(params.fit.threads);
  if (!fit.frame().with_normals && params.fit.orient)
    orientSurfels(fit.frame(), params.fit, surface);
  if (statistics != nullptr) *statistics = fit.statistics();
  if (fit.statistics().fit.leaves > 0) return {};
  surface.clear();
  return {ErrorCode::kNoSurface,
          "the points lie along lines or scattered, nowhere along a surface"};
}

}  // namespace pcl_slim

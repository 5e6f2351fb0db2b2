// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/stream/stream_fit.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <chrono>
#include <utility>

#include "cells/cell_counts.h"
#include "pcl_slim/cloud/detail/frame_measure.h"
#include "pcl_slim/core/parallel.h"
#include "scratch/tile_store.h"
#include "tiles/first_level.h"
#include "tiles/noise_sample.h"
#include "tiles/statistics_sum.h"
#include "tiles/tile_loader.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::uint64_t kCellsOfTile =
    64;  ///< cells of more than such a part of a tile are divided
constexpr std::uint64_t kBytesOfSorting =
    32;  ///< keys, their order and the store's columns, a point

constexpr std::uint64_t kBallsOfSmallTile = 8;
constexpr double kMostLoaded = 1.7;  ///< [tile points] of a tile with its halo

class Stopwatch {
 public:
  double seconds() const
  {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

Error
cancelled()
{
  return {ErrorCode::kCancelled, "the fit was cancelled"};
}

/** Reports a share of a long computation's progress, and passes cancellation on to it. */
class PartialProgress {
 public:
  PartialProgress(Progress* whole, float begin, float end)
      : part_([this, whole, begin, end](float fraction, const char* stage) {
          if (whole == nullptr) return;
          whole->report(begin + fraction * (end - begin), stage);
          if (whole->cancelled()) part_.cancel();
        })
  {
  }

  Progress& part() { return part_; }

 private:
  Progress part_;
};

}  // namespace

struct StreamFit::State {
  explicit State(StreamParams given) : params(std::move(given))
  {
    params.fit.threads = threads = resolveThreads(params.fit.threads);
  }

  StreamParams params;
  int threads;
  StoreFrame frame;
  CellCounts counts;
  TilePlan plan;
  TileStore store;
  CloudTraits traits;
  LevelRadii radii;
  std::vector<int> first_levels;
  std::vector<std::uint64_t> halos;  ///< most points of each tile's
  StatisticsSum sum;
  StreamStatistics stats;

  TileLoader loader() const { return {plan, store, frame, threads}; }

  template <typename Visit>
  Error pass(PointSource& source, Progress* progress, float begin, float end, const char* stage,
             const Visit& visit);
  Error measureFrame(PointSource& source, Progress* progress);
  Error countCells(PointSource& source, Progress* progress);
  Error sortPoints(PointSource& source, Progress* progress);
  Error measureNoise();
  Error survey(Progress* progress);
  Error load(std::size_t tile, std::vector<unsigned char>& records) const;
};

/** A pass over the source that reports its progress between begin and end. */
template <typename Visit>
Error
StreamFit::State::pass(PointSource& source, Progress* progress, float begin, float end,
                       const char* stage, const Visit& visit)
{
  ++stats.passes;
  const double points = std::max(1.0, static_cast<double>(source.size()));
  double done = 0;
  return source.pass([&](const CloudView& piece) -> Error {
    if (progress != nullptr) {
      if (progress->cancelled()) return cancelled();
      progress->report(begin + static_cast<float>(done / points) * (end - begin), stage);
    }
    done += static_cast<double>(piece.count());
    return visit(piece);
  });
}

Error
StreamFit::State::measureFrame(PointSource& source, Progress* progress)
{
  FrameMeasure measure;
  do {
    const auto add = [&](const CloudView& piece) {
      measure.add(piece, threads);
      return Error();
    };
    if (Error error = pass(source, progress, 0.0f, 0.03f, "measuring", add)) return error;
  } while (measure.needsAnotherPass());
  FrameCounts found;
  if (Error error = measure.finish(frame, found)) return error;
  frame.sensor = source.sensor();
  stats.points.input_points = found.input;
  stats.points.non_finite = found.input - found.finite;
  stats.points.far_away = found.finite - found.near;
  stats.points.without_normal = found.near - found.stored;
  if (frame.diagonal > 0) return {};
  return {ErrorCode::kNoSurface, "all points are at one place: give points of a surface"};
}

Error
StreamFit::State::countCells(PointSource& source, Progress* progress)
{
  PointKeys keys(frame, threads);
  do {
    const auto count = [&](const CloudView& piece) {
      return counts.add(keys.of(piece).data(), piece.count());
    };
    if (Error error = pass(source, progress, 0.03f, 0.06f, "counting", count)) return error;
  } while (counts.divideCells(params.tile_points / kCellsOfTile));
  plan.cells = counts.cells();
  plan.makeTiles(params.tile_points);
  stats.tiles = plan.tiles.size();
  return {};
}

Error
StreamFit::State::sortPoints(PointSource& source, Progress* progress)
{
  const PointRecord record{source.scalar(), frame.with_normals};
  if (Error error = store.create(plan, record, params.scratch, counts)) return error;
  PointKeys keys(frame, threads);
  const auto add = [&](const CloudView& piece) {
    return store.add(piece, keys.of(piece).data(), counts);
  };
  if (Error error = pass(source, progress, 0.06f, 0.12f, "sorting", add)) return error;
  counts = CellCounts();
  return store.finish();
}

Error
StreamFit::State::measureNoise()
{
  Result<MeasuredTraits> measured =
      measureSampledTraits(loader(), frame, params.fit, stats.noise_thinning);
  if (!measured) return measured.error();
  traits = measured->traits;
  FitStatistics& fit = sum.sum();
  const double seconds = fit.seconds_noise;
  fit = measured->statistics;
  fit.seconds_noise = seconds;
  return {};
}

/** Finds each tile's first level, and how much its halo has. */
Error
StreamFit::State::survey(Progress* progress)
{
  radii = levelRadii(frame, params.fit);
  const TileLoader tiles = loader();
  std::vector<unsigned char> records;
  for (std::size_t t = 0; t < plan.tiles.size(); ++t) {
    if (progress != nullptr && progress->cancelled()) return cancelled();
    if (Error error = tiles.loadCore(t, records)) return error;
    const CloudView core = tiles.record().view(records);
    // What is left over at the end of a node has no room for balls of a whole tile's.
    const std::uint64_t most = std::min(params.firstBallPoints(), core.size / kBallsOfSmallTile);
    int level = detail::firstLevel(core, frame, radii, most, traits.lambda);
    std::uint64_t halo = tiles.mostHalo(t, tiles.maskOf(t, records, radii.reach(level)));
    // A sparse tile beside a dense part of the cloud begins with narrower balls.
    while (static_cast<double>(core.size + halo) >
               kMostLoaded * static_cast<double>(params.tile_points) &&
           isFirstLevel(radii, level + 1, traits.lambda)) {
      ++level;
      halo = tiles.mostHalo(t, tiles.maskOf(t, records, radii.reach(level)));
    }
    first_levels.push_back(level);
    halos.push_back(halo);
  }
  return {};
}

/** The records of a tile's core and halo. */
Error
StreamFit::State::load(std::size_t tile, std::vector<unsigned char>& records) const
{
  const TileLoader tiles = loader();
  records.reserve((plan.tiles[tile].points + halos[tile]) * tiles.record().bytes());
  if (Error error = tiles.loadCore(tile, records)) return error;
  const HaloMask mask = tiles.maskOf(tile, records, radii.reach(first_levels[tile]));
  return tiles.loadHalo(tile, mask, records);
}

Error
StreamParams::validate() const
{
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
  return checkTileParams(fit);
}

StreamFit::StreamFit(StreamParams params) : state_(std::make_unique<State>(std::move(params))) {}
StreamFit::~StreamFit() = default;

Error
StreamFit::prepare(PointSource& source, Progress* progress)
{
  State& s = *state_;
  if (Error error = s.params.validate()) return error;
  if (source.size() == 0) return badInput("the cloud holds no points: give some");
  Stopwatch watch;
  if (Error error = s.measureFrame(source, progress)) return error;
  s.stats.seconds_measure = watch.seconds();
  watch = {};
  if (Error error = s.countCells(source, progress)) return error;
  if (Error error = s.sortPoints(source, progress)) return error;
  s.stats.seconds_sort = watch.seconds();
  watch = {};
  if (Error error = s.measureNoise()) return error;
  s.sum.sum().seconds_noise += watch.seconds();
  watch = {};
  if (Error error = s.survey(progress)) return error;
  s.stats.seconds_plan = watch.seconds();
#ifdef __GLIBC__
  malloc_trim(0);  // what passes have used is tiles' to take
#endif
  return {};
}

const StoreFrame&
StreamFit::frame() const
{
  return state_->frame;
}

const TilePlan&
StreamFit::plan() const
{
  return state_->plan;
}

const CloudTraits&
StreamFit::traits() const
{
  return state_->traits;
}

int
StreamFit::firstLevel(std::size_t tile) const
{
  return state_->first_levels[tile];
}

std::uint64_t
StreamFit::loadedPoints(std::size_t tile) const
{
  return state_->plan.tiles[tile].points + state_->halos[tile];
}

std::uint64_t
StreamFit::workingBytes() const
{
  std::uint64_t most = 0;
  for (std::size_t t = 0; t < state_->plan.tiles.size(); ++t)
    most = std::max(most, loadedPoints(t));
  return most * (state_->store.record().bytes() + kBytesOfSorting);
}

Error
StreamFit::fit(std::size_t tile, SLIMSurface& surface, Progress* progress)
{
  State& s = *state_;
  const auto share = [&](std::size_t t) {
    return 0.12f + 0.88f * static_cast<float>(t) / static_cast<float>(s.plan.tiles.size());
  };
  PartialProgress partial(progress, share(tile), share(tile + 1));
  if (progress != nullptr && progress->cancelled()) return cancelled();
  const Stopwatch watch;
  std::vector<unsigned char> records;
  if (Error error = s.load(tile, records)) return error;
  Result<PointStore> store = PointStore::build(s.store.record().view(records), s.frame, s.threads);
  if (!store) return store.error();
  const std::size_t loaded = records.size() / s.store.record().bytes();
  std::vector<unsigned char>().swap(records);
  s.stats.seconds_load += watch.seconds();
  TileJob job;
  job.first_key = s.plan.tiles[tile].first_key;
  job.end_key = s.plan.tiles[tile].end_key;
  job.first_level = s.first_levels[tile];
  job.traits = s.traits;
  FitStatistics stats;
  if (Error error = fitTile(*store, s.params.fit, job, surface, &stats, &partial.part()))
    return progress != nullptr && progress->cancelled() ? cancelled() : error;
  surface.info.num_points = s.plan.points;
  s.sum.add(stats, surface);
  s.stats.halo_points += loaded - s.plan.tiles[tile].points;
  s.stats.points.duplicates += s.plan.tiles[tile].points - stats.points;
  return {};
}

const StreamStatistics&
StreamFit::statistics() const
{
  State& s = *state_;
  s.stats.fit = s.sum.sum();
  s.stats.scratch_read = s.store.file().bytesRead();
  s.stats.scratch_written = s.store.file().bytesWritten();
  return s.stats;
}

Error
fitTiles(PointSource& source, const StreamParams& params, SLIMSurface& surface,
         StreamStatistics* statistics, Progress* progress)
{
  surface.clear();
  StreamFit fit(params);
  if (Error error = fit.prepare(source, progress)) return error;
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

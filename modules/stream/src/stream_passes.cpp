// SPDX-License-Identifier: BSD-3-Clause
// What a fit by tiles finds before the first tile is fitted: frame, cells, sorted points, noise, levels.
#include <algorithm>

#include "pcl_slim/cloud/detail/frame_measure.h"
#include "stream_state.h"
#include "tiles/first_level.h"
#include "tiles/noise_sample.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::uint64_t kCellsOfTile =
    64;  ///< cells of more than such a part of a tile are divided
constexpr std::uint64_t kBallsOfSmallTile = 8;
constexpr double kMostLoaded = 1.7;  ///< [tile points] of a tile with its halo

}  // namespace

/** A pass over the source that reports its progress between begin and end. */
Error
detail::StreamState::pass(PointSource& source, Progress* progress, float begin, float end,
                          const char* stage, const PointSource::Visit& visit)
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
detail::StreamState::measureFrame(PointSource& source, Progress* progress)
{
  FrameMeasure measure;
  do {
    const auto add = [&](const CloudView& piece) {
      measure.add(piece, threads);
      return Error();
    };
    if (Error error = pass(source, progress, 0.0f, 0.03f, "measuring", add)) return error;
    if (!isAlone()) measure.merge(fromAll(ranks(), measure.packed()));
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
detail::StreamState::countCells(PointSource& source, Progress* progress)
{
  PointKeys keys(frame, threads);
  do {
    const auto count = [&](const CloudView& piece) {
      return counts.add(keys.of(piece).data(), piece.count());
    };
    if (Error error = pass(source, progress, 0.03f, 0.06f, "counting", count)) return error;
    if (Error error = isAlone() ? Error() : sumCells()) return error;
  } while (counts.divideCells(params.tile_points / kCellsOfTile));
  plan.cells = counts.cells();
  plan.makeTiles(params.tile_points);
  counts.numberCells();
  shareTiles();
  stats.tiles = plan.tiles.size();
  return {};
}

Error
detail::StreamState::sortPoints(PointSource& source, Progress* progress)
{
  const PointRecord record{source.scalar(), frame.with_normals};
  std::vector<std::uint32_t> points = pointsOfCells(plan);
  for (std::size_t t = 0; t < plan.tiles.size(); ++t) {
    for (std::size_t c = plan.tiles[t].first_cell; c < plan.tiles[t].end_cell; ++c)
      points[c] = owns(t) ? points[c] : 0;
  }
  if (Error error =
          store.create(plan, points, record, keeps() ? params.state : params.scratch, keeps()))
    return error;
  PointKeys keys(frame, threads);
  const auto add = [&](const CloudView& piece) {
    return store.add(piece, keys.of(piece).data(), counts);
  };
  Error error = isAlone() ? pass(source, progress, 0.06f, 0.12f, "sorting", add)
                          : sendPoints(source, progress);
  return error ? error : store.finish();
}

Error
detail::StreamState::measureNoise()
{
  Result<MeasuredTraits> measured =
      measureSampledTraits(loader(threads), frame, params.fit, ranks(), stats.noise_thinning);
  if (!measured) return measured.error();
  traits = measured->traits;
  FitStatistics& fit = sum.sum();
  const double seconds = fit.seconds_noise;
  fit = measured->statistics;
  fit.seconds_noise = seconds;
  return {};
}

/** Finds a tile's first level, and how much its halo has. \param[out] wanted the cells of its halo */
Error
detail::StreamState::surveyTile(std::size_t tile, std::vector<unsigned char>& sample,
                                std::vector<char>& wanted)
{
  const TileLoader tiles = loader(threads);
  std::vector<unsigned char> records;
  if (Error error = tiles.loadCore(tile, records)) return error;
  addSample(records, sample);
  const CloudView core = tiles.record().view(records);
  // What is left over at the end of a node has no room for balls of a whole tile's.
  const std::uint64_t most = std::min(params.firstBallPoints(), core.size / kBallsOfSmallTile);
  std::vector<std::uint64_t> gathered;
  int level = detail::firstLevel(core, frame, radii, most, traits.lambda, gathered);
  std::vector<std::uint64_t> cells;
  std::uint64_t halo_points = 0;
  const auto look = [&] {
    cells = tiles.haloCells(tile, tiles.maskOf(tile, records, radii.reach(level)));
    halo_points = 0;
    for (const std::uint64_t c : cells) halo_points += plan.cells[c].points;
  };
  look();
  // A sparse tile beside a dense part of the cloud begins with narrower balls.
  while (static_cast<double>(core.size + halo_points) >
             kMostLoaded * static_cast<double>(params.tile_points) &&
         isFirstLevel(radii, level + 1, traits.lambda)) {
    ++level;
    look();
  }
  first_levels.push_back(level);
  halos.push_back(halo_points);
  // Balls hold points of the halo, which were not counted, as they hold those of the core.
  balls.push_back(gathered[static_cast<std::size_t>(level)] * (core.size + halo_points) /
                  core.size);
  for (const std::uint64_t c : cells) wanted[c] = 1;
  return {};
}

/** Looks at each tile before the first is fitted. */
Error
detail::StreamState::survey(Progress* progress)
{
  radii = levelRadii(frame, params.fit);
  std::vector<unsigned char> sample;
  std::vector<char> wanted(plan.cells.size(), 0);
  for (std::size_t t = firstTile(); t < endTile(); ++t) {
    if (progress != nullptr && progress->cancelled()) return cancelled();
    if (Error error = surveyTile(t, sample, wanted)) return error;
  }
  if (!isAlone()) {
    first_levels = allOf(ranks(), first_levels);
    halos = allOf(ranks(), halos);
    balls = allOf(ranks(), balls);
    gather(ranks(), sample);
    if (Error error = fetchHalo(wanted)) return error;
  }
  counts = CellCounts();
  return fitCoarse(sample);
}

/** The records of a tile's core and halo. */
Error
detail::StreamState::load(std::size_t tile, int with_threads,
                          std::vector<unsigned char>& records) const
{
  const TileLoader tiles = loader(with_threads);
  records.reserve((plan.tiles[tile].points + halos[tile]) * tiles.record().bytes());
  if (Error error = tiles.loadCore(tile, records)) return error;
  const HaloMask mask = tiles.maskOf(tile, records, radii.reach(first_levels[tile]));
  return tiles.loadHalo(tile, mask, records);
}

}  // namespace pcl_slim

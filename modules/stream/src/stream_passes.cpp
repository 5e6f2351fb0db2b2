// SPDX-License-Identifier: BSD-3-Clause
// What a fit by tiles finds before the first tile is fitted: frame, cells, sorted points, noise,
// levels.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/cloud/detail/cloud_reader.h"
#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/cloud/side_evidence.h"
#include "pcl_slim/cloud/store_frame.h"
#include "pcl_slim/core/random.h"
#include "pcl_slim/fit/tile_fit.h"
#include "pcl_slim/stream/ranks.h"
#include "stream_state.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::size_t kBalls = 31;
constexpr std::uint64_t kCounted = 65536;  ///< points that balls are counted on, about
constexpr double kWideBall = 32.0;         ///< the same of balls that average noise well
constexpr double kNoiseOfBall = 16.0;  ///< sqrt(lambda) in the radius of the narrowest first ball

using Place = std::array<float, 3>;

/** Some of a tile's points in local units, and the places of the balls. */
struct Sample {
  std::vector<Place> points, centers;
  std::uint64_t thinning = 1;
};

Sample takeSample(const CloudView& core, const StoreFrame& frame) {
  Sample sample;
  sample.thinning = std::max<std::uint64_t>(1, core.count() / kCounted);
  const CloudReader reader(core);
  std::vector<std::pair<std::uint64_t, Place>> least;
  for (std::size_t i = 0; i < core.count(); ++i) {
    const auto p = reader.position(i);
    const std::uint64_t hash = placeHash(p);
    if (hash % sample.thinning != 0) continue;
    Place local;
    for (std::size_t a = 0; a < 3; ++a)
      local[a] = static_cast<float>((p[a] - frame.origin[a]) / frame.scale);
    sample.points.push_back(local);
    least.emplace_back(hash / sample.thinning, local);
  }
  const std::size_t balls = std::min(kBalls, least.size());
  std::partial_sort(least.begin(), least.begin() + static_cast<std::ptrdiff_t>(balls), least.end());
  for (std::size_t b = 0; b < balls; ++b) sample.centers.push_back(least[b].second);
  return sample;
}

/** How many points a ball has at each level. */
std::vector<std::uint32_t> countLevels(const Sample& sample, const Place& center,
                                       const LevelRadii& radii) {
  std::vector<float> limits;
  for (int level = 1; level <= radii.last; ++level) {
    const double r = radii.radius(level);
    limits.push_back(static_cast<float>(r * r));
  }
  std::vector<std::uint32_t> counts(limits.size() + 1,
                                    0);  // by the finest level that contains a point
  for (const Place& p : sample.points) {
    const float x = p[0] - center[0], y = p[1] - center[1], z = p[2] - center[2];
    const float d = x * x + y * y + z * z;
    std::size_t level = 0;
    while (level < limits.size() && d < limits[level]) ++level;
    ++counts[level];
  }
  for (std::size_t k = counts.size() - 1; k > 0; --k) counts[k - 1] += counts[k];
  return counts;
}

/** \brief The coarsest level of which a tile's median ball has at most a given number of the tile's
 * points, but no finer one than balls of 32 sqrt(lambda), which average noise well.
 *
 * Counts 31 balls on some 65,000 of the points, chosen by their places: the points' order changes
 * nothing. \param[out] gathered by level, the most points that one of these balls reaches.
 * O(points). */
int firstLevel(const CloudView& core, const StoreFrame& frame, const LevelRadii& radii,
               std::uint64_t most_points, double lambda, std::vector<std::uint64_t>& gathered) {
  const Sample sample = takeSample(core, frame);
  gathered.assign(static_cast<std::size_t>(radii.last) + 1, 0);
  std::vector<std::uint32_t> crowded(static_cast<std::size_t>(radii.last) + 1, 0);
  for (const Place& center : sample.centers) {
    const std::vector<std::uint32_t> counts = countLevels(sample, center, radii);
    for (std::size_t k = 1; k < crowded.size(); ++k)
      crowded[k] += counts[k] * sample.thinning > most_points;
    // A ball reaches as far as one of the level above is wide.
    for (std::size_t k = 1; k < crowded.size(); ++k)
      gathered[k] = std::max(gathered[k], counts[k - 1] * sample.thinning);
  }
  int level = 1;
  while (level < radii.last && 2 * crowded[static_cast<std::size_t>(level)] > sample.centers.size())
    ++level;
  while (level > 1 && radii.radius(level) < kWideBall * std::sqrt(lambda)) --level;
  return level;
}

/** \brief Whether balls of a level are wide enough to begin with where memory requires narrow ones:
 * those of less than 16 sqrt(lambda) do not average noise. */
bool isFirstLevel(const LevelRadii& radii, int level, double lambda) {
  return level <= radii.last && radii.radius(level) >= kNoiseOfBall * std::sqrt(lambda);
}

constexpr std::uint64_t kWindows = 32;
constexpr std::uint64_t kWindowPoints = 32768;
constexpr double kSlack = 1.25;  ///< larger windows are cut [points of a window]
constexpr std::uint64_t kThinningStep = 4;

/** Cells [first, end) of one window. */
struct Window {
  std::size_t first, end;
};

/** Windows of points_of_window points each about evenly spread places; neighbours that meet do not
 * overlap. */
std::vector<Window> windowsOf(const TilePlan& plan, std::uint64_t points_of_window) {
  std::vector<Window> windows;
  std::size_t cell = 0;
  std::uint64_t before = 0;  // points of the cells before it
  for (std::uint64_t w = 0; w < kWindows; ++w) {
    const std::uint64_t middle = (2 * w + 1) * (plan.points / (2 * kWindows));
    const std::uint64_t begin = middle - std::min(middle, points_of_window / 2);
    for (; cell < plan.cells.size() && before + plan.cells[cell].points <= begin; ++cell)
      before += plan.cells[cell].points;
    const Window window{cell, cell};
    windows.push_back(window);
    const std::uint64_t first = before;
    for (; cell < plan.cells.size() && before - first < points_of_window; ++cell)
      before += plan.cells[cell].points;
    windows.back().end = cell;
    if (window.first == cell) windows.pop_back();
  }
  return windows;
}

/** Keeps the points of least Morton codes, ties by place, where a window has too many. */
void cutWindow(const StoreFrame& frame, const PointRecord& record, int threads,
               std::vector<unsigned char>& records) {
  const std::size_t step = record.bytes(), count = records.size() / step;
  if (static_cast<double>(count) <= kSlack * static_cast<double>(kWindowPoints)) return;
  const CloudView view = record.view(records);
  const CloudReader reader(view);
  PointKeys keys(frame, threads);
  const AlignedVector<std::uint64_t>& codes = keys.of(view);
  std::vector<std::uint32_t> order(count);
  for (std::uint32_t i = 0; i < count; ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return codes[a] != codes[b] ? codes[a] < codes[b] : reader.position(a) < reader.position(b);
  });
  std::vector<unsigned char> kept;
  for (std::size_t i = 0; i < kWindowPoints; ++i) {
    const auto from = records.begin() + static_cast<std::ptrdiff_t>(order[i] * step);
    kept.insert(kept.end(), from, from + static_cast<std::ptrdiff_t>(step));
  }
  records.swap(kept);
}

/** The windows' points at rank 0, none at the others. */
Error takeSample(const TileLoader& loader, const StoreFrame& frame,
                 const std::vector<Window>& windows, std::uint64_t thinning, int threads,
                 Ranks& ranks, std::vector<unsigned char>& all) {
  std::vector<unsigned char> records;
  for (const Window& window : windows) {
    records.clear();
    if (Error error = loader.loadCells(window.first, window.end, thinning, records)) return error;
    gather(ranks, records);
    if (windows.size() > 1) cutWindow(frame, loader.record(), threads, records);
    all.insert(all.end(), records.begin(), records.end());
  }
  return {};
}

Result<MeasuredTraits> measureSample(const TileLoader& loader, const StoreFrame& frame,
                                     const FitParams& params, const TraitsSample& how,
                                     const std::vector<unsigned char>& sample) {
  Result<PointStore> store = PointStore::build(loader.record().view(sample), frame, params.threads);
  if (!store) return store.error();
  return measureTraits(*store, params, how);
}

/** The measurements of rank 0 that all ranks need. */
struct Verdict {
  CloudTraits traits;
  bool noise_fills;
};

/** \brief Measures the traits of a cloud on disk.
 *
 * The sample is 32 windows of 32,768 points, each of whole cells that follow each other along the
 * Morton curve: at full density, so that patches of neighbours are the cloud's own. Where noise
 * fills the widest patch that a window has room for, windows of 4, 16, ... times as many points
 * take their place, of which every 4th, 16th, ... is kept; in the end they are the whole cloud.
 * Clouds of about as few points as the windows have are taken whole. A function of the points' set
 * alone. Rank 0 has the statistics, all have the traits.
 */
Result<MeasuredTraits> measureSampledTraits(const TileLoader& loader, const StoreFrame& frame,
                                            const FitParams& params, Ranks& ranks,
                                            std::uint64_t& thinning) {
  const TilePlan& plan = loader.plan();
  const std::uint64_t sample = kWindows * kWindowPoints;
  double spacing = 0;  // of the cloud as it is
  for (thinning = 1;; thinning *= kThinningStep) {
    const bool whole = static_cast<double>(plan.points) <=
                       kSlack * static_cast<double>(sample) * static_cast<double>(thinning);
    if (whole) thinning = std::max<std::uint64_t>(1, plan.points / sample);
    const std::vector<Window> windows = whole ? std::vector<Window>{{0, plan.cells.size()}}
                                              : windowsOf(plan, kWindowPoints * thinning);
    std::vector<unsigned char> points;
    if (Error error = takeSample(loader, frame, windows, thinning, params.threads, ranks, points))
      return error;
    TraitsSample how;
    how.windows = windows.size();
    how.thinning = static_cast<std::size_t>(thinning);
    Result<MeasuredTraits> measured = MeasuredTraits();
    if (ranks.rank() == 0) measured = measureSample(loader, frame, params, how, points);
    if (!measured) return measured;
    const Verdict verdict = ofFirst(ranks, Verdict{measured->traits, measured->noise_fills});
    measured->traits = verdict.traits;
    measured->noise_fills = verdict.noise_fills;
    if (thinning == 1) spacing = measured->traits.spacing;
    measured->traits.spacing = spacing;
    if (!measured->noise_fills || whole) return measured;
  }
}

constexpr std::uint64_t kCellsOfTile =
    64;  ///< cells of more than such a part of a tile are divided
constexpr std::uint64_t kBallsOfSmallTile = 8;
constexpr double kMostLoaded = 1.7;  ///< [tile points] of a tile with its halo

}  // namespace

/** A pass over the source that reports its progress between begin and end. */
Error detail::StreamState::pass(PointSource& source, Progress* progress, float begin, float end,
                                const char* stage, const PointSource::Visit& visit) {
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

Error detail::StreamState::measureFrame(PointSource& source, Progress* progress) {
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

Error detail::StreamState::countCells(PointSource& source, Progress* progress) {
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

Error detail::StreamState::sortPoints(PointSource& source, Progress* progress) {
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

Error detail::StreamState::measureNoise() {
  Result<MeasuredTraits> measured =
      measureSampledTraits(loader(threads), frame, params.fit, ranks(), stats.noise_thinning);
  if (!measured) return measured.error();
  traits = measured->traits;
  FitStatistics& fit = sum.sum();
  const double seconds = fit.seconds.noise;
  fit = measured->statistics;
  fit.seconds.noise = seconds;
  return {};
}

/** Finds a tile's first level, and how much its halo has. \param[out] wanted the cells of its halo
 */
Error detail::StreamState::surveyTile(std::size_t tile, std::vector<unsigned char>& sample,
                                      std::vector<char>& wanted) {
  const TileLoader tiles = loader(threads);
  std::vector<unsigned char> records;
  if (Error error = tiles.loadCore(tile, records)) return error;
  addSample(records, sample);
  const CloudView core = tiles.record().view(records);
  // A small last tile of a node begins with balls of fewer points than a whole tile does.
  const std::uint64_t most = std::min(params.firstBallPoints(), core.size / kBallsOfSmallTile);
  std::vector<std::uint64_t> gathered;
  int level = firstLevel(core, frame, radii, most, traits.lambda, gathered);
  std::vector<std::uint64_t> cells;
  std::uint64_t halo_points = 0;
  const auto look = [&] {
    cells = tiles.haloCells(tile, tiles.maskOf(tile, records, radii.reach(level)));
    halo_points = 0;
    for (const std::uint64_t c : cells) halo_points += plan.cells[c].points;
  };
  look();
  // A sparse tile next to a dense part of the cloud begins with narrower balls.
  while (static_cast<double>(core.size + halo_points) >
             kMostLoaded * static_cast<double>(params.tile_points) &&
         isFirstLevel(radii, level + 1, traits.lambda)) {
    ++level;
    look();
  }
  first_levels.push_back(level);
  halos.push_back(halo_points);
  // Balls contain points of the halo, which were not counted, as they contain those of the core.
  balls.push_back(gathered[static_cast<std::size_t>(level)] * (core.size + halo_points) /
                  core.size);
  for (const std::uint64_t c : cells) wanted[c] = 1;
  return {};
}

/** Looks at each tile before the first is fitted. */
Error detail::StreamState::survey(Progress* progress) {
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
Error detail::StreamState::load(std::size_t tile, int with_threads,
                                std::vector<unsigned char>& records) const {
  const TileLoader tiles = loader(with_threads);
  records.reserve((plan.tiles[tile].points + halos[tile]) * tiles.record().bytes());
  if (Error error = tiles.loadCore(tile, records)) return error;
  const HaloMask mask = tiles.maskOf(tile, records, radii.reach(first_levels[tile]));
  return tiles.loadHalo(tile, mask, records);
}

// Levels above the tiles' first, from a sample of the cloud.

namespace {

constexpr std::uint64_t kLeastSample = 1 << 19;  ///< points
constexpr std::uint64_t kPointsPerTile =
    4000;  ///< gives a tile's first ball 80, up to a tile's points in all

}  // namespace

/** Points that one of the sample represents. */
std::uint64_t detail::StreamState::coarseThinning() const {
  const std::uint64_t wanted =
      std::max(kLeastSample, std::min(params.tile_points, kPointsPerTile * plan.tiles.size()));
  return std::max<std::uint64_t>(1, plan.points / wanted);
}

/** Adds a share of a tile's points, chosen by their places. */
void detail::StreamState::addSample(const std::vector<unsigned char>& core,
                                    std::vector<unsigned char>& sample) const {
  const std::size_t step = store.record().bytes();
  const CloudView view = store.record().view(core);
  const CloudReader reader(view);
  const std::uint64_t thinning = coarseThinning();
  for (std::size_t i = 0; i < view.count(); ++i) {
    if (placeHash(reader.position(i)) % thinning != 0) continue;
    const auto from = core.begin() + static_cast<std::ptrdiff_t>(i * step);
    sample.insert(sample.end(), from, from + static_cast<std::ptrdiff_t>(step));
  }
}

/** First level of the tile at a Morton code; between two tiles the finer one's. */
int detail::StreamState::firstLevelAt(std::uint64_t key) const {
  const auto next =
      std::upper_bound(plan.tiles.begin(), plan.tiles.end(), key,
                       [](std::uint64_t k, const TilePlan::Tile& t) { return k < t.first_key; });
  const auto after = static_cast<std::size_t>(next - plan.tiles.begin());
  const int before = after > 0 ? first_levels[after - 1] : 0;
  const bool inside = after > 0 && key < plan.tiles[after - 1].end_key;
  return inside || next == plan.tiles.end() ? before : std::max(before, first_levels[after]);
}

/** Fits the levels that no tile has; where a tile begins with a coarse level, what is below it is
 * dropped. */
Error detail::StreamState::fitCoarse(const std::vector<unsigned char>& sample) {
  CoarseJob job;
  for (const int level : first_levels) job.last_level = std::max(job.last_level, level - 1);
  job.traits = traits;
  job.thinning = coarseThinning();
  if (sample.empty()) return {};  // of other ranks than the first
  const Result<PointStore> points = PointStore::build(store.record().view(sample), frame, threads);
  if (!points) return points.error();
  const SideEvidence seen = findSideEvidence(*points, {});  // a kept plan suits any viewpoint
  sum.sum().sides.source = seen.source;
  if (seen.source == SideSource::kOrigin) frame.sensor = seen.eye;
  SLIMSurface all;
  if (Error error = fitCoarseLevels(*points, params.fit, job, all)) return error;
  coarse.info = all.info;
  for (std::size_t i = 0, begin = 0; i <= all.size(); ++i) {
    const bool kept =
        i < all.size() && all.level[i] < firstLevelAt(mortonCode(all.cx[i], all.cy[i], all.cz[i]));
    if (kept) continue;
    if (begin < i) coarse.append(all.slice(begin, i));
    begin = i + 1;
  }
  coarse.info.num_points = plan.points;
  return {};
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// The steps of docs/color_octree_splat_sampler.md, "How": a grid of cubes, their division, discs.
#include "pcl_slim/splat/splat_sampling.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <vector>

#include "disc/sample_noise.h"
#include "disc/splat_builder.h"
#include "octree/cell_batch.h"
#include "octree/color_octree.h"
#include "octree/octree_cut.h"
#include "octree/octree_runs.h"
#include "pcl_slim/cloud/detail/cloud_reader.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/stopwatch.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

using namespace detail;

namespace {

/** The settings of each step of the sampling (docs/color_octree_splat_sampler.md). */
struct SamplingPlan {
  SplatParams params;  ///< paper mode and the number of threads put in

  explicit SamplingPlan(const SplatParams& given);

  bool hasBudget() const { return params.max_splats > 0 || params.target_error > 0; }
  /** Whether cells are taken as the initial grid has them. */
  bool isUniform() const { return params.max_depth == 0 && !hasBudget(); }
  /** Whether discs follow their neighbours. */
  bool needsNeighbors() const { return params.radius == RadiusRule::kNeighbors; }
  /** Whether any rule takes noise off; else it is not measured. */
  bool needsNoise() const;

  /** Step 1: the grid of cubes. */
  RootGrid rootGrid() const;
  /** Step 2: when a cube is halved. */
  SplitRule splitRule(const SampleNoise& noise, bool normals_estimated) const;
};

constexpr double kPointsPerRoot = 50.0;  ///< the paper's own start: 2 % of the points
constexpr double kRootsPerSplat = 0.25;  ///< budgets start from cells twice as wide as even ones
constexpr double kPointsPerErrorRoot = 256.0;  ///< budgets of error: coarse enough for any error
constexpr double kColorOff = 1.0;              ///< a colour error from here on ignores colour
constexpr double kLabPerUnit = 100.0;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

SamplingPlan::SamplingPlan(const SplatParams& given) : params(given)
{
  params.threads = resolveThreads(params.threads);
  if (params.paper_mode) {
    params.rgb_space = RgbSpace::kEbu;
    params.color = SplatColor::kOwn;
    params.radius = RadiusRule::kCorner;
    params.remove_noise = false;
    params.min_points = 2;
  }
}

bool
SamplingPlan::needsNoise() const
{
  const bool by_bend = params.radius == RadiusRule::kDensity;
  const bool shapes = params.color == SplatColor::kGradient || by_bend;
  return params.remove_noise && (shapes || !isUniform());
}

RootGrid
SamplingPlan::rootGrid() const
{
  RootGrid grid;
  if (params.max_splats > 0) {
    grid.occupied = kRootsPerSplat * static_cast<double>(params.max_splats);
  } else if (params.initial_resolution > 0) {
    grid.resolution = params.initial_resolution;
  } else {
    grid.points_per_root = params.target_error > 0 ? kPointsPerErrorRoot : kPointsPerRoot;
  }
  return grid;
}

SplitRule
SamplingPlan::splitRule(const SampleNoise& noise, bool normals_estimated) const
{
  SplitRule rule;
  rule.geometric_error = params.geometric_error;
  rule.color_error = params.color_error < kColorOff ? kLabPerUnit * params.color_error : kInfinity;
  rule.oriented = params.paper_mode && !normals_estimated;
  rule.noise = noise;
  rule.min_points = params.min_points;
  rule.max_depth = params.max_depth;
  return rule;
}

/** Divides roots until no rule requires more; leaves receives the undivided cells, in Morton order.
 * Chains of cells with the same points are skipped. */
class Divider {
 public:
  Divider(const OctreeCloud& cloud, const SplitRule& rule, const PointWindow& window,
          CellBatch& leaves)
      : cloud_(cloud),
        keys_{cloud.keys()},
        rule_(rule),
        window_(window),
        leaves_(leaves),
        color_limit_(rule.color_error * rule.color_error),
        normal_limit_(rule.geometric_error * rule.geometric_error),
        least_shift_(std::max(0, cloud.depth() - rule.max_depth))
  {
  }

  void root(std::size_t begin, std::size_t end) { divide(begin, end, cloud_.depth(), 0.0); }

 private:
  void divide(std::size_t begin, std::size_t end, int shift, double spacing)
  {
    const std::size_t n = end - begin;
    const CellSums sums = sumsOf(window_, begin, end);
    if (n >= kSpacingPoints) spacing = sums.spacing();
    if (n > 1 && n >= rule_.min_points && least_shift_ < shift && asksForMore(sums)) {
      const int children = keys_.dividingShift(begin, end);
      if (children >= least_shift_) {
        for (std::size_t at = begin; at < end;) {
          const std::size_t next = keys_.runEnd(at, end, children);
          divide(at, next, children, spacing);
          at = next;
        }
        return;
      }
      shift = std::min(shift, least_shift_);
    }
    leaves_.add({static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end),
                 static_cast<float>(spacing), shift},
                sums);
  }

  bool asksForMore(const CellSums& sums) const
  {
    const double slack = 1.0 + rule_.noise_z / std::sqrt(sums.count - 1.0);
    if (sums.colorVariance() > color_limit_ + rule_.noise.color * slack) return true;
    const double limit = normal_limit_ + rule_.noise.normal * slack;
    return rule_.oriented ? sums.orientedVariance() > limit : sums.unorientedAbove(limit);
  }

  const OctreeCloud& cloud_;
  RunKeys keys_;
  const SplitRule& rule_;
  const PointWindow& window_;
  CellBatch& leaves_;
  double color_limit_, normal_limit_;
  int least_shift_;
};

/** Divides every occupied root cell; leaves(slice, window, batch) for the cells of each slice that stay
 * whole, in Morton order. O(N) per level that is divided; the same cells for any number of threads. */
template <typename Leaves>
void
divideByTolerance(const OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule,
                  int threads, const Leaves& leaves)
{
  std::vector<PointWindow> windows(static_cast<std::size_t>(threads));
  std::vector<CellBatch> batches(windows.size());
  forEachRootSlice(cloud, 0, threads,
                   [&](std::size_t slice, std::size_t thread, std::size_t first, std::size_t last) {
                     PointWindow& window = windows[thread];
                     CellBatch& batch = batches[thread];
                     window.loadAround(cloud, source, cloud.root(first).begin,
                                       cloud.root(last).begin, kSpacingReach);
                     batch.clear();
                     Divider divider(cloud, rule, window, batch);
                     for (std::size_t r = first; r < last; ++r) {
                       divider.root(cloud.root(r).begin, cloud.root(r + 1).begin);
                     }
                     leaves(slice, window, batch);
                   });
}

constexpr std::size_t kCellSlice = 256;  ///< cells whose points are brought together at a time

/** Whether any finite point of the view has a usable normal. */
bool
hasNormals(const CloudView& cloud)
{
  if (!cloud.normal) return false;
  const CloudReader reader(cloud);
  for (std::size_t i = 0; i < cloud.count(); ++i) {
    const std::size_t input = cloud.inputIndex(i);
    if (reader.hasNormal(input) && isFinite(reader.position(input))) return true;
  }
  return false;
}

/** The stages of sampleSplats. */
class Sampling {
 public:
  Sampling(const CloudView& cloud, const ColorView& colors, const SplatParams& params,
           SplatStatistics& statistics, Progress& progress)
      : view_(cloud),
        colors_(colors),
        plan_(params),
        statistics_(statistics),
        progress_(progress),
        table_(plan_.params.rgb_space)
  {
  }

  Error run(SplatSet& splats)
  {
    if (!begin(0.0f, "ordering")) return cancelled();
    Result<OctreeCloud> cloud =
        OctreeCloud::build(view_, plan_.rootGrid(), params().threads, colors_);
    if (!cloud) return cloud.error();
    statistics_.seconds_order = watch_.lap();
    if (needsNormals() || plan_.needsNeighbors()) {
      if (!begin(0.2f, "neighbours")) return cancelled();
      if (Error error = findNeighbors()) return error;
    }
    statistics_.seconds_normals = watch_.lap();
    if (!begin(0.6f, "dividing")) return cancelled();
    const OctreeSource source{view_, colors_, table_};
    SplatBuilder builder = divide(*cloud, source);
    statistics_.seconds_divide = watch_.lap();
    if (!begin(0.9f, "splats")) return cancelled();
    builder.finish(store_ ? &*store_ : nullptr, splats, statistics_);
    statistics_.seconds_splats = watch_.lap();
    return begin(1.0f, "done") ? Error() : cancelled();
  }

 private:
  /** Reports the next stage. false: the caller cancelled. */
  bool begin(float fraction, const char* stage)
  {
    progress_.report(fraction, stage);
    return !progress_.cancelled();
  }

  static Error cancelled() { return {ErrorCode::kCancelled, "the sampling was cancelled"}; }

  bool needsNormals()
  {
    if (!has_normals_) has_normals_ = hasNormals(view_);
    return !*has_normals_;
  }

  CloudView positionsOnly() const
  {
    CloudView view = view_;
    view.normal = nullptr;
    return view;
  }

  /** Neighbours of all points, and normals from them where there are none. */
  Error findNeighbors()
  {
    Result<PointStore> store = PointStore::build(positionsOnly(), params().threads);
    if (!store) return store.error();
    store_ = std::move(*store);
    if (!needsNormals()) return {};
    normals_ = estimateNormals(*store_, view_, params().normal_neighbors, params().viewpoint,
                               params().threads);
    view_.normal = normals_.data();
    view_.normal_stride = 3 * sizeof(float);
    statistics_.normals_estimated = true;
    return {};
  }

  void describe(const OctreeCloud& cloud, const SampleNoise& noise)
  {
    statistics_.points = cloud.size();
    statistics_.non_finite = cloud.numNonFinite();
    statistics_.duplicates = cloud.numDuplicates();
    statistics_.roots = cloud.numRoots();
    statistics_.resolution = cloud.resolution();
    statistics_.cell = cloud.cell();
    statistics_.color_noise = std::sqrt(noise.color);
    statistics_.normal_noise = std::sqrt(noise.normal);
  }

  /** Cells and their discs, by tolerances or by a budget. source must outlive the builder. */
  SplatBuilder divide(const OctreeCloud& cloud, const OctreeSource& source)
  {
    const SampleNoise noise =
        plan_.needsNoise() ? estimateSampleNoise(cloud, source, params().threads) : SampleNoise();
    describe(cloud, noise);
    const SplitRule rule = plan_.splitRule(noise, statistics_.normals_estimated);
    return plan_.hasBudget() ? cut(cloud, source, rule) : divideByRule(cloud, source, rule);
  }

  SplatBuilder divideByRule(const OctreeCloud& cloud, const OctreeSource& source,
                            const SplitRule& rule)
  {
    SplatBuilder builder(cloud, source, params(), rule.noise, numRootSlices(cloud));
    divideByTolerance(cloud, source, rule, params().threads,
                      [&](std::size_t slice, const PointWindow& window, const CellBatch& leaves) {
                        builder.add(slice, window, leaves);
                      });
    return builder;
  }

  SplatBuilder cut(const OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule)
  {
    const OctreeCut cut = cutOptimally(
        cloud, source, rule, {params().max_splats, params().target_error}, params().threads);
    statistics_.tree_cells = cut.nodes;
    statistics_.error = cut.error;
    const std::size_t slices = (cut.cells.size() + kCellSlice - 1) / kCellSlice;
    SplatBuilder builder(cloud, source, params(), rule.noise, slices);
    std::vector<PointWindow> windows(static_cast<std::size_t>(params().threads));
    std::vector<CellBatch> batches(windows.size());
    parallelFor(slices, params().threads, 1, [&](std::size_t slice, int thread) {
      PointWindow& window = windows[static_cast<std::size_t>(thread)];
      CellBatch& batch = batches[static_cast<std::size_t>(thread)];
      const auto first = cut.cells.begin() + static_cast<std::ptrdiff_t>(slice * kCellSlice);
      const auto last = cut.cells.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                cut.cells.size(), (slice + 1) * kCellSlice));
      window.loadAround(cloud, source, first->begin, (last - 1)->end, kSpacingReach);
      batch.clear();
      for (auto cell = first; cell != last; ++cell) {
        batch.add(*cell, sumsOf(window, cell->begin, cell->end));
      }
      builder.add(slice, window, batch);
    });
    return builder;
  }

  const SplatParams& params() const { return plan_.params; }

  CloudView view_;
  ColorView colors_;
  SamplingPlan plan_;
  SplatStatistics& statistics_;
  Progress& progress_;
  LabTable table_;
  std::optional<PointStore> store_;
  std::optional<bool> has_normals_;
  std::vector<float> normals_;
  Stopwatch watch_;
};

}  // namespace

Error
sampleSplats(const CloudView& cloud, const ColorView& colors, const SplatParams& params,
             SplatSet& splats, SplatStatistics* statistics, Progress* progress)
{
  splats = SplatSet();
  SplatStatistics own_statistics;
  Progress own_progress;
  SplatStatistics& counts = statistics ? *statistics : own_statistics;
  counts = {};
  Error error = params.validate();
  if (!error) {
    error =
        Sampling(cloud, colors, params, counts, progress ? *progress : own_progress).run(splats);
  }
  if (error) splats = SplatSet();
  return error;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/splat/splat_sampling.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

#include "disc/sample_noise.h"
#include "disc/splat_builder.h"
#include "octree/octree_cut.h"
#include "octree/tolerance_division.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr double kPointsPerRoot = 50.0;  ///< the paper's own start: 2 % of the points
constexpr double kRootsPerSplat = 0.25;  ///< budgets start from cells twice as wide as even ones
constexpr double kPointsPerErrorRoot = 256.0;
constexpr double kColorOff = 1.0;  ///< a colour error from here on ignores colour
constexpr double kLabPerUnit = 100.0;
constexpr std::size_t kCellSlice = 256;  ///< cells whose points are brought together at a time

/** Whether any point asked for has a usable normal. */
bool
hasNormals(const CloudView& cloud)
{
  if (!cloud.normal) return false;
  const auto* base = static_cast<const unsigned char*>(cloud.normal);
  for (std::size_t i = 0; i < cloud.count(); ++i) {
    const auto* n =
        reinterpret_cast<const float*>(base + cloud.inputIndex(i) * cloud.normal_stride);
    const float sq = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    if (sq > 1e-24f && std::isfinite(sq)) return true;
  }
  return false;
}

SplatParams
resolved(SplatParams params)
{
  params.threads = resolveThreads(params.threads);
  if (params.paper_mode) {
    params.rgb_space = RgbSpace::kEbu;
    params.color = SplatColor::kOwn;
    params.radius = RadiusRule::kCorner;
    params.remove_noise = false;
    params.min_points = 2;
  }
  return params;
}

/** The stages of sampleSplats. */
class Sampling {
 public:
  Sampling(const CloudView& cloud, const ColorView& colors, const SplatParams& params,
           SplatStatistics& statistics, Progress& progress)
      : view_(cloud),
        colors_(colors),
        params_(resolved(params)),
        statistics_(statistics),
        progress_(progress),
        table_(params_.rgb_space)
  {
  }

  Error run(SplatSet& splats)
  {
    if (!begin(0.0f, "ordering")) return cancelled();
    Result<OctreeCloud> cloud = OctreeCloud::build(view_, rootGrid(), params_.threads);
    if (!cloud) return cloud.error();
    statistics_.seconds_order = lap();
    if (needsNormals() || params_.radius == RadiusRule::kNeighbors) {
      if (!begin(0.2f, "neighbours")) return cancelled();
      if (Error error = findNeighbors()) return error;
    }
    statistics_.seconds_normals = lap();
    if (!begin(0.6f, "dividing")) return cancelled();
    const OctreeSource source{view_, colors_, table_};
    const SampleNoise noise =
        needsNoise() ? estimateSampleNoise(*cloud, source, params_.threads) : SampleNoise();
    describe(*cloud, noise);
    SplatBuilder builder =
        !hasBudget() ? divide(*cloud, source, noise) : cut(*cloud, source, noise);
    statistics_.seconds_divide = lap();
    if (!begin(0.9f, "splats")) return cancelled();
    builder.finish(store_ ? &*store_ : nullptr, splats, statistics_);
    statistics_.seconds_splats = lap();
    return begin(1.0f, "done") ? Error() : cancelled();
  }

 private:
  /** Says what comes next. false: the caller asked to stop. */
  bool begin(float fraction, const char* stage)
  {
    progress_.report(fraction, stage);
    return !progress_.cancelled();
  }

  static Error cancelled() { return {ErrorCode::kCancelled, "the sampling was cancelled"}; }

  double lap()
  {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

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

  bool hasBudget() const { return params_.max_splats > 0 || params_.target_error > 0; }

  /** Whether cells are taken as the initial grid has them. */
  bool isUniform() const { return params_.max_depth == 0 && !hasBudget(); }

  RootGrid rootGrid() const
  {
    const auto n = static_cast<double>(view_.count());
    RootGrid grid;
    if (params_.max_splats > 0) {
      grid.occupied = kRootsPerSplat * static_cast<double>(params_.max_splats);
    } else if (params_.initial_resolution > 0) {
      grid.resolution = params_.initial_resolution;
    } else {
      grid.occupied = n / (params_.target_error > 0 ? kPointsPerErrorRoot : kPointsPerRoot);
    }
    // What lies below is put in order where a cell is divided, and a budget's tree divides all.
    if (!hasBudget()) grid.per_key = kPointsPerRoot;
    if (isUniform()) grid.per_key = std::numeric_limits<double>::infinity();
    return grid;
  }

  /** What no rule would take off is not measured. */
  bool needsNoise() const
  {
    const bool by_bend = params_.radius == RadiusRule::kDensity;
    const bool shapes = params_.color == SplatColor::kGradient || by_bend;
    return params_.remove_noise && (shapes || !isUniform());
  }

  /** Neighbours of all points, and normals from them where there are none. */
  Error findNeighbors()
  {
    Result<PointStore> store = PointStore::build(positionsOnly(), params_.threads);
    if (!store) return store.error();
    store_ = std::move(*store);
    if (!needsNormals()) return {};
    normals_ = estimateNormals(*store_, view_, params_.normal_neighbors, params_.viewpoint,
                               params_.threads);
    view_.normal = normals_.data();
    view_.normal_stride = 3 * sizeof(float);
    statistics_.normals_estimated = true;
    return {};
  }

  void describe(const OctreeCloud& cloud, const SampleNoise& noise)
  {
    statistics_.points = cloud.size();
    statistics_.non_finite = cloud.numNonFinite();
    statistics_.roots = cloud.numRoots();
    statistics_.resolution = cloud.resolution();
    statistics_.cell = cloud.cell();
    statistics_.color_noise = std::sqrt(noise.color);
    statistics_.normal_noise = std::sqrt(noise.normal);
  }

  SplitRule ruleOf(const SampleNoise& noise) const
  {
    SplitRule rule;
    rule.geometric_error = params_.geometric_error;
    rule.color_error = params_.color_error < kColorOff ? kLabPerUnit * params_.color_error
                                                       : std::numeric_limits<double>::infinity();
    rule.oriented = params_.paper_mode && !statistics_.normals_estimated;
    rule.noise = noise;
    rule.min_points = params_.min_points;
    rule.max_depth = params_.max_depth;
    return rule;
  }

  SplatBuilder divide(const OctreeCloud& cloud, const OctreeSource& source,
                      const SampleNoise& noise)
  {
    SplatBuilder builder(cloud, source, params_, noise, numRootSlices(cloud));
    divideByTolerance(cloud, source, ruleOf(noise), params_.threads,
                      [&](std::size_t slice, const PointWindow& window, const CellBatch& leaves) {
                        builder.add(slice, window, leaves);
                      });
    return builder;
  }

  SplatBuilder cut(OctreeCloud& cloud, const OctreeSource& source, const SampleNoise& noise)
  {
    const OctreeCut cut = cutOptimally(cloud, source, ruleOf(noise),
                                       {params_.max_splats, params_.target_error}, params_.threads);
    statistics_.tree_cells = cut.nodes;
    statistics_.error = cut.error;
    const std::size_t slices = (cut.cells.size() + kCellSlice - 1) / kCellSlice;
    SplatBuilder builder(cloud, source, params_, noise, slices);
    std::vector<PointWindow> windows(static_cast<std::size_t>(params_.threads));
    std::vector<CellBatch> batches(windows.size());
    parallelFor(slices, params_.threads, 1, [&](std::size_t slice, int thread) {
      PointWindow& window = windows[static_cast<std::size_t>(thread)];
      const std::size_t first = slice * kCellSlice;
      const std::size_t last = std::min(cut.cells.size(), first + kCellSlice);
      const std::size_t begin = cut.cells[first].begin, end = cut.cells[last - 1].end;
      window.load(cloud, source, begin - std::min(begin, kSpacingReach),
                  std::min(cloud.size(), end + kSpacingReach));
      CellBatch& batch = batches[static_cast<std::size_t>(thread)];
      batch.clear();
      for (std::size_t c = first; c < last; ++c) {
        const OctreeCell& cell = cut.cells[c];
        batch.add(cell, sumsOf(window, cell.begin, cell.end));
      }
      builder.add(slice, window, batch);
    });
    return builder;
  }

  CloudView view_;
  ColorView colors_;
  SplatParams params_;
  SplatStatistics& statistics_;
  Progress& progress_;
  LabTable table_;
  std::optional<PointStore> store_;
  std::optional<bool> has_normals_;
  std::vector<float> normals_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace

Error
SplatParams::validate() const
{
  const auto bad = [](const char* text) { return Error{ErrorCode::kBadArgument, text}; };
  if (initial_resolution < 0 || initial_resolution > RootGrid::kMaxResolution) {
    return bad("the initial resolution is 0 (automatic) to 1048576 cells along the longest side");
  }
  if (!(geometric_error >= 0.0)) return bad("the geometric error is a number from 0 on");
  if (!(color_error >= 0.0)) return bad("the colour error is a number from 0 on");
  if (max_depth < 0) return bad("the depth is 0 (uniform cells) or more");
  if (!(target_error >= 0.0) || std::isinf(target_error)) {
    return bad("the target error is a finite number of Delta E, 0 for none");
  }
  if (max_splats > 0 && target_error > 0) {
    return bad("a count and a target error exclude each other; set one of the two");
  }
  if (normal_neighbors < 3) return bad("a normal needs 3 neighbours or more");
  for (const double v : viewpoint) {
    if (!std::isfinite(v)) return bad("the viewpoint is not finite; give three numbers");
  }
  return {};
}

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

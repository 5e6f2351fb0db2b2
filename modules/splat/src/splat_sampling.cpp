// SPDX-License-Identifier: BSD-3-Clause
// The steps of docs/color_octree_splat_sampler.md, "How": a grid of cubes, their division, discs.
#include "pcl_slim/splat/splat_sampling.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "disc/sample_noise.h"
#include "disc/splat_builder.h"
#include "octree/octree_cut.h"
#include "octree/tolerance_division.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/stopwatch.h"
#include "sampling_plan.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::size_t kCellSlice = 256;  ///< cells whose points are brought together at a time

bool
isFinitePoint(const CloudView& cloud, std::size_t input)
{
  const auto* at = static_cast<const unsigned char*>(cloud.xyz) + input * cloud.xyz_stride;
  double p[3];
  for (std::size_t a = 0; a < 3; ++a) {
    float value;
    if (cloud.scalar == CloudView::Scalar::kDouble) {
      std::memcpy(&p[a], at + a * sizeof(double), sizeof(double));
    } else {
      std::memcpy(&value, at + a * sizeof(float), sizeof(float));
      p[a] = value;
    }
  }
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

/** Whether any point asked for that is finite has a usable normal. */
bool
hasNormals(const CloudView& cloud)
{
  if (!cloud.normal) return false;
  const auto* base = static_cast<const unsigned char*>(cloud.normal);
  for (std::size_t i = 0; i < cloud.count(); ++i) {
    const auto* n =
        reinterpret_cast<const float*>(base + cloud.inputIndex(i) * cloud.normal_stride);
    const float sq = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    const bool usable = sq > 1e-24f && std::isfinite(sq);
    if (usable && isFinitePoint(cloud, cloud.inputIndex(i))) return true;
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
  /** Says what comes next. false: the caller asked to stop. */
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

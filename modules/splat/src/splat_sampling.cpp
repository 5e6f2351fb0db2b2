// SPDX-License-Identifier: BSD-3-Clause
// The steps of docs/color_octree_splat_sampler.md, "How": a grid of cubes, their division, discs.
#include "pcl_slim/splat/splat_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "disc/splat_builder.h"
#include "octree/octree.h"
#include "pcl_slim/cloud/detail/cloud_reader.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/stopwatch.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::size_t kFewestSamples = 150, kSamples = 600;
constexpr std::size_t kPointsPerSample = 1000;  ///< between these two: noise is to cost little
constexpr std::size_t kNeighbors = 8;
// Points before and after a sample along the curve to choose neighbours from.
constexpr std::size_t kLeastReach = 12, kReach = 24;
// A sample less the mean of k neighbours has the variance of one point times (k + 1) / k.
constexpr double kMeanFactor = static_cast<double>(kNeighbors) / (kNeighbors + 1);
constexpr double kMedian3 = 3.0 / 2.36597;  ///< mean over median of chi squared, 3 degrees
// The mean squared sine to many neighbours: chi squared of 2 degrees for the sample's own share,
// whose median is 1.38629, and its mean 2 for theirs; 2 is one point's variance.
constexpr double kNormalFactor = 2.0 / (1.38629 + 2.0);

double medianOrZero(std::vector<double> values) {
  return values.empty() ? 0.0 : median(std::move(values));
}

double colorResidual(const std::array<float, 3>& lab, const CellSums& near) {
  double sum = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double d = lab[a] - near.lab[a] / near.count;
    sum += d * d;
  }
  return sum;
}

/** Mean squared sine between a normal and its neighbours'. */
double normalResidual(const std::array<float, 3>& normal, const CellSums& near) {
  const Symmetric3<double>& m = near.product;
  const double x = normal[0], y = normal[1], z = normal[2];
  const double along = m[kXX] * x * x + m[kYY] * y * y + m[kZZ] * z * z +
                       2.0 * (m[kXY] * x * y + m[kXZ] * x * z + m[kYZ] * y * z);
  return std::max(0.0, 1.0 - along / near.normals());
}

/** Sums over the window's points nearest to one of them. */
CellSums neighborsOf(const PointWindow& window, std::size_t own) {
  std::array<std::pair<float, std::size_t>, kNeighbors> nearest;
  std::size_t found = 0;
  const auto p = window.position(own);
  for (std::size_t j = window.begin(); j < window.end(); ++j) {
    if (j == own) continue;
    const auto q = window.position(j);
    float distance = 0;
    for (std::size_t a = 0; a < 3; ++a) distance += (p[a] - q[a]) * (p[a] - q[a]);
    if (found == kNeighbors && distance >= nearest.back().first) continue;
    std::size_t at = found < kNeighbors ? found++ : kNeighbors - 1;
    for (; at > 0 && nearest[at - 1].first > distance; --at) nearest[at] = nearest[at - 1];
    nearest[at] = {distance, j};
  }
  CellSums sums;
  for (const auto& [distance, j] : nearest) sums.add(window, j, j + 1);
  return sums;
}

/** Noise of colours and normals from points against their nearest neighbours.
 *
 * Some hundred samples; neighbours are taken from the samples' surroundings in Morton order, so a
 * few are farther than the nearest. The median over samples ignores edges of colour and shape as
 * long as most samples have none. 0 for fewer than 32 points. Constant time.
 */
SampleNoise estimateSampleNoise(const OctreeCloud& cloud, const OctreeSource& source, int threads) {
  SampleNoise noise;
  const std::size_t n = cloud.size();
  if (n < 4 * kNeighbors) return noise;
  const std::size_t samples =
      std::min(n, std::clamp(n / kPointsPerSample, kFewestSamples, kSamples));
  std::vector<double> color(samples), normal(samples, -1.0);
  std::vector<PointWindow> windows(static_cast<std::size_t>(threads));
  parallelFor(samples, threads, 32, [&](std::size_t s, int thread) {
    const std::size_t i = (2 * s + 1) * n / (2 * samples);
    PointWindow& window = windows[static_cast<std::size_t>(thread)];
    const std::size_t r = cloud.rootOf(i);
    const std::size_t before = std::clamp(i - cloud.root(r).begin, kLeastReach, kReach);
    const std::size_t behind = std::clamp(cloud.root(r + 1).begin - i, kLeastReach, kReach);
    window.load(cloud, source, i - std::min(i, before), std::min(n, i + behind));
    const CellSums near = neighborsOf(window, i);
    color[s] = colorResidual(window.lab(i), near);
    const auto own = window.normal(i);
    const bool has_normal = own[0] != 0 || own[1] != 0 || own[2] != 0;
    if (has_normal && near.normals() > 0) normal[s] = normalResidual(own, near);
  });
  normal.erase(std::remove(normal.begin(), normal.end(), -1.0), normal.end());
  noise.color = source.colors.bgr ? kMedian3 * kMeanFactor * medianOrZero(color) : 0.0;
  noise.normal = kNormalFactor * medianOrZero(normal);
  return noise;
}

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

SamplingPlan::SamplingPlan(const SplatParams& given) : params(given) {
  params.threads = resolveThreads(params.threads);
  if (params.paper_mode) {
    params.rgb_space = RgbSpace::kEbu;
    params.color = SplatColor::kOwn;
    params.radius = RadiusRule::kCorner;
    params.remove_noise = false;
    params.min_points = 2;
  }
}

bool SamplingPlan::needsNoise() const {
  const bool by_bend = params.radius == RadiusRule::kDensity;
  const bool shapes = params.color == SplatColor::kGradient || by_bend;
  return params.remove_noise && (shapes || !isUniform());
}

RootGrid SamplingPlan::rootGrid() const {
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

SplitRule SamplingPlan::splitRule(const SampleNoise& noise, bool normals_estimated) const {
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
        least_shift_(std::max(0, cloud.depth() - rule.max_depth)) {}

  void root(std::size_t begin, std::size_t end) { divide(begin, end, cloud_.depth(), 0.0); }

 private:
  void divide(std::size_t begin, std::size_t end, int shift, double spacing) {
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

  bool asksForMore(const CellSums& sums) const {
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

/** Divides every occupied root cell; leaves(slice, window, batch) for the cells of each slice that
 * stay whole, in Morton order. O(N) per level that is divided; the same cells for any number of
 * threads. */
template <typename Leaves>
void divideByTolerance(const OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule,
                       int threads, const Leaves& leaves) {
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
bool hasNormals(const CloudView& cloud) {
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
        table_(plan_.params.rgb_space) {}

  Error run(SplatSet& splats) {
    if (!begin(0.0f, "ordering")) return cancelled();
    leaveStraysOut();
    Result<OctreeCloud> cloud =
        OctreeCloud::build(view_, plan_.rootGrid(), params().threads, colors_);
    if (!cloud) return cloud.error();
    statistics_.seconds_order = watch_.lap();
    if (!needsNormals()) evidence_.source = SideSource::kNormals;
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
    statistics_.normals =
        settleDiscSides(evidence_, view_, params().paper_mode, params().threads, splats);
    const bool outward = evidence_.source == SideSource::kNone;
    statistics_.sides = outward ? SideSource::kOutward : evidence_.source;
    statistics_.seconds_splats = watch_.lap();
    return begin(1.0f, "done") ? Error() : cancelled();
  }

 private:
  /** Reports the next stage. false: the caller cancelled. */
  bool begin(float fraction, const char* stage) {
    progress_.report(fraction, stage);
    return !progress_.cancelled();
  }

  /** One point a thousand times as far away as the others would leave these few cells. */
  void leaveStraysOut() {
    kept_ = withoutStrays(view_, params().threads);
    if (kept_.empty()) return;
    statistics_.far_away = view_.count() - kept_.size();
    view_.indices = kept_.data();
    view_.num_indices = kept_.size();
  }

  static Error cancelled() { return {ErrorCode::kCancelled, "the sampling was cancelled"}; }

  bool needsNormals() {
    if (!has_normals_) has_normals_ = hasNormals(view_);
    return !*has_normals_;
  }

  CloudView positionsOnly() const {
    CloudView view = view_;
    view.normal = nullptr;
    return view;
  }

  /** Neighbours of all points, and normals from them where there are none. */
  Error findNeighbors() {
    Result<PointStore> store = PointStore::build(positionsOnly(), params().threads);
    if (!store) return store.error();
    store_ = std::move(*store);
    if (!needsNormals()) return {};
    evidence_ = findSideEvidence(*store_, params().viewpoint);
    normals_ =
        estimateNormals(*store_, view_, params().normal_neighbors, evidence_, params().threads);
    view_.normal = normals_.data();
    view_.normal_stride = 3 * sizeof(float);
    statistics_.normals_estimated = true;
    return {};
  }

  void describe(const OctreeCloud& cloud, const SampleNoise& noise) {
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
  SplatBuilder divide(const OctreeCloud& cloud, const OctreeSource& source) {
    const SampleNoise noise =
        plan_.needsNoise() ? estimateSampleNoise(cloud, source, params().threads) : SampleNoise();
    describe(cloud, noise);
    const SplitRule rule = plan_.splitRule(noise, statistics_.normals_estimated);
    return plan_.hasBudget() ? cut(cloud, source, rule) : divideByRule(cloud, source, rule);
  }

  SplatBuilder divideByRule(const OctreeCloud& cloud, const OctreeSource& source,
                            const SplitRule& rule) {
    SplatBuilder builder(cloud, source, params(), rule.noise, numRootSlices(cloud));
    divideByTolerance(cloud, source, rule, params().threads,
                      [&](std::size_t slice, const PointWindow& window, const CellBatch& leaves) {
                        builder.add(slice, window, leaves);
                      });
    return builder;
  }

  SplatBuilder cut(const OctreeCloud& cloud, const OctreeSource& source, const SplitRule& rule) {
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
  std::vector<std::int32_t> kept_;  ///< indices of the points used, where there are strays
  std::vector<float> normals_;
  SideEvidence evidence_;
  Stopwatch watch_;
};

}  // namespace

Error SplatParams::validate() const {
  const auto bad = [](const char* text) { return Error{ErrorCode::kBadArgument, text}; };
  if (initial_resolution < 0 || initial_resolution > RootGrid::kMaxResolution) {
    return bad("the initial resolution is 0 (automatic) to 1048576 cells along the longest side");
  }
  if (!(geometric_error >= 0.0 && std::isfinite(geometric_error))) {
    return bad("the geometric error is a finite number from 0 on");
  }
  if (!(color_error >= 0.0 && std::isfinite(color_error))) {
    return bad("the colour error is a finite number from 0 on; from 1 on colour is ignored");
  }
  if (max_depth < 0) return bad("the depth is 0 (uniform cells) or more");
  if (!(target_error >= 0.0) || std::isinf(target_error)) {
    return bad("the target error is a finite number of Delta E, 0 for none");
  }
  if (max_splats > 0 && target_error > 0) {
    return bad("a count and a target error exclude each other; set one of the two");
  }
  if (Error error = checkThreads(threads)) return error;
  if (normal_neighbors < 3) return bad("a normal needs 3 neighbours or more");
  if (viewpoint && !isFinite(*viewpoint))
    return bad("the viewpoint is not finite; give three numbers");
  return {};
}

Error sampleSplats(const CloudView& cloud, const ColorView& colors, const SplatParams& params,
                   SplatSet& splats, SplatStatistics* statistics, Progress* progress) {
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

// SPDX-License-Identifier: BSD-3-Clause
// A part of a cloud fitted by itself (docs/tiles.md).
#include "pcl_slim/fit/tile_fit.h"

#include <algorithm>
#include <cmath>

#include "cover/cover.h"
#include "fit_plan.h"
#include "measures/measures.h"
#include "orient.h"
#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/cloud/outliers.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/stopwatch.h"
#include "trim/trim.h"

namespace pcl_slim {

using namespace detail;

namespace {

/** Constants by which patches stay inside a window. */
FitConstants windowedConstants(const TraitsSample& how) {
  FitConstants constants;
  constants.noise.most_part *= how.windows;
  return constants;
}

CloudTraits::Profile profileKind(const CloudMeasures& measures) {
  if (measures.noise_profile.empty()) return CloudTraits::Profile::kNone;
  return measures.correlation > 1 ? CloudTraits::Profile::kMeasured : CloudTraits::Profile::kField;
}

/** Points of the whole cloud for a number of points of a thinned one. */
double unthinned(double count, const TraitsSample& how) {
  return 1 + static_cast<double>(how.thinning) * (count - 1);
}

/** Whether noise fills the widest patches: they are as wide as the sample allows, and too narrow.
 */
bool noiseFills(const PointStore& sample, const FitStatistics& stats, double lambda,
                const NoiseConstants& noise) {
  const std::size_t most = sample.size() / noise.most_part;
  const double sigma = std::sqrt(lambda) / sample.diagonal();
  return 2 * stats.noise.neighbors > most && sigma >= noise.patch_noise * stats.noise.patch_radius;
}

/** The cloud's traits in place of those measured on a store. */
CloudMeasures measuresOf(const CloudTraits& traits) {
  CloudMeasures measures;
  measures.lambda = measures.noise = traits.lambda;
  measures.correlation = measures.statistics.correlation = traits.dependence;
  measures.normal_error = traits.normal_error;
  measures.min_dot = traits.min_dot;
  return measures;
}

std::vector<float> profileOf(const PointStore& store, const CloudTraits& traits, int threads,
                             const NoiseConstants& constants) {
  NoiseLevel level;
  level.variance = traits.lambda;
  level.neighbors = static_cast<std::size_t>(traits.noise_neighbors);
  if (traits.profile == CloudTraits::Profile::kMeasured)
    return measureNoiseProfile(store, level, constants, threads);
  if (traits.profile == CloudTraits::Profile::kField)
    return measureNoiseField(store, level, true, constants, threads);
  return {};
}

PointRange coreOf(const PointStore& store, const TileJob& job) {
  const std::uint64_t *begin = store.keys(), *end = begin + store.size();
  const auto first = std::lower_bound(begin, end, job.first_key);
  const auto last = std::lower_bound(first, end, job.end_key);
  return {static_cast<std::size_t>(first - begin), static_cast<std::size_t>(last - begin)};
}

}  // namespace

double LevelRadii::radius(int level) const {
  return first * std::pow(ratio, level - 1);
}

/** A ball with few points is gathered again one radius wider; one that moves keeps its radius. */
double LevelRadii::reach(int level) const {
  return kReachMargin * radius(level) / ratio;
}

LevelRadii levelRadii(const StoreFrame& frame, const FitParams& params) {
  const FitPlan plan = framePlan(frame, params, {});
  LevelRadii radii{plan.levelRadius(1), kGolden, 1};
  const int last = plan.constants.cover.last_start;
  while (radii.last < last && plan.resolves(radii.last + 1) && plan.allows(radii.last + 1))
    ++radii.last;
  return radii;
}

Result<MeasuredTraits> measureTraits(const PointStore& sample, const FitParams& asked,
                                     const TraitsSample& how) {
  const FitConstants constants = windowedConstants(how);
  const Result<FitParams> resolved = resolvedParams(asked, sample.frame(), constants.preset);
  if (!resolved) return resolved.error();
  const FitParams& params = *resolved;
  const int threads = resolveThreads(params.threads);
  MeasuredTraits measured;
  if (Error error = checkNormals(sample, params)) return error;
  const CloudMeasures found = measureCloud(sample, params, constants, threads);
  FitStatistics& stats = measured.statistics;
  stats.noise = found.statistics;
  stats.lambda = found.lambda / (sample.diagonal() * sample.diagonal());
  CloudTraits& traits = measured.traits;
  traits.lambda = found.lambda;
  traits.min_dot = planFor(sample, params, constants, found).min_dot;
  traits.normal_error = found.normal_error;
  if (how.thinning == 1) traits.spacing = medianSpacing(sample);
  traits.profile = profileKind(found);
  measured.noise_fills = noiseFills(sample, stats, found.lambda, constants.noise);
  if (traits.profile != CloudTraits::Profile::kNone && stats.noise.neighbors == 0)
    stats.noise.neighbors = measureNoise(sample, constants.noise, threads).neighbors;
  traits.dependence = unthinned(found.correlation, how);
  traits.noise_neighbors = how.thinning * stats.noise.neighbors;
  stats.noise.correlation = unthinned(stats.noise.correlation, how);
  return measured;
}

Error checkTileParams(const FitParams& params) {
  const auto no = [](const std::string& what, const std::string& remedy) {
    return Error{ErrorCode::kBadArgument, what + " is not possible by tiles: " + remedy};
  };
  if (Error error = params.validate()) return error;
  if (params.paper_mode)
    return no("the paper's mode",
              "its balls start at a tenth of the cloud's "
              "width; fit in memory, or leave it");
  if (std::holds_alternative<TargetError>(params.size) ||
      std::holds_alternative<TargetDistance>(params.size))
    return no("a target error", "give a penalty, or fit in memory");
  if (std::holds_alternative<MaxSurfels>(params.size))
    return no("a number of surfels", "give a penalty, or fit in memory");
  if (std::holds_alternative<NoiseFactor>(params.size))
    return no("a noise factor", "give a penalty, or fit in memory");
  if (params.noise_model) return no("a noise model", "give lambda, or fit in memory");
  if (params.sensor_noise || params.keep_sensor_noise)
    return no("a sensor's noise", "leave it, or fit in memory");
  return {};
}

Error fitTile(PointStore store, const FitParams& asked, const TileJob& job, SLIMSurface& surface,
              FitStatistics* statistics, Progress* progress) {
  surface.clear();
  if (Error error = checkTileParams(asked)) return error;
  const FitConstants constants;
  const FitParams params = resolvedParams(asked, constants.preset);
  const int threads = resolveThreads(params.threads);
  FitSeconds seconds;
  Stopwatch watch;
  const std::size_t given = coreOf(store, job).size();
  if (!params.keep_outliers) {
    const std::vector<std::uint32_t> outliers = findOutliers(store, threads, job.traits.spacing);
    if (!outliers.empty()) store.drop(outliers, threads);
  }
  const PointRange core = coreOf(store, job);
  seconds.outliers = watch.lap();

  CloudMeasures measures = measuresOf(job.traits);
  measures.noise_profile = profileOf(store, job.traits, threads, constants.noise);
  const FitPlan plan = planFor(store, params, constants, measures);
  seconds.noise = watch.lap();

  LevelCover cover(store, plan, threads, core);
  if (Error error = cover.run(job.first_level, progress)) return error;
  fillSurface(store, plan, cover, threads, surface);
  seconds.cover = watch.lap();

  const std::uint64_t trim_candidates = makeTrimMaps(store, plan, params, threads, surface);
  seconds.trim = watch.lap();
  if (statistics == nullptr) return {};
  FitStatistics& stats = *statistics;
  stats = countFit(store, cover, surface);
  stats.points = core.size();
  stats.outliers = given - core.size();
  stats.never_gathered -= std::min<std::uint64_t>(stats.never_gathered, store.size() - core.size());
  stats.trim_candidates = trim_candidates;
  stats.seconds = seconds;
  stats.threads = threads;
  return {};
}

Error fitCoarseLevels(const PointStore& sample, const FitParams& asked, const CoarseJob& job,
                      SLIMSurface& surface, Progress* progress) {
  FitConstants constants;
  constants.cover.last_level = job.last_level;
  const FitParams params = resolvedParams(asked, constants.preset);
  const int threads = resolveThreads(params.threads);
  CloudTraits traits = job.traits;
  traits.dependence = 1 + (traits.dependence - 1) / static_cast<double>(job.thinning);
  const FitPlan plan = planFor(sample, params, constants, measuresOf(traits)).withoutLeaves();
  LevelCover cover(sample, plan, threads);
  if (Error error = cover.run(startLevel(sample, plan), progress)) return error;
  fillSurface(sample, plan, cover, threads, surface);
  makeTrimMaps(sample, plan, params, threads, surface);
  return {};
}

void orientSurfels(const StoreFrame& frame, const FitParams& params, SLIMSurface& surface) {
  SideEvidence evidence;
  evidence.eye = params.viewpoint ? params.viewpoint : frame.sensor;
  if (evidence.eye) evidence.source = SideSource::kViewpoint;
  orientSurface(nullptr, evidence, FitConstants().orient, resolveThreads(params.threads), surface);
}

}  // namespace pcl_slim

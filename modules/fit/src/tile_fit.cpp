// SPDX-License-Identifier: BSD-3-Clause
// A part of a cloud fitted by itself (docs/tiles.md).
#include "pcl_slim/fit/tile_fit.h"

#include <algorithm>
#include <cmath>

#include "cover/level_cover.h"
#include "fit_steps.h"
#include "measured_settings.h"
#include "pcl_slim/cloud/detail/noise_measurement.h"
#include "pcl_slim/cloud/outliers.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/stopwatch.h"
#include "presets.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr double kReachMargin = 1.001;  ///< for the rounding of centres to their grid

/** Constants by which patches stay inside a window. */
FitConstants
windowedConstants(const TraitsSample& how)
{
  FitConstants constants;
  constants.noise.most_part *= how.windows;
  constants.noise.shared.most_part *= how.windows;
  return constants;
}

CloudTraits::Profile
profileKind(const FitParams& params, const FitSettings& settings)
{
  if (settings.noise_profile.empty()) return CloudTraits::Profile::kNone;
  const bool measured = params.local_noise == true || settings.energy.correlation > 1;
  return measured ? CloudTraits::Profile::kMeasured : CloudTraits::Profile::kRaised;
}

/** Points of the whole cloud for a number of points of a thinned one. */
double
unthinned(double count, const TraitsSample& how)
{
  return 1 + static_cast<double>(how.thinning) * (count - 1);
}

/** Whether noise fills the widest patches: they are as wide as the sample allows, and too narrow. */
bool
noiseFills(const PointStore& sample, const FitStatistics& stats, const FitSettings& settings)
{
  const NoiseConstants& noise = settings.constants.noise;
  const std::size_t most = sample.size() / noise.most_part;
  const double sigma = std::sqrt(settings.energy.lambda) / sample.diagonal();
  return 2 * stats.noise_neighbors > most && sigma >= noise.patch_noise * stats.noise_patch_radius;
}

/** Puts the cloud's traits in the place of what a store shows. */
void
takeTraits(const CloudTraits& traits, const FitParams& params, FitSettings& settings)
{
  settings.min_dot = traits.min_dot;
  settings.normal_error = traits.normal_error;
  settings.energy.lambda = traits.lambda;
  settings.energy.correlation = traits.dependence;
  if (!params.hasThreshold()) settings.noise = traits.lambda;
}

void
takeProfile(const PointStore& store, const CloudTraits& traits, int threads, FitSettings& settings)
{
  NoiseLevel level;
  level.variance = traits.lambda;
  level.neighbors = static_cast<std::size_t>(traits.noise_neighbors);
  const NoiseConstants& constants = settings.constants.noise;
  if (traits.profile == CloudTraits::Profile::kMeasured)
    settings.noise_profile = measureNoiseProfile(store, level, constants, threads);
  if (traits.profile == CloudTraits::Profile::kRaised)
    settings.noise_profile = measureRaisedProfile(store, level, constants, threads);
}

PointRange
coreOf(const PointStore& store, const TileJob& job)
{
  const std::uint64_t *begin = store.keys(), *end = begin + store.size();
  const auto first = std::lower_bound(begin, end, job.first_key);
  const auto last = std::lower_bound(first, end, job.end_key);
  return {static_cast<std::size_t>(first - begin), static_cast<std::size_t>(last - begin)};
}

}  // namespace

double
LevelRadii::radius(int level) const
{
  return first * std::pow(ratio, level - 1);
}

/** A ball with few points is gathered again one radius wider; one that moves keeps its radius. */
double
LevelRadii::reach(int level) const
{
  return kReachMargin * radius(level) / ratio;
}

LevelRadii
levelRadii(const StoreFrame& frame, const FitParams& params)
{
  FitSettings settings = params.hasThreshold() ? givenTPreset({}) : defaultPreset({});
  settings.diagonal = frame.diagonal;
  settings.center_grid = frame.center_grid;
  settings.least_ball =
      std::min(params.least_radius.value_or(0) / frame.scale, settings.levelRadius(1));
  LevelRadii radii{settings.levelRadius(1), kGolden, 1};
  const int last = settings.constants.cover.last_start;
  while (radii.last < last && settings.resolves(radii.last + 1) && settings.allows(radii.last + 1))
    ++radii.last;
  return radii;
}

Result<MeasuredTraits>
measureTraits(const PointStore& sample, const FitParams& asked, const TraitsSample& how)
{
  const FitConstants constants = windowedConstants(how);
  const FitParams params = resolvedParams(asked, constants.preset);
  const int threads = resolveThreads(params.threads);
  MeasuredTraits measured;
  FitSettings settings = makeSettings(sample, params, constants);
  FitStatistics& stats = measured.statistics;
  if (Error error = measureSettings(sample, params, threads, settings, stats)) return error;
  stats.lambda = settings.energy.lambda / (sample.diagonal() * sample.diagonal());
  CloudTraits& traits = measured.traits;
  traits.lambda = settings.energy.lambda;
  traits.min_dot = settings.min_dot;
  traits.normal_error = settings.normal_error;
  if (how.thinning == 1) traits.spacing = medianSpacing(sample);
  traits.profile = profileKind(params, settings);
  measured.noise_fills = noiseFills(sample, stats, settings);
  if (traits.profile != CloudTraits::Profile::kNone && stats.noise_neighbors == 0)
    stats.noise_neighbors = measureNoise(sample, constants.noise, threads).neighbors;
  traits.dependence = unthinned(settings.energy.correlation, how);
  traits.noise_neighbors = how.thinning * stats.noise_neighbors;
  stats.noise_correlation = unthinned(stats.noise_correlation, how);
  return measured;
}

Error
checkTileParams(const FitParams& params)
{
  const auto no = [](const std::string& what, const std::string& remedy) {
    return Error{ErrorCode::kBadArgument, what + " is not possible by tiles: " + remedy};
  };
  if (Error error = params.validate()) return error;
  if (params.paper_mode)
    return no("the paper's mode",
              "its balls start at a tenth of the cloud's "
              "width; fit in memory, or leave it");
  if (std::holds_alternative<TargetError>(params.size))
    return no("a target error", "give a penalty, or fit in memory");
  if (std::holds_alternative<MaxSurfels>(params.size))
    return no("a number of surfels", "give a penalty, or fit in memory");
  if (std::holds_alternative<NoiseFactor>(params.size))
    return no("a noise factor", "give a penalty, or fit in memory");
  if (params.noise_model) return no("a noise model", "give lambda, or fit in memory");
  return {};
}

Error
fitTile(PointStore store, const FitParams& asked, const TileJob& job, SLIMSurface& surface,
        FitStatistics* statistics, Progress* progress)
{
  surface.clear();
  if (Error error = checkTileParams(asked)) return error;
  const FitConstants constants;
  const FitParams params = resolvedParams(asked, constants.preset);
  FitStatistics stats;
  stats.threads = resolveThreads(params.threads);
  Stopwatch watch;
  stats.outliers = coreOf(store, job).size();
  if (!params.keep_outliers) {
    const std::vector<std::uint32_t> outliers =
        findOutliers(store, stats.threads, job.traits.spacing);
    if (!outliers.empty()) store.drop(outliers, stats.threads);
  }
  const PointRange core = coreOf(store, job);
  stats.outliers -= core.size();
  stats.seconds_outliers = watch.lap();

  FitSettings settings = makeSettings(store, params, constants);
  takeTraits(job.traits, params, settings);
  takeProfile(store, job.traits, stats.threads, settings);
  stats.seconds_noise = watch.lap();

  stats.first_level = job.first_level;
  LevelCover cover(store, settings, stats.threads, core);
  if (Error error = cover.run(job.first_level, progress)) return error;
  fillSurface(store, settings, cover, stats.threads, surface);
  stats.seconds_cover = watch.lap();

  if (params.trim) makeTrimMaps(store, settings, params.hole_size, stats, surface);
  stats.seconds_trim = watch.lap();
  countFit(store, cover, surface, stats);
  stats.points = core.size();
  stats.never_gathered -= std::min<std::uint64_t>(stats.never_gathered, store.size() - core.size());
  if (statistics != nullptr) *statistics = stats;
  return {};
}

Error
fitCoarseLevels(const PointStore& sample, const FitParams& asked, const CoarseJob& job,
                SLIMSurface& surface, Progress* progress)
{
  FitConstants constants;
  constants.cover.last_level = job.last_level;
  const FitParams params = resolvedParams(asked, constants.preset);
  FitStatistics stats;
  stats.threads = resolveThreads(params.threads);
  FitSettings settings = makeSettings(sample, params, constants);
  settings.internal_only = true;
  CloudTraits traits = job.traits;
  traits.dependence = 1 + (traits.dependence - 1) / static_cast<double>(job.thinning);
  takeTraits(traits, params, settings);
  LevelCover cover(sample, settings, stats.threads);
  if (Error error = cover.run(startLevel(sample, settings), progress)) return error;
  fillSurface(sample, settings, cover, stats.threads, surface);
  if (params.trim) makeTrimMaps(sample, settings, params.hole_size, stats, surface);
  return {};
}

void
orientSurfels(const StoreFrame& frame, const FitParams& params, SLIMSurface& surface)
{
  FitParams facing = params;
  if (!params.viewpoint) facing.viewpoint = frame.sensor;
  FitStatistics stats;
  stats.threads = resolveThreads(params.threads);
  orientSurface(nullptr, facing, FitConstants().orient, surface, stats);
}

}  // namespace pcl_slim

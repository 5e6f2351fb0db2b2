// SPDX-License-Identifier: BSD-3-Clause
// The main loop of Ohtake et al. 2005, section 2: noise, levels of balls until every point is
// covered, links, sides (docs/theory.md, "One fit, step by step").
#include "pcl_slim/fit/fit.h"

#include <algorithm>
#include <optional>

#include "cover/level_cover.h"
#include "cover/start_level.h"
#include "cover/surface_columns.h"
#include "fit_statistics.h"
#include "fit_with_constants.h"
#include "measured_settings.h"
#include "orient/orientation.h"
#include "pcl_slim/cloud/outliers.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/stopwatch.h"
#include "penalty_search.h"
#include "presets.h"
#include "sides/sided_store.h"
#include "trim/trim_maps.h"

namespace pcl_slim {

namespace detail {

namespace {

/** Where no viewpoint is given and points have no sensors of their own, the only one is it. */
FitParams
facingSensor(const PointStore& store, FitParams params)
{
  if (params.has_viewpoint || store.hasSensors() || !store.sensor()) return params;
  params.has_viewpoint = true;
  std::copy(store.sensor()->begin(), store.sensor()->end(), params.viewpoint);
  return params;
}

/** Sides of the points that are left without outliers, for the store of all; outliers get none. */
std::vector<std::array<float, 3>>
sidesAmongAll(const PointStore& rest, const std::vector<std::uint32_t>& outliers, std::size_t size)
{
  std::vector<std::array<float, 3>> sides(size, {0, 0, 0});
  auto outlier = outliers.begin();
  std::size_t next = 0;
  for (std::size_t i = 0; i < size; ++i) {
    if (outlier != outliers.end() && *outlier == i) {
      ++outlier;
    } else {
      sides[i] = rest.normal(next++);
    }
  }
  return sides;
}

/** The stages of a fit, once outliers are left out. */
Error
fitStages(const FitConstants& constants, const FitParams& params, SidedStore& sided,
          SLIMSurface& surface, FitStatistics& stats, Progress* progress)
{
  Stopwatch watch;
  FitSettings settings = makeSettings(sided.store(), params, constants);
  if (Error error = measureSettings(sided.store(), params, stats.threads, settings, stats))
    return error;
  stats.seconds_noise = watch.lap();
  if (Error error = giveSides(constants, params, sided, settings, stats)) return error;
  stats.seconds_sides = watch.lap();
  const PointStore& store = sided.store();

  const double measured = settings.energy.lambda;
  if (Error error =
          applyNoiseFactor(store, params, settings, stats.threads, progress, stats.noise_factor))
    return error;
  stats.first_level = startLevel(store, settings);
  LevelCover cover(store, settings, stats.threads);
  if (Error error = cover.run(stats.first_level, progress)) return error;
  stats.seconds_cover = watch.lap();

  fillSurface(store, settings, cover, stats.threads, surface);
  surface.buildLinks(stats.threads);
  stats.seconds_links = watch.lap();

  if (store.hasNormals())
    stats.side_source = SideSource::kNormals;
  else if (store.hasSides())
    stats.side_source = store.hasSensors() ? SideSource::kSensors : SideSource::kThinParts;
  else if (params.orient)
    orientSurface(&store, params, constants.orient, surface, stats);
  stats.seconds_orient = watch.lap();

  if (params.trim && !params.paper_mode)
    makeTrimMaps(store, settings, params.hole_size, stats, surface);
  stats.seconds_trim = watch.lap();

  countFit(store, cover, surface, stats);
  if (measured > 0 && settings.energy.lambda != measured) {  // penalties act through lambda
    stats.penalty *= settings.energy.lambda / measured;
    stats.lambda *= measured / settings.energy.lambda;
  }
  return checkLeaves(store, stats);
}

Error
fitStore(const FitConstants& constants, SidedStore& sided, const FitParams& asked,
         SLIMSurface& surface, FitStatistics* statistics, Progress* progress)
{
  surface.clear();
  const PointStore& all = sided.store();
  if (Error error = asked.validate()) return error;
  if (all.size() == 0)
    return {ErrorCode::kBadInput, "the store holds no points: build it from some"};
  FitParams usable = asked;
  usable.sharp_features = asked.sharp_features && all.hasNormals();
  const FitParams params = facingSensor(all, resolvedParams(usable, constants.preset));
  if (params.has_noise_model && !params.has_viewpoint && !all.hasSensors()) {
    return {ErrorCode::kBadArgument,
            "a noise model tells errors along rays: give the viewpoint that they come from"};
  }
  FitStatistics stats;
  stats.threads = resolveThreads(params.threads);
  Stopwatch watch;
  if (!params.keep_outliers && !params.paper_mode)
    stats.outlier_points = findOutliers(all, stats.threads);
  stats.outliers = stats.outlier_points.size();
  stats.seconds_outliers = watch.lap();

  Error error;
  if (stats.outliers == 0) {
    error = fitStages(constants, params, sided, surface, stats, progress);
  } else {
    PointStore rest = all.without(stats.outlier_points, stats.threads);
    SidedStore sided_rest(rest);
    error = fitStages(constants, params, sided_rest, surface, stats, progress);
    if (stats.sided > 0 && sided.isKept())
      sided.setSides(sidesAmongAll(rest, stats.outlier_points, all.size()));
  }
  if (statistics != nullptr) *statistics = stats;
  if (error) surface.clear();
  return error;
}

}  // namespace

Error
fitWithConstants(const FitConstants& constants, const PointStore& store, const FitParams& params,
                 SLIMSurface& surface, FitStatistics* statistics, Progress* progress)
{
  SidedStore sided(store);
  return fitStore(constants, sided, params, surface, statistics, progress);
}

Error
fitWithConstants(const FitConstants& constants, PointStore& store, const FitParams& params,
                 SLIMSurface& surface, FitStatistics* statistics, Progress* progress)
{
  SidedStore sided(store);
  return fitStore(constants, sided, params, surface, statistics, progress);
}

}  // namespace detail

Error
fitSurface(const PointStore& store, const FitParams& params, SLIMSurface& surface,
           FitStatistics* statistics, Progress* progress)
{
  return detail::fitWithConstants({}, store, params, surface, statistics, progress);
}

Error
fitSurface(PointStore& store, const FitParams& params, SLIMSurface& surface,
           FitStatistics* statistics, Progress* progress)
{
  return detail::fitWithConstants({}, store, params, surface, statistics, progress);
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// The main loop of Ohtake et al. 2005, section 2: noise, levels of balls until every point is
// covered, links, sides (docs/theory.md, "One fit, step by step").
#include "pcl_slim/fit/fit.h"

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "cover/cover.h"
#include "fit_plan.h"
#include "measures/measures.h"
#include "orient.h"
#include "pcl_slim/cloud/outliers.h"
#include "pcl_slim/cloud/side_evidence.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/stopwatch.h"
#include "trim/trim.h"

namespace pcl_slim {

namespace detail {

namespace {

/** A user's parameters, settled for a store: the viewpoint is what all evidence shows, if that is one
 * place. \return an error where they do not go together. */
Result<FitParams> settledParams(const PointStore& store, const FitParams& asked,
                                const PresetConstants& preset, const SideEvidence& evidence) {
  if (Error error = asked.validate()) return error;
  if (store.size() == 0) return badInput("the store holds no points: build it from some");
  FitParams usable = asked;
  usable.sharp_features = asked.sharp_features && store.hasNormals();
  Result<FitParams> resolved = resolvedParams(usable, store.frame(), preset);
  if (!resolved) return resolved;
  FitParams& params = *resolved;
  if (evidence.eye) params.viewpoint = evidence.eye;
  if (params.noise_model && !params.viewpoint && !store.hasSensors()) {
    return Error{ErrorCode::kBadArgument,
                 "a noise model tells errors along rays: give the viewpoint that they come from"};
  }
  if (Error error = checkNormals(store, params)) return error;
  return resolved;
}

/** The points that a fit takes: all of a store, or a store without outliers. */
struct FittedPoints {
  std::vector<std::uint32_t> outliers;
  std::optional<PointStore> rest;

  const PointStore& of(const PointStore& all) const { return rest ? *rest : all; }
};

FittedPoints withoutOutliers(const PointStore& all, const FitParams& params, int threads) {
  FittedPoints fitted;
  if (params.keep_outliers || params.paper_mode) return fitted;
  fitted.outliers = findOutliers(all, threads);
  if (!fitted.outliers.empty()) fitted.rest = all.without(fitted.outliers, threads);
  return fitted;
}

/** Turns surfels to common sides. \param[in] store the points fitted, with their sides after the
 * cover \param[in] sides those before it */
Orientation turnSurfels(const PointStore& store, const SideStatistics& sides,
                        const SideEvidence& evidence, const FitParams& params,
                        const OrientConstants& constants, int threads, SLIMSurface& surface) {
  surface.info.sides_in_doubt = sides.in_doubt;
  if (store.hasNormals()) return {SideSource::kNormals, 0, {}};
  if (sides.for_cover) turnToSides(store, constants, threads, surface);
  if (store.hasSides())
    return {store.hasSensors() ? SideSource::kSensors : SideSource::kThinParts, 0, {}};
  return params.orient ? orientSurface(&store, evidence, constants, threads, surface)
                       : Orientation();
}

/** What the stages of a fit have made. */
struct Stages {
  const PointStore& points;
  const std::vector<std::uint32_t>& outliers;
  const CloudSides& sides;
  const SizedPlan& sized;
  const LevelCover& cover;
  const SLIMSurface& surface;
  Orientation turned;
  std::uint64_t gaps;  ///< surfels whose gaps were measured
  FitSeconds seconds;
  int threads;
};

FitStatistics statisticsOf(const Stages& fit) {
  FitStatistics stats = countFit(fit.points, fit.cover, fit.surface);
  stats.outliers = fit.outliers.size();
  stats.outlier_points = fit.outliers;
  const CloudMeasures& measures = fit.sides.measures;
  stats.noise = measures.statistics;
  // A factor of the noise acts through lambda; the report has it in the penalty.
  const double used = fit.sized.plan.energy.lambda, noise = measures.lambda;
  const double diagonal = fit.points.diagonal();
  if (noise > 0) stats.penalty *= used / noise;
  if (measures.scanned > 0)
    stats.lambda = measures.scanned / (diagonal * diagonal);
  else if (noise > 0)
    stats.lambda *= noise / used;
  stats.noise_factor = fit.sized.noise_factor;
  stats.sides = fit.sides.statistics;
  stats.sides.source = fit.turned.source;
  stats.sides.overlap_edges = fit.turned.overlap_edges;
  stats.sides.facing = fit.turned.facing;
  measureFacing(fit.surface, stats.sides);
  stats.trim_candidates = fit.gaps;
  stats.seconds = fit.seconds;
  stats.threads = fit.threads;
  return stats;
}

/** Gives a store of all points the sides and places of those that were fitted; outliers stay as
 * they are. Beams that graze a surface give unsure sides, which the projection does without. */
void keepSides(const std::vector<std::uint32_t>& outliers, int threads, CloudSides& sides,
               PointStore& all) {
  std::optional<PointStore>& fitted = sides.after_cover ? sides.after_cover : sides.for_cover;
  if (!fitted) return;
  if (sides.statistics.for_cover && fitted->hasSensors()) fitted->clearSides();
  if (outliers.empty()) {
    all = std::move(*fitted);
    return;
  }
  std::vector<std::array<float, 3>> normals(all.size(), {0, 0, 0});
  std::vector<std::array<double, 3>> places(all.size());
  auto outlier = outliers.begin();
  std::size_t next = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    places[i] = all.position(i);
    if (outlier != outliers.end() && *outlier == i) {
      ++outlier;
      continue;
    }
    if (fitted->hasSides()) normals[i] = fitted->normal(next);
    places[i] = fitted->position(next++);
  }
  if (fitted->hasSides()) all.setSides(normals);
  if (fitted->drift() > 0) all.moveTo(places, threads);
}

/** The paper's section 2, after noise and sides are measured. \param[in] all without sides of an
 * earlier fit \param[in] params settled */
Error fitStages(const FitConstants& constants, const PointStore& all, const FitParams& params,
                const SideEvidence& evidence, SLIMSurface& surface, FitStatistics* statistics,
                Progress* progress, PointStore* kept) {
  const int threads = resolveThreads(params.threads);
  FitSeconds seconds;
  Stopwatch watch;
  const FittedPoints fitted = withoutOutliers(all, params, threads);
  const PointStore& points = fitted.of(all);
  seconds.outliers = watch.lap();
  CloudMeasures measures = measureCloud(points, params, constants, threads);
  if (params.noise_model && !(measures.lambda <= points.diagonal() * points.diagonal())) {
    return {ErrorCode::kBadArgument,
            "the noise model gives errors wider than the cloud: give it in the cloud's unit"};
  }
  seconds.noise = watch.lap();
  CloudSides sides = sidesBeforeCover(points, params, constants, threads, std::move(measures));
  seconds.sides = watch.lap();

  const PointStore& store = sides.coverStore(points);
  const FitPlan plan = planFor(store, params, constants, sides.measures);
  const Result<SizedPlan> sized = sizedPlan(store, plan, params.size, threads, progress);
  if (!sized) return sized.error();
  LevelCover cover(store, sized->plan, threads);
  if (Error error = cover.run(startLevel(store, sized->plan), progress)) return error;
  seconds.cover = watch.lap();

  const PointStore& after = sides.storeAfterCover(points);
  fillSurface(after, sized->plan, cover, threads, surface);
  surface.buildLinks(threads);
  seconds.links = watch.lap();
  const Orientation turned =
      turnSurfels(after, sides.statistics, evidence, params, constants.orient, threads, surface);
  std::optional<PointStore>& sided = sides.after_cover ? sides.after_cover : sides.for_cover;
  if (sided && turned.source == SideSource::kThinParts)
    turnContradicted(constants.orient, threads, *sided, surface);
  seconds.orient = watch.lap();
  const std::uint64_t gaps = makeTrimMaps(after, sized->plan, params, threads, surface);
  seconds.trim = watch.lap();

  const FitStatistics found = statisticsOf(
      {points, fitted.outliers, sides, *sized, cover, surface, turned, gaps, seconds, threads});
  if (statistics != nullptr) *statistics = found;
  if (Error error = checkLeaves(points, found)) return error;
  if (kept != nullptr) keepSides(fitted.outliers, threads, sides, *kept);
  return {};
}

}  // namespace

Error fitWithConstants(const FitConstants& constants, const PointStore& store,
                       const FitParams& asked, SLIMSurface& surface, FitStatistics* statistics,
                       Progress* progress, PointStore* kept) {
  surface.clear();
  // A store whose normals agree, without sides of an earlier fit: the caller's own or a copy.
  const bool opposed = !asked.paper_mode && measureNormals(store).contradicts();
  std::optional<PointStore> copy;
  if (kept == nullptr && (opposed || (store.hasSides() && !store.hasNormals()))) copy = store;
  PointStore* const settled = kept != nullptr ? kept : copy ? &*copy : nullptr;
  if (settled != nullptr) settled->clearSides();
  NormalAgreement normals;
  if (opposed) normals = settleNormals(asked.viewpoint, resolveThreads(asked.threads), *settled);
  const PointStore& all = settled != nullptr ? *settled : store;
  const SideEvidence evidence = findSideEvidence(all, asked.viewpoint);
  const Result<FitParams> params = settledParams(all, asked, constants.preset, evidence);
  if (!params) return params.error();
  Error error = fitStages(constants, all, *params, evidence, surface, statistics, progress, kept);
  if (statistics != nullptr) statistics->sides.normals = normals;
  if (error) surface.clear();
  return error;
}

}  // namespace detail

Error fitSurface(const PointStore& store, const FitParams& params, SLIMSurface& surface,
                 FitStatistics* statistics, Progress* progress) {
  return detail::fitWithConstants({}, store, params, surface, statistics, progress);
}

Error fitSurface(PointStore& store, const FitParams& params, SLIMSurface& surface,
                 FitStatistics* statistics, Progress* progress) {
  return detail::fitWithConstants({}, store, params, surface, statistics, progress, &store);
}

}  // namespace pcl_slim

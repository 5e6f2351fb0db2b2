// SPDX-License-Identifier: BSD-3-Clause
// The main loop of Ohtake et al. 2005, section 2: noise, levels of balls until every point is
// covered, links, sides (docs/theory.md, "One fit, step by step").
#include "pcl_slim/fit/fit.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cover/cover.h"
#include "fit_plan.h"
#include "measures/measures.h"
#include "orient.h"
#include "pcl_slim/cloud/outliers.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/stopwatch.h"
#include "trim/trim.h"

namespace pcl_slim {

namespace detail {

namespace {

/** The outcome of a cover with a given noise variance. */
struct CoverResult {
  double leaves = 0;  ///< number of them
  double rms = 0;     ///< residual of the leaves [share of L]
};

std::string formatted(const char* format, double a, double b) {
  char text[256];
  std::snprintf(text, sizeof(text), format, a, b);
  return text;
}

/** x to six significant digits. */
double rounded(double x) {
  char text[32];
  const auto written = std::to_chars(text, text + sizeof(text), x, std::chars_format::general, 6);
  std::from_chars(text, written.ptr, x);
  return x;
}

/** Searches for the factor of the noise variance at which a cover meets a goal. */
class FactorSearch {
 public:
  FactorSearch(const PointStore& store, const FitPlan& plan, int threads, Progress* progress)
      : store_(store),
        plan_(plan),
        noise_(std::max(plan.energy.lambda, plan.constants.penalty_search.least_variance)),
        threads_(threads),
        progress_(progress) {}

  /** The bracket: the noise as measured, and the factor beyond which no surface is left. */
  double least() const { return 1; }
  double most() const {
    return rounded(std::max(1.0, std::pow(constants().largest_error * plan_.diagonal, 2) / noise_));
  }

  const PenaltySearchConstants& constants() const { return plan_.constants.penalty_search; }

  FitPlan planAt(double factor) const { return plan_.withLambda(factor * noise_); }

  Result<CoverResult> run(double factor) const {
    const FitPlan plan = planAt(factor);
    LevelCover cover(store_, plan, threads_);
    if (Error error = cover.run(startLevel(store_, plan), progress_)) return error;
    double weight = 0, sum = 0;
    CoverResult result;
    for (const LevelCover::Piece& piece : cover.pieces()) {
      for (const SurfelRecord* s = piece.begin; s != piece.end; ++s) {
        if ((s->flags & kSurfelLeaf) == 0) continue;
        result.leaves += 1;
        weight += s->effective_count;
        sum += static_cast<double>(s->effective_count) * s->error * s->error;
      }
    }
    result.rms = weight > 0 ? std::sqrt(sum / weight) / plan_.diagonal : 0.0;
    return result;
  }

  /** Secant steps in log-log for a factor with goal(result) = log(measured / wanted) in
   * [least_goal, most_goal].
   * \param[in] goal_low,goal_high at the ends of the bracket, of opposite signs \return the factor
   * found, else the last one tried whose measure is below the wanted one. */
  template <typename Goal>
  Result<double> solve(double goal_low, double goal_high, double least_goal, double most_goal,
                       const Goal& goal) const {
    double log_low = std::log(least()), log_high = std::log(most());
    double kept = goal_low >= least_goal && goal_low <= most_goal ? least() : most();
    for (int step = 0; step < constants().most_covers; ++step) {
      double share = goal_low / (goal_low - goal_high);
      share = std::min(std::max(share, constants().least_step), 1 - constants().least_step);
      const double factor = rounded(std::exp(log_low + share * (log_high - log_low)));
      const Result<CoverResult> result = run(factor);
      if (!result) return result.error();
      const double value = goal(*result);
      if (value <= most_goal && (value >= least_goal || value < 0)) kept = factor;
      if (value >= least_goal && value <= most_goal) break;
      ((value < 0) == (goal_low < 0) ? log_low : log_high) = std::log(factor);
      ((value < 0) == (goal_low < 0) ? goal_low : goal_high) = value;
    }
    return kept;
  }

 private:
  const PointStore& store_;
  const FitPlan& plan_;
  double noise_;
  int threads_;
  Progress* progress_;
};

/** The factor whose cover leaves an RMS residual. */
Result<double> factorForError(const FactorSearch& search, double target) {
  const auto goal = [&](const CoverResult& r) { return std::log(std::max(r.rms, 1e-12) / target); };
  const Result<CoverResult> finest = search.run(search.least());
  if (!finest) return finest.error();
  const double tolerance = std::log(1 + search.constants().error_tolerance);
  if (std::abs(goal(*finest)) <= tolerance) return search.least();
  if (goal(*finest) > 0) {
    return Error{
        ErrorCode::kBadArgument,
        formatted(
            "the target error %g L lies below what noise and density allow: ask for %g L or more",
            target, finest->rms)};
  }
  const Result<CoverResult> coarsest = search.run(search.most());
  if (!coarsest) return coarsest.error();
  if (goal(*coarsest) <= tolerance) return search.most();
  return search.solve(goal(*finest), goal(*coarsest), -tolerance, tolerance, goal);
}

/** The factor whose cover has few enough leaves. */
Result<double> factorForCount(const FactorSearch& search, double most) {
  const auto goal = [&](const CoverResult& r) { return std::log(std::max(r.leaves, 0.5) / most); };
  const Result<CoverResult> finest = search.run(search.least());
  if (!finest) return finest.error();
  if (goal(*finest) <= 0) return search.least();
  const Result<CoverResult> coarsest = search.run(search.most());
  if (!coarsest) return coarsest.error();
  if (goal(*coarsest) > 0) {
    return Error{ErrorCode::kBadArgument,
                 formatted("%g surfels are too few for this cloud: it needs at least %g", most,
                           coarsest->leaves)};
  }
  return search.solve(goal(*finest), goal(*coarsest),
                      std::log(1 - search.constants().count_tolerance), 0.0, goal);
}

/** A plan, and the factor that its noise variance was multiplied by; 0: none. */
struct SizedPlan {
  FitPlan plan;
  double noise_factor = 0;
};

/** \brief A plan whose noise variance is multiplied by a NoiseFactor, or by the factor that meets a
 * TargetError or MaxSurfels; with another SizeRule the plan as it is.
 *
 * The error a user allows is treated as if it were noise: covers are run while the factor is moved
 * by secant steps in log-log until the RMS residual meets the target within 3 %, or the leaves
 * number at most max_surfels (and, where reachable, 95 % of it). Factors have six decimal digits,
 * so that one which is printed gives the same fit.
 * \return an error where no factor reaches the goal, naming what is reachable.
 */
Result<SizedPlan> sizedPlan(const PointStore& store, const FitPlan& plan, const SizeRule& size,
                            int threads, Progress* progress) {
  const FactorSearch search(store, plan, threads, progress);
  Result<double> factor = 0.0;
  if (const auto* given = std::get_if<NoiseFactor>(&size))
    factor = given->factor;
  else if (const auto* target = std::get_if<TargetError>(&size))
    factor = factorForError(search, target->rms);
  else if (const auto* most = std::get_if<MaxSurfels>(&size))
    factor = factorForCount(search, static_cast<double>(most->leaves));
  if (!factor) return factor.error();
  return SizedPlan{*factor > 0 ? search.planAt(*factor) : plan, *factor};
}

/** A user's parameters, settled for a store: the cloud's sensor is the viewpoint where neither one
 * is given nor points have sensors of their own. \return an error where they do not go together. */
Result<FitParams> settledParams(const PointStore& store, const FitParams& asked,
                                const PresetConstants& preset) {
  if (Error error = asked.validate()) return error;
  if (store.size() == 0) return badInput("the store holds no points: build it from some");
  FitParams usable = asked;
  usable.sharp_features = asked.sharp_features && store.hasNormals();
  FitParams params = resolvedParams(usable, preset);
  if (!params.viewpoint && !store.hasSensors()) params.viewpoint = store.sensor();
  if (params.noise_model && !params.viewpoint && !store.hasSensors()) {
    return Error{ErrorCode::kBadArgument,
                 "a noise model tells errors along rays: give the viewpoint that they come from"};
  }
  if (Error error = checkNormals(store, params)) return error;
  return params;
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
                        const FitParams& params, const OrientConstants& constants, int threads,
                        SLIMSurface& surface) {
  surface.info.sides_in_doubt = sides.in_doubt;
  if (store.hasNormals()) return {SideSource::kNormals};
  if (sides.for_cover) turnToSides(store, constants, threads, surface);
  if (store.hasSides()) return {store.hasSensors() ? SideSource::kSensors : SideSource::kThinParts};
  return params.orient ? orientSurface(&store, params, constants, threads, surface) : Orientation();
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

/** The paper's section 2, after noise and sides are measured. \param[in] params settled
 * \param[out] kept the same store, which keeps the sides found; null: nothing keeps them */
Error fitStages(const FitConstants& constants, const PointStore& all, const FitParams& params,
                PointStore* kept, SLIMSurface& surface, FitStatistics* statistics,
                Progress* progress) {
  const int threads = resolveThreads(params.threads);
  FitSeconds seconds;
  Stopwatch watch;
  const FittedPoints fitted = withoutOutliers(all, params, threads);
  const PointStore& points = fitted.of(all);
  seconds.outliers = watch.lap();
  CloudMeasures measures = measureCloud(points, params, constants, threads);
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
      turnSurfels(after, sides.statistics, params, constants.orient, threads, surface);
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

/** \param[in] all without sides of an earlier fit \param[out] kept as above */
Error fitStore(const FitConstants& constants, const PointStore& all, const FitParams& asked,
               PointStore* kept, SLIMSurface& surface, FitStatistics* statistics,
               Progress* progress) {
  surface.clear();
  const Result<FitParams> params = settledParams(all, asked, constants.preset);
  if (!params) return params.error();
  Error error = fitStages(constants, all, *params, kept, surface, statistics, progress);
  if (error) surface.clear();
  return error;
}

}  // namespace

Error fitWithConstants(const FitConstants& constants, const PointStore& store,
                       const FitParams& params, SLIMSurface& surface, FitStatistics* statistics,
                       Progress* progress) {
  if (!store.hasSides() || store.hasNormals())
    return fitStore(constants, store, params, nullptr, surface, statistics, progress);
  PointStore unsided = store;
  unsided.clearSides();
  return fitStore(constants, unsided, params, nullptr, surface, statistics, progress);
}

Error fitWithConstants(const FitConstants& constants, PointStore& store, const FitParams& params,
                       SLIMSurface& surface, FitStatistics* statistics, Progress* progress) {
  store.clearSides();
  return fitStore(constants, store, params, &store, surface, statistics, progress);
}

}  // namespace detail

Error fitSurface(const PointStore& store, const FitParams& params, SLIMSurface& surface,
                 FitStatistics* statistics, Progress* progress) {
  return detail::fitWithConstants({}, store, params, surface, statistics, progress);
}

Error fitSurface(PointStore& store, const FitParams& params, SLIMSurface& surface,
                 FitStatistics* statistics, Progress* progress) {
  return detail::fitWithConstants({}, store, params, surface, statistics, progress);
}

}  // namespace pcl_slim

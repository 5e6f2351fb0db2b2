// SPDX-License-Identifier: BSD-3-Clause
// The main loop of Ohtake et al. 2005, section 2: noise, levels of balls until every point is
// covered, links, sides (docs/theory.md, "One fit, step by step").
#include "pcl_slim/fit/fit.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

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

  Error run(double factor, CoverResult& result) {
    const FitPlan plan = planAt(factor);
    LevelCover cover(store_, plan, threads_);
    if (Error error = cover.run(startLevel(store_, plan), progress_)) return error;
    double weight = 0, sum = 0;
    result = CoverResult();
    for (const LevelCover::Piece& piece : cover.pieces()) {
      for (const SurfelRecord* s = piece.begin; s != piece.end; ++s) {
        if ((s->flags & kSurfelLeaf) == 0) continue;
        result.leaves += 1;
        weight += s->effective_count;
        sum += static_cast<double>(s->effective_count) * s->error * s->error;
      }
    }
    result.rms = weight > 0 ? std::sqrt(sum / weight) / plan_.diagonal : 0.0;
    return {};
  }

  /** Secant steps in log-log for a factor with goal(result) = log(measured / wanted) in
   * [least_goal, most_goal].
   * \param[in] goal_low,goal_high at the ends of the bracket, of opposite signs \param[out] kept
   * the factor found, else the last one tried whose measure is below the wanted one. */
  template <typename Goal>
  Error solve(double goal_low, double goal_high, double least_goal, double most_goal,
              const Goal& goal, double& kept) {
    double log_low = std::log(least()), log_high = std::log(most());
    kept = goal_low >= least_goal && goal_low <= most_goal ? least() : most();
    for (int step = 0; step < constants().most_covers; ++step) {
      double share = goal_low / (goal_low - goal_high);
      share = std::min(std::max(share, constants().least_step), 1 - constants().least_step);
      const double factor = rounded(std::exp(log_low + share * (log_high - log_low)));
      CoverResult result;
      if (Error error = run(factor, result)) return error;
      const double value = goal(result);
      if (value <= most_goal && (value >= least_goal || value < 0)) kept = factor;
      if (value >= least_goal && value <= most_goal) break;
      ((value < 0) == (goal_low < 0) ? log_low : log_high) = std::log(factor);
      ((value < 0) == (goal_low < 0) ? goal_low : goal_high) = value;
    }
    return {};
  }

 private:
  const PointStore& store_;
  const FitPlan& plan_;
  double noise_;
  int threads_;
  Progress* progress_;
};

Error solveError(FactorSearch& search, double target, double& factor) {
  const auto goal = [&](const CoverResult& r) { return std::log(std::max(r.rms, 1e-12) / target); };
  CoverResult finest, coarsest;
  factor = search.least();
  if (Error error = search.run(factor, finest)) return error;
  const double tolerance = std::log(1 + search.constants().error_tolerance);
  if (std::abs(goal(finest)) <= tolerance) return {};
  if (goal(finest) > 0) {
    return {
        ErrorCode::kBadArgument,
        formatted(
            "the target error %g L lies below what noise and density allow: ask for %g L or more",
            target, finest.rms)};
  }
  factor = search.most();
  if (Error error = search.run(factor, coarsest)) return error;
  if (goal(coarsest) <= tolerance) return {};
  return search.solve(goal(finest), goal(coarsest), -tolerance, tolerance, goal, factor);
}

Error solveCount(FactorSearch& search, double most, double& factor) {
  const auto goal = [&](const CoverResult& r) { return std::log(std::max(r.leaves, 0.5) / most); };
  CoverResult finest, coarsest;
  factor = search.least();
  if (Error error = search.run(factor, finest)) return error;
  if (goal(finest) <= 0) return {};
  factor = search.most();
  if (Error error = search.run(factor, coarsest)) return error;
  if (goal(coarsest) > 0) {
    return {ErrorCode::kBadArgument,
            formatted("%g surfels are too few for this cloud: it needs at least %g", most,
                      coarsest.leaves)};
  }
  return search.solve(goal(finest), goal(coarsest),
                      std::log(1 - search.constants().count_tolerance), 0.0, goal, factor);
}

/** \brief A plan whose noise variance is multiplied by a NoiseFactor, or by the factor that meets a
 * TargetError or MaxSurfels; with another SizeRule the plan as it is.
 *
 * The error a user allows is treated as if it were noise: covers are run while the factor is moved
 * by secant steps in log-log until the RMS residual meets the target within 3 %, or the leaves
 * number at most max_surfels (and, where reachable, 95 % of it). Factors have six decimal digits,
 * so that one which is printed gives the same fit. \param[out] factor the one used; 0: none
 * \return an error where no factor reaches the goal, naming what is reachable.
 */
Result<FitPlan> sizedPlan(const PointStore& store, const FitParams& params, FitPlan plan,
                          int threads, Progress* progress, double& factor) {
  const auto* given = std::get_if<NoiseFactor>(&params.size);
  const auto* target = std::get_if<TargetError>(&params.size);
  const auto* most = std::get_if<MaxSurfels>(&params.size);
  factor = given ? given->factor : 0;
  if (!given && !target && !most) return plan;
  FactorSearch search(store, plan, threads, progress);
  Error error;
  if (most) error = solveCount(search, static_cast<double>(most->leaves), factor);
  if (target) error = solveError(search, target->rms, factor);
  if (error) return error;
  return search.planAt(factor);
}

/** The parameters, with the cloud's sensor as viewpoint where neither a viewpoint is given nor
 * points have sensors of their own. */
FitParams facingSensor(const PointStore& store, FitParams params) {
  if (!params.viewpoint && !store.hasSensors()) params.viewpoint = store.sensor();
  return params;
}

/** Gives the store of all points the sides and places that a fit gave those that are left without
 * outliers; outliers stay as they are. */
void takeFromRest(const PointStore& rest, const std::vector<std::uint32_t>& outliers, int threads,
                  SidedStore& sided) {
  const std::size_t size = sided.store().size();
  std::vector<std::array<float, 3>> sides(size, {0, 0, 0});
  std::vector<std::array<double, 3>> places(size);
  auto outlier = outliers.begin();
  std::size_t next = 0;
  for (std::size_t i = 0; i < size; ++i) {
    places[i] = sided.store().position(i);
    if (outlier != outliers.end() && *outlier == i) {
      ++outlier;
      continue;
    }
    if (rest.hasSides()) sides[i] = rest.normal(next);
    places[i] = rest.position(next++);
  }
  if (rest.hasSides()) sided.setSides(sides);
  if (rest.drift() > 0) sided.moveTo(places, threads);
}

/** The stages of a fit, once outliers are left out. */
Error fitStages(const FitConstants& constants, const FitParams& params, SidedStore& sided,
                SLIMSurface& surface, FitStatistics& stats, Progress* progress) {
  Stopwatch watch;
  Result<CloudMeasures> measured =
      measureCloud(sided.store(), params, constants, stats.threads, stats);
  if (!measured) return measured.error();
  CloudMeasures& measures = *measured;
  stats.seconds.noise = watch.lap();
  if (Error error = giveSides(constants, params, sided, measures, stats)) return error;
  stats.seconds.sides = watch.lap();
  const PointStore& store = sided.store();

  const Result<FitPlan> sized =
      sizedPlan(store, params, planFor(store, params, constants, measures), stats.threads, progress,
                stats.noise_factor);
  if (!sized) return sized.error();
  const FitPlan& plan = *sized;
  stats.first_level = startLevel(store, plan);
  LevelCover cover(store, plan, stats.threads);
  if (Error error = cover.run(stats.first_level, progress)) return error;
  stats.seconds.cover = watch.lap();
  if (stats.sides.for_cover) sided.endCover();

  fillSurface(store, plan, cover, stats.threads, surface);
  surface.buildLinks(stats.threads);
  stats.seconds.links = watch.lap();

  if (store.hasNormals())
    stats.sides.source = SideSource::kNormals;
  else if (store.hasSides())
    stats.sides.source = store.hasSensors() ? SideSource::kSensors : SideSource::kThinParts;
  else if (params.orient)
    orientSurface(&store, params, constants.orient, surface, stats);
  if (stats.sides.for_cover) turnToSides(store, constants.orient, stats.threads, surface);
  surface.info.sides_in_doubt = stats.sides.in_doubt;
  stats.seconds.orient = watch.lap();

  if (params.trim && !params.paper_mode)
    makeTrimMaps(store, plan, params.hole_size, stats, surface);
  // Beams that graze a surface give unsure sides, which the projection does without.
  if (stats.sides.for_cover && store.hasSensors()) sided.clearSides();
  stats.seconds.trim = watch.lap();

  countFit(store, cover, surface, stats);
  const double used = plan.energy.lambda, noise = measures.lambda;
  if (noise > 0 && used != noise) {  // penalties act through lambda
    stats.penalty *= used / noise;
    stats.lambda *= noise / used;
  }
  if (measures.scanned > 0) stats.lambda = measures.scanned / (store.diagonal() * store.diagonal());
  return checkLeaves(store, stats);
}

Error fitStore(const FitConstants& constants, SidedStore& sided, const FitParams& asked,
               SLIMSurface& surface, FitStatistics* statistics, Progress* progress) {
  surface.clear();
  const PointStore& all = sided.store();
  if (Error error = asked.validate()) return error;
  if (all.size() == 0)
    return {ErrorCode::kBadInput, "the store holds no points: build it from some"};
  FitParams usable = asked;
  usable.sharp_features = asked.sharp_features && all.hasNormals();
  const FitParams params = facingSensor(all, resolvedParams(usable, constants.preset));
  if (params.noise_model && !params.viewpoint && !all.hasSensors()) {
    return {ErrorCode::kBadArgument,
            "a noise model tells errors along rays: give the viewpoint that they come from"};
  }
  FitStatistics stats;
  stats.threads = resolveThreads(params.threads);
  Stopwatch watch;
  if (!params.keep_outliers && !params.paper_mode)
    stats.outlier_points = findOutliers(all, stats.threads);
  stats.outliers = stats.outlier_points.size();
  stats.seconds.outliers = watch.lap();

  Error error;
  if (stats.outliers == 0) {
    error = fitStages(constants, params, sided, surface, stats, progress);
  } else {
    PointStore rest = all.without(stats.outlier_points, stats.threads);
    SidedStore sided_rest(rest);
    error = fitStages(constants, params, sided_rest, surface, stats, progress);
    if (sided.isKept() && (rest.hasSides() || rest.drift() > 0))
      takeFromRest(rest, stats.outlier_points, stats.threads, sided);
  }
  if (statistics != nullptr) *statistics = stats;
  if (error) surface.clear();
  return error;
}

}  // namespace

Error fitWithConstants(const FitConstants& constants, const PointStore& store,
                       const FitParams& params, SLIMSurface& surface, FitStatistics* statistics,
                       Progress* progress) {
  SidedStore sided(store);
  return fitStore(constants, sided, params, surface, statistics, progress);
}

Error fitWithConstants(const FitConstants& constants, PointStore& store, const FitParams& params,
                       SLIMSurface& surface, FitStatistics* statistics, Progress* progress) {
  SidedStore sided(store);
  return fitStore(constants, sided, params, surface, statistics, progress);
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

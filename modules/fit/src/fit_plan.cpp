// SPDX-License-Identifier: BSD-3-Clause
#include "fit_plan.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "cover/cover.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

FitParams FitParams::resolved() const {
  return detail::resolvedParams(*this, detail::PresetConstants());
}

}  // namespace pcl_slim

namespace pcl_slim::detail {

namespace {

/** The choices of Ohtake et al. 2005 throughout. */
FitPlan paperPreset(const FitConstants& constants) {
  FitPlan plan(constants);
  plan.paper = true;
  plan.fit_kernel = plan.wall_kernel = plan.cover_kernel = WeightKernel::kGaussian;
  plan.lack_of_fit = 0;
  plan.find_detail = plan.compare_nested = false;
  plan.residual_bound = 0;
  plan.skip_lone_normals = false;
  plan.energy.corrected = false;
  return plan;
}

/** The default (docs/theory.md, "Where the default departs from the paper"). */
FitPlan defaultPreset(const FitConstants& constants) {
  FitPlan plan(constants);
  // Balls two levels wider than the paper's first pay on smooth parts under noise.
  plan.first_radius = constants.cover.first_radius;
  plan.supported_alpha = constants.cover.supported_alpha;
  return plan;
}

/** T is the user's word on how fine to go: there are fewer reasons to stop above it
 * (docs/theory.md, "T given"). */
FitPlan withGivenT(FitPlan plan) {
  const PresetConstants& values = plan.constants.preset;
  plan.lenience = values.lenience_with_t;
  if (plan.lack_of_fit > 0) plan.lack_of_fit = values.lack_of_fit_with_t;
  plan.find_detail = plan.compare_nested = false;
  plan.energy.thick = values.thick_with_t;
  return plan;
}

FitPlan presetOf(const FitParams& params, const FitConstants& constants) {
  FitPlan plan = params.paper_mode       ? paperPreset(constants)
                 : params.hasThreshold() ? FitPlan(constants)
                                         : defaultPreset(constants);
  if (params.hasThreshold()) plan = withGivenT(std::move(plan));
  // Faces between edges are small: wider balls only contain more of other faces.
  if (params.sharp_features) plan.start_share = constants.cover.sharp_start_share;
  return plan;
}

double defaultKappa(const FitParams& params, const PresetConstants& constants) {
  return params.sharp_features ? constants.sharp_kappa : constants.kappa;
}

}  // namespace

FitParams resolvedParams(const FitParams& params, const PresetConstants& constants) {
  FitParams settled = params;
  const bool sharp = params.sharp_features;
  if (!params.degree) settled.degree = sharp ? constants.sharp_degree : constants.degree;
  if (auto* penalty = std::get_if<PenaltyWeight>(&settled.size); penalty && !penalty->kappa)
    penalty->kappa = defaultKappa(params, constants);
  return settled;
}

namespace {

/** L in world units. */
double worldDiagonal(const StoreFrame& frame) {
  return frame.diagonal * frame.scale;
}

std::string formatted(const char* format, double a, double b) {
  char text[256];
  std::snprintf(text, sizeof(text), format, a, b);
  return text;
}

}  // namespace

Result<FitParams> resolvedParams(const FitParams& params, const StoreFrame& frame,
                                 const PresetConstants& constants) {
  constexpr double kLeastShare = 1e-15;  // so that the variance is no denormal number
  FitParams settled = resolvedParams(params, constants);
  if (!params.noise) return settled;
  const double diagonal = worldDiagonal(frame);
  // Points at one place have no diagonal; they are no surface, whatever their noise.
  const double share = diagonal > 0 ? std::max(*params.noise / diagonal, kLeastShare) : 1.0;
  if (share > 1) {
    return Error{ErrorCode::kBadArgument,
                 formatted("noise of %g RMS is wider than the cloud, whose diagonal is %g: give it "
                           "in the cloud's unit",
                           *params.noise, diagonal)};
  }
  settled.lambda = share * share;
  settled.noise.reset();
  return settled;
}

FitPlan framePlan(const StoreFrame& frame, const FitParams& params, const FitConstants& constants) {
  FitPlan plan = presetOf(params, constants);
  plan.diagonal = frame.diagonal;
  plan.center_grid = frame.center_grid;
  plan.least_ball = std::min(params.least_radius.value_or(0) / frame.scale, plan.levelRadius(1));
  return plan;
}

FitPlan planFor(const PointStore& store, const FitParams& params, const FitConstants& constants,
                const CloudMeasures& measures) {
  FitPlan plan = framePlan(store.frame(), params, constants);
  plan.degree = *params.degree;
  // With a target number of surfels the paper's alpha is used: it needs fewer leaves.
  const auto* penalty = std::get_if<PenaltyWeight>(&params.size);
  const auto* threshold = std::get_if<MDLThreshold>(&params.size);
  if (!penalty && !threshold) plan.supported_alpha = plan.alpha;
  if (params.cover_radius) plan.alpha = plan.supported_alpha = *params.cover_radius;
  plan.gamma = params.cover_threshold;
  plan.with_normals = store.hasSides();
  plan.min_dot = measures.min_dot;
  plan.split_sheets = !store.hasNormals() && !params.paper_mode;
  plan.skip_lone_normals =
      plan.skip_lone_normals && (store.hasNormals() || measures.skip_lone_sides);
  plan.robust = params.robust;
  plan.seed = params.seed;
  plan.energy.kappa = penalty ? *penalty->kappa : defaultKappa(params, constants.preset);
  const double t_mdl = threshold ? threshold->t : params.paper_mode ? constants.preset.paper_t : 0;
  plan.energy.t_mdl = t_mdl * store.diagonal();
  plan.energy.lambda = measures.lambda;
  plan.energy.correlation = measures.correlation;
  plan.correlation = std::max(1.0, measures.statistics.correlation);
  // The paper's lambda, which T goes with, contains the surface's bend, too; the smallest balls
  // follow it.
  if (!params.hasThreshold() && !params.paper_mode) plan.noise = measures.noise;
  plan.noise_profile = measures.noise_profile;
  plan.normal_error = measures.normal_error;
  return plan;
}

namespace {

/** The outcome of a cover with a given noise variance. */
struct CoverResult {
  double leaves = 0;  ///< number of them
  double rms = 0;     ///< residual of the leaves [share of L]
};

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

/** An RMS residual to reach, as a share of L, and how an error names it and what is reachable. */
struct TargetResidual {
  double share;
  const char* refusal;
  double unit;  ///< of the numbers in the refusal, over L
};

TargetResidual residualOf(const TargetError& target) {
  return {target.rms,
          "the target error %g L lies below what noise and density allow: ask for %g L or more", 1};
}

TargetResidual residualOf(const TargetDistance& target, double diagonal) {
  return {target.rms / diagonal,
          "the target distance %g lies below what noise and density allow: ask for %g or more",
          diagonal};
}

/** The factor whose cover leaves an RMS residual. */
Result<double> factorForError(const FactorSearch& search, const TargetResidual& residual) {
  const double target = residual.share;
  const auto goal = [&](const CoverResult& r) { return std::log(std::max(r.rms, 1e-12) / target); };
  const Result<CoverResult> finest = search.run(search.least());
  if (!finest) return finest.error();
  const double tolerance = std::log(1 + search.constants().error_tolerance);
  if (std::abs(goal(*finest)) <= tolerance) return search.least();
  if (goal(*finest) > 0) {
    return Error{ErrorCode::kBadArgument,
                 formatted(residual.refusal, target * residual.unit, finest->rms * residual.unit)};
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

}  // namespace

Result<SizedPlan> sizedPlan(const PointStore& store, const FitPlan& plan, const SizeRule& size,
                            int threads, Progress* progress) {
  const FactorSearch search(store, plan, threads, progress);
  Result<double> factor = 0.0;
  if (const auto* given = std::get_if<NoiseFactor>(&size))
    factor = given->factor;
  else if (const auto* target = std::get_if<TargetError>(&size))
    factor = factorForError(search, residualOf(*target));
  else if (const auto* distance = std::get_if<TargetDistance>(&size))
    factor = factorForError(search, residualOf(*distance, worldDiagonal(store.frame())));
  else if (const auto* most = std::get_if<MaxSurfels>(&size))
    factor = factorForCount(search, static_cast<double>(most->leaves));
  if (!factor) return factor.error();
  return SizedPlan{*factor > 0 ? search.planAt(*factor) : plan, *factor};
}

namespace {

constexpr std::size_t kGrain = 16;  ///< pieces a thread takes at a time; no result depends on it

void setSurfel(std::size_t i, const SurfelRecord& r, SLIMSurface& surface) {
  surface.cx[i] = r.center[0];
  surface.cy[i] = r.center[1];
  surface.cz[i] = r.center[2];
  surface.nx[i] = r.normal[0];
  surface.ny[i] = r.normal[1];
  surface.nz[i] = r.normal[2];
  surface.radius[i] = r.radius;
  surface.error[i] = r.error;
  surface.effective_count[i] = r.effective_count;
  surface.degree[i] = r.degree;
  surface.level[i] = r.level;
  surface.flags[i] = r.flags;
  const auto stride = static_cast<std::size_t>(surface.stride());
  std::copy_n(r.c.begin(), stride,
              surface.coefficients.begin() + static_cast<std::ptrdiff_t>(i * stride));
}

SurfaceInfo makeInfo(const PointStore& store, const FitPlan& plan) {
  SurfaceInfo info;
  info.degree = plan.degree;
  info.fit_kernel = plan.fit_kernel;
  info.blend_kernel = plan.paper ? WeightKernel::kGaussian : WeightKernel::kPower4;
  info.oriented = store.hasSides();
  info.paper_mode = plan.paper;
  info.origin = store.origin();
  info.scale = store.scale();
  info.diagonal = store.diagonal();
  const double diagonal = store.diagonal();
  const bool has_extent = diagonal > 0;  // of one place there is no share
  info.lambda = has_extent ? plan.energy.lambda / (diagonal * diagonal) : 0.0;
  info.correlation = static_cast<float>(plan.correlation);  // as files have it
  info.penalty = plan.energy.t_mdl > 0 ? 0.0 : plan.energy.kappa;
  info.t_mdl = has_extent ? plan.energy.t_mdl / diagonal : 0.0;
  info.cover_radius = plan.alpha;
  info.cover_threshold = plan.gamma;
  info.num_points = store.size();
  return info;
}

void countSurfels(const SLIMSurface& surface, FitStatistics& stats) {
  double weight = 0, sum = 0;
  stats.leaves_per_level.assign(static_cast<std::size_t>(stats.last_level) + 1, 0);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    stats.reduced_degree += surface.degree[i] < surface.info.degree;
    if (!surface.isLeaf(i)) continue;
    ++stats.leaves;
    stats.open_leaves += surface.isOpen(i);
    ++stats.leaves_per_level[surface.level[i]];
    stats.support_limited += (surface.flags[i] & kSurfelSupportLimited) != 0;
    weight += surface.effective_count[i];
    sum += static_cast<double>(surface.effective_count[i]) * surface.error[i] * surface.error[i];
  }
  stats.internals = surface.size() - stats.leaves;
  stats.rms_error = weight > 0 ? std::sqrt(sum / weight) / surface.info.diagonal : 0.0;
}

void countPoints(const PointStore& store, const LevelCover& cover, FitStatistics& stats) {
  const PointCounts counts = cover.countPoints();
  stats.points = store.size();
  stats.uncovered = counts.uncovered;
  stats.unsupported = counts.unsupported;
  stats.unresolved = counts.unresolved;
  stats.skipped_normals = counts.lone_normals;
  const BallCounters balls = cover.counters();
  stats.split_sheets = balls.split_sheets;
  stats.gathered = balls.gathered;
  stats.never_gathered = store.size() - std::min<std::uint64_t>(store.size(), balls.tried);
  stats.line_balls = balls.lines;
  stats.fits = balls.fits.fits;
  stats.fell_by_support = balls.fits.fell_by_support;
  stats.fell_by_pivot = balls.fits.fell_by_pivot;
  stats.least_pivot = balls.fits.least_pivot;
  stats.first_level = cover.firstLevel();
  stats.levels_skipped = cover.firstLevel() - 1;
  stats.last_level = cover.lastLevel();
  stats.working_bytes = cover.peakBytes();
}

constexpr std::uint64_t kFewCovered =
    100;                                  ///< a fit that covers less than 1 point in 100 has failed
constexpr std::uint64_t kFewPoints = 12;  ///< about what the smallest leaf takes

}  // namespace

int startLevel(const PointStore& store, const FitPlan& plan) {
  if (plan.paper) return 1;
  const CoverConstants& constants = plan.constants.cover;
  const std::size_t samples = std::min(constants.start_samples, store.size());
  const auto most = static_cast<std::size_t>(plan.start_share * static_cast<double>(store.size()));
  std::vector<std::uint32_t> blocks;
  int level = 1;
  const auto isLast = [&](int k) { return !plan.resolves(k + 1) || !plan.allows(k + 1); };
  for (; level < constants.last_start && !isLast(level); ++level) {
    std::size_t crowded = 0;
    for (std::size_t s = 0; s < samples; ++s) {
      const auto p = store.position((2 * s + 1) * store.size() / (2 * samples));
      const float center[3] = {static_cast<float>(p[0]), static_cast<float>(p[1]),
                               static_cast<float>(p[2])};
      blocks.clear();
      // Blocks are counted in place of points: enough for a choice between factors of 1.6.
      store.tree().blocksInBall(center, static_cast<float>(plan.levelRadius(level)), blocks);
      crowded +=
          blocks.size() * PointStore::kBlock > most + constants.start_slack * PointStore::kBlock;
    }
    if (2 * crowded <= samples) return level;
  }
  return level;
}

void fillSurface(const PointStore& store, const FitPlan& plan, const LevelCover& cover, int threads,
                 SLIMSurface& surface) {
  surface.info = makeInfo(store, plan);
  const std::vector<LevelCover::Piece> pieces = cover.pieces();
  if (pieces.empty()) return;
  const LevelCover::Piece& last = pieces.back();
  surface.resize(last.first + static_cast<std::size_t>(last.end - last.begin));
  parallelFor(pieces.size(), threads, kGrain, [&](std::size_t p, int) {
    std::size_t i = pieces[p].first;
    for (const SurfelRecord* r = pieces[p].begin; r != pieces[p].end; ++r)
      setSurfel(i++, *r, surface);
  });
}

Error checkLeaves(const PointStore& store, const FitStatistics& stats) {
  const std::uint64_t covered = stats.points - std::min(stats.points, stats.uncovered);
  if (stats.leaves > 0 && covered >= stats.points / kFewCovered) return {};
  const std::string points = std::to_string(store.size());
  std::string why = "the " + points +
                    " points lie along lines or scattered, nowhere along a surface: give more "
                    "points beside them";
  if (store.statistics().without_normal > store.size()) {
    why = "only " + points +
          " of the points have a usable normal, which are no surface: fit without "
          "normals, or mend them";
  } else if (store.size() < kFewPoints) {
    why = points + (store.size() == 1 ? " distinct point is" : " distinct points are") +
          " too few for a surface: give a dozen or more";
  } else if (2 * stats.unresolved >= store.size()) {
    why = "of the " + points + " points, " + std::to_string(stats.unresolved) +
          " lie in groups a millionth as wide as all of them are: fit each group by itself";
  }
  return {ErrorCode::kNoSurface, why};
}

FitStatistics countFit(const PointStore& store, const LevelCover& cover,
                       const SLIMSurface& surface) {
  FitStatistics stats;
  countPoints(store, cover, stats);
  countSurfels(surface, stats);
  stats.lambda = surface.info.lambda;
  stats.penalty = surface.info.penalty;
  stats.t_mdl = surface.info.t_mdl;
  return stats;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "fit_plan.h"

#include <algorithm>
#include <cmath>
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
  // The paper's lambda, which T goes with, contains the surface's bend, too; the smallest balls
  // follow it.
  if (!params.hasThreshold() && !params.paper_mode) plan.noise = measures.noise;
  plan.noise_profile = measures.noise_profile;
  plan.normal_error = measures.normal_error;
  return plan;
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

void countFit(const PointStore& store, const LevelCover& cover, const SLIMSurface& surface,
              FitStatistics& stats) {
  countPoints(store, cover, stats);
  countSurfels(surface, stats);
  stats.levels_skipped = stats.first_level - 1;
  stats.lambda = surface.info.lambda;
  stats.penalty = surface.info.penalty;
  stats.t_mdl = surface.info.t_mdl;
}

}  // namespace pcl_slim::detail

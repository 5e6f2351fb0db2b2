// SPDX-License-Identifier: BSD-3-Clause
#include "fit_steps.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "cover/level_cover.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kGrain = 16;  ///< pieces a thread takes at a time; no result depends on it

void
setSurfel(std::size_t i, const SurfelRecord& r, SLIMSurface& surface)
{
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

SurfaceInfo
makeInfo(const PointStore& store, const FitPlan& plan)
{
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

void
countSurfels(const SLIMSurface& surface, FitStatistics& stats)
{
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

void
countPoints(const PointStore& store, const LevelCover& cover, FitStatistics& stats)
{
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

int
startLevel(const PointStore& store, const FitPlan& plan)
{
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

void
fillSurface(const PointStore& store, const FitPlan& plan, const LevelCover& cover, int threads,
            SLIMSurface& surface)
{
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

Error
checkLeaves(const PointStore& store, const FitStatistics& stats)
{
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

void
countFit(const PointStore& store, const LevelCover& cover, const SLIMSurface& surface,
         FitStatistics& stats)
{
  countPoints(store, cover, stats);
  countSurfels(surface, stats);
  stats.levels_skipped = stats.first_level - 1;
  stats.lambda = surface.info.lambda;
  stats.penalty = surface.info.penalty;
  stats.t_mdl = surface.info.t_mdl;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "fit_steps.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "cover/level_cover.h"

namespace pcl_slim::detail {

namespace {

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
    100;                                  ///< leaves that cover less than 1 in so many mean nothing
constexpr std::uint64_t kFewPoints = 12;  ///< about what the smallest leaf takes

}  // namespace

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

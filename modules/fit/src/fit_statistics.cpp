// SPDX-License-Identifier: BSD-3-Clause
#include "fit_statistics.h"

#include <algorithm>
#include <cmath>

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
  stats.skipped_normals = counts.lone_normals;
  const BallCounters balls = cover.counters();
  stats.split_sheets = balls.split_sheets;
  stats.gathered = balls.gathered;
  stats.never_gathered = store.size() - std::min<std::uint64_t>(store.size(), balls.tried);
  stats.fits = balls.fits;
  stats.last_level = cover.lastLevel();
  stats.working_bytes = cover.peakBytes();
}

}  // namespace

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

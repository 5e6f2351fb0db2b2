// SPDX-License-Identifier: BSD-3-Clause
#include "sides/sided_store.h"

#include <algorithm>
#include <cmath>

#include "measured_settings.h"
#include "pcl_slim/cloud/detail/sides.h"
#include "presets.h"

namespace pcl_slim::detail {

namespace {

/** Given sides win, and a viewpoint gives the side of every point. Points on scan lines have no
 * normals of cells, and those of cells are too coarse to keep sharp edges apart. */
bool
mayNeedSides(const PointStore& store, const FitParams& params, const FitStatistics& stats)
{
  return params.sides && !params.sharp_features && !store.hasNormals() && !params.has_viewpoint &&
         !params.paper_mode && !(params.t_mdl > 0) && stats.noise_line == 0;
}

/** Whether thin parts have come to face apart, and few cells are in doubt beside them. */
bool
worthIt(const Sides& sides, const ThinPlaces& thin, const SideConstants& rules)
{
  const double share = rules.part * std::max(thin.share, thin.facing);
  return sides.thin >= share && 1 - sides.confidence <= share;
}

}  // namespace

Error
giveSides(const FitConstants& constants, const FitParams& params, SidedStore& sided,
          FitSettings& settings, FitStatistics& stats)
{
  if (!mayNeedSides(sided.store(), params, stats)) return {};
  const SideConstants& rules = constants.sides;
  const ThinPlaces thin = findThinPlaces(sided.store(), rules, constants.noise, stats.threads);
  stats.thin_places = thin.share;
  if (thin.share < rules.least_thin && thin.facing < rules.least_facing) return {};
  const FitSettings without = settings;
  const FitStatistics before = stats;
  double noise = std::sqrt(settings.energy.lambda);
  if (params.lambda == 0 && thin.noise > 0) noise = std::min(noise, thin.noise);
  for (int pass = 0; pass < rules.noise_passes; ++pass) {
    sided.clearSides();
    const Sides sides = findSides(sided.store(), noise, thin.spacing, rules, stats.threads);
    if (!worthIt(sides, thin, rules)) break;
    sided.setSides(sides.normals);
    settings = makeSettings(sided.store(), params, constants);
    if (Error error = measureSettings(sided.store(), params, stats.threads, settings, stats))
      return error;
    stats.sided = sided.store().size();
    stats.sided_confidence = sides.confidence;
    const double found = std::sqrt(settings.energy.lambda);
    if (found > rules.same_noise * noise || found < rules.least_cells * thin.spacing) return {};
    noise = found;
  }
  if (sided.store().hasSides()) return {};
  settings = without;
  stats = before;
  return {};
}

}  // namespace pcl_slim::detail

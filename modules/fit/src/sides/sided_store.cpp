// SPDX-License-Identifier: BSD-3-Clause
#include "sides/sided_store.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

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

/** Whether thin parts, a share of all, have come to face apart, and few cells are in doubt beside them. */
bool
worthIt(const Sides& sides, double share, const SideConstants& rules)
{
  return sides.thin >= rules.part * share && 1 - sides.confidence <= rules.part * share;
}

/** Sides by cells of some noise, and what is measured with them. */
struct SidedFit {
  Sides sides;
  FitSettings settings;
  FitStatistics stats;

  double noise() const { return std::sqrt(settings.energy.lambda); }
};

}  // namespace

Error
giveSides(const FitConstants& constants, const FitParams& params, SidedStore& sided,
          FitSettings& settings, FitStatistics& stats)
{
  if (!mayNeedSides(sided.store(), params, stats)) return {};
  const SideConstants& rules = constants.sides;
  const ThinPlaces thin = findThinPlaces(sided.store(), rules, constants.noise, stats.threads);
  stats.thin_places = thin.share;
  // Sheets that are near and clean part in a fit by themselves, or they do not: sides stay if they
  // lower the noise.
  const bool needed = thin.share >= rules.least_thin || thin.facing >= rules.least_facing;
  const double share = needed ? std::max(thin.share, thin.facing) : thin.share + thin.near;
  if (!needed && share < rules.least_thin) return {};
  double noise = std::sqrt(settings.energy.lambda);
  if (params.lambda == 0 && thin.noise > 0) noise = std::min(noise, thin.noise);
  const double least = rules.least_cells * thin.spacing;
  const double unsided = std::sqrt(settings.energy.lambda);
  std::optional<SidedFit> best;
  bool narrows = false;  // this pass tries narrower cells than the noise that was found asks for
  for (int pass = 0; pass < rules.noise_passes && (pass == 0 || noise > least); ++pass) {
    sided.clearSides();
    SidedFit next{findSides(sided.store(), noise, thin.spacing, rules, stats.threads), {}, stats};
    if (!worthIt(next.sides, share, rules)) {
      if (best || thin.noise > 0) break;
      noise *= 0.5;  // cells so wide that they hold both sides leave doubts
      continue;
    }
    sided.setSides(next.sides.normals);
    next.settings = makeSettings(sided.store(), params, constants);
    if (Error error =
            measureSettings(sided.store(), params, stats.threads, next.settings, next.stats))
      return error;
    const double found = next.noise();
    if (!needed && found > rules.same_noise * unsided) break;
    if (narrows && found > rules.same_noise * best->noise()) break;
    best = std::move(next);
    const bool same = found > rules.same_noise * noise || found < least;
    if (same && (thin.noise > 0 || best->sides.confidence > rules.sure)) break;
    // No place has shown the noise by itself: cells that hold both sides may have shown this one.
    narrows = same;
    noise = same ? 0.5 * noise : found;
  }
  sided.clearSides();
  if (!best) return {};
  sided.setSides(best->sides.normals);
  settings = best->settings;
  stats = best->stats;
  stats.sided = sided.store().size();
  stats.sided_confidence = best->sides.confidence;
  return {};
}

}  // namespace pcl_slim::detail

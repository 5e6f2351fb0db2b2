// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>
#include <type_traits>

#include "ablation/changes.h"

namespace pcl_slim::ablation {

namespace {

using detail::FitConstants;
using Changes = std::vector<Change>;

/** A constant at half and double its distance from a base: 0, or 1 for margins. */
template <typename Get>
void
addScaled(const char* name, const Get& get, double base, Changes& all)
{
  for (const double factor : {0.5, 2.0}) {
    FitConstants library;
    using Value = std::decay_t<decltype(get(library))>;
    double value = base + factor * (static_cast<double>(get(library)) - base);
    if (std::is_integral_v<Value>) value = std::max(1.0, value);
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    all.push_back({name, text, [=](FitConstants& c) { get(c) = static_cast<Value>(value); }});
  }
}

// A member's name and the way to it are one word.
#define PCL_SLIM_SCALED(member) \
  addScaled(                    \
      #member, [](FitConstants & c) -> auto& { return c.member; }, 0.0, all)
#define PCL_SLIM_MARGIN(member) \
  addScaled(                    \
      #member, [](FitConstants & c) -> auto& { return c.member; }, 1.0, all)

void
addPreset(Changes& all)
{
  PCL_SLIM_SCALED(preset.kappa);
  PCL_SLIM_MARGIN(preset.support);
  PCL_SLIM_MARGIN(preset.lenience);
  PCL_SLIM_SCALED(preset.lack_of_fit);
  PCL_SLIM_SCALED(preset.thick);
}

void
addNoise(Changes& all)
{
  PCL_SLIM_SCALED(noise.first_neighbors);
  PCL_SLIM_SCALED(noise.least_width);
  PCL_SLIM_SCALED(noise.most_part);
  PCL_SLIM_SCALED(noise.patch_points);
  PCL_SLIM_SCALED(noise.samples);
  PCL_SLIM_SCALED(noise.least_samples);
  PCL_SLIM_SCALED(noise.trim);
  PCL_SLIM_SCALED(noise.patch_noise);
  PCL_SLIM_SCALED(noise.filled_patch);
  PCL_SLIM_SCALED(noise.relief);
  PCL_SLIM_SCALED(noise.bias_growth);
  PCL_SLIM_SCALED(noise.floor);
  PCL_SLIM_SCALED(noise.points_per_run);
  PCL_SLIM_SCALED(noise.window);
  PCL_SLIM_SCALED(noise.least_ratio);
  PCL_SLIM_SCALED(noise.sheets.passes);
  PCL_SLIM_SCALED(noise.sheets.gap);
  PCL_SLIM_SCALED(noise.sheets.factor);
}

void
addSensorNoise(Changes& all)
{
  PCL_SLIM_SCALED(noise.uneven);
  PCL_SLIM_SCALED(noise.uneven_share);
  PCL_SLIM_SCALED(noise.shared.plainest);
  PCL_SLIM_SCALED(noise.shared.flat);
  PCL_SLIM_SCALED(noise.shared.steep);
  PCL_SLIM_SCALED(noise.shared.slow);
  PCL_SLIM_SCALED(noise.shared.most_peak);
  PCL_SLIM_SCALED(noise.shared.still);
  PCL_SLIM_SCALED(noise.shared.slowing);
  PCL_SLIM_SCALED(noise.shared.very_still);
  PCL_SLIM_SCALED(noise.shared.spread);
  PCL_SLIM_SCALED(noise.shared.creases);
  PCL_SLIM_SCALED(noise.shared.chance);
  PCL_SLIM_SCALED(noise.shared.plain);
  PCL_SLIM_SCALED(noise.shared.all);
  PCL_SLIM_SCALED(noise.shared.fall);
  PCL_SLIM_SCALED(noise.white);
  PCL_SLIM_SCALED(noise.shared.least);
  PCL_SLIM_SCALED(noise.shared.counted);
  PCL_SLIM_SCALED(noise.steps.least_points);
  PCL_SLIM_SCALED(noise.steps.least_ratio);
  PCL_SLIM_SCALED(noise.steps.most_ratio);
  PCL_SLIM_SCALED(noise.steps.flat);
  PCL_SLIM_SCALED(noise.steps.correlation);
}

void
addNormalBound(Changes& all)
{
  PCL_SLIM_SCALED(normal_bound.blocks);
  PCL_SLIM_SCALED(normal_bound.least_points);
  PCL_SLIM_SCALED(normal_bound.one_sheet);
  PCL_SLIM_SCALED(normal_bound.deviations);
  PCL_SLIM_SCALED(normal_bound.widest);
}

void
addBall(Changes& all)
{
  PCL_SLIM_SCALED(ball.lone_share);
  PCL_SLIM_SCALED(ball.lone_cosine);
  PCL_SLIM_SCALED(ball.glance_blocks);
  PCL_SLIM_SCALED(ball.glance_stride);
  PCL_SLIM_SCALED(ball.off_center);
  PCL_SLIM_SCALED(ball.largest_shift);
  PCL_SLIM_SCALED(ball.bias.most_share);
}

void
addSheet(Changes& all)
{
  PCL_SLIM_SCALED(ball.sheets.passes);
  PCL_SLIM_SCALED(ball.sheets.noise);
  PCL_SLIM_SCALED(ball.sheets.bins);
  PCL_SLIM_SCALED(ball.sheets.valley);
  PCL_SLIM_SCALED(ball.sheets.points);
  PCL_SLIM_SCALED(ball.sheets.counted);
  PCL_SLIM_SCALED(ball.sheets.apart);
  PCL_SLIM_SCALED(ball.sheets.least_side);
}

void
addSupport(Changes& all)
{
  PCL_SLIM_SCALED(radius.least_seen_share);
  PCL_SLIM_MARGIN(radius.sure_margin);
  PCL_SLIM_SCALED(radius.lenient_steps);
  PCL_SLIM_SCALED(radius.support_steps);
  PCL_SLIM_MARGIN(radius.support_margin);
  PCL_SLIM_MARGIN(radius.support_aim);
  PCL_SLIM_MARGIN(radius.support_lenience);
  PCL_SLIM_SCALED(radius.scattered_ratio);
  PCL_SLIM_SCALED(radius.robust_scale);
}

void
addComparison(Changes& all)
{
  PCL_SLIM_SCALED(radius.noise_like);
  PCL_SLIM_MARGIN(radius.comparison_rise);
  PCL_SLIM_SCALED(radius.comparison_worth);
  PCL_SLIM_MARGIN(radius.comparison_trust);
  PCL_SLIM_SCALED(radius.comparison_radii);
  PCL_SLIM_SCALED(radius.degree_support);
}

void
addDetail(Changes& all)
{
  PCL_SLIM_SCALED(radius.detail_support);
  PCL_SLIM_SCALED(radius.detail_deviations);
  PCL_SLIM_SCALED(radius.detail_worth);
  PCL_SLIM_SCALED(radius.detail_cell);
  PCL_SLIM_SCALED(radius.points_per_cell);
  PCL_SLIM_SCALED(radius.least_cells);
  PCL_SLIM_SCALED(radius.most_cells);
  PCL_SLIM_SCALED(radius.absorbed_share);
}

void
addFeature(Changes& all)
{
  PCL_SLIM_SCALED(radius.feature_steps);
  PCL_SLIM_SCALED(radius.feature_step);
  PCL_SLIM_SCALED(radius.feature_support);
  PCL_SLIM_MARGIN(radius.feature_noise);
  PCL_SLIM_SCALED(radius.feature_height);
  PCL_SLIM_SCALED(radius.feature_gain);
}

void
addCover(Changes& all)
{
  PCL_SLIM_SCALED(cover.first_radius);
  PCL_SLIM_SCALED(cover.start_share);
  PCL_SLIM_SCALED(cover.start_samples);
  PCL_SLIM_SCALED(cover.start_slack);
  PCL_SLIM_SCALED(cover.alpha);
  PCL_SLIM_SCALED(cover.supported_alpha);
  PCL_SLIM_SCALED(cover.well_supported);
  PCL_SLIM_SCALED(cover.residual_bound);
  PCL_SLIM_SCALED(cover.residual_floor);
}

void
addOrient(Changes& all)
{
  PCL_SLIM_SCALED(orient.neighbors);
  PCL_SLIM_SCALED(orient.reach);
  PCL_SLIM_SCALED(orient.weak_edge);
  PCL_SLIM_SCALED(orient.closed_flux);
  PCL_SLIM_SCALED(orient.flat_flux);
}

#undef PCL_SLIM_SCALED
#undef PCL_SLIM_MARGIN

}  // namespace

Changes
constantsScaled()
{
  Changes all;
  for (const auto add : {addPreset, addNoise, addSensorNoise, addNormalBound, addBall, addSheet,
                         addSupport, addComparison, addDetail, addFeature, addCover, addOrient})
    add(all);
  return all;
}

}  // namespace pcl_slim::ablation

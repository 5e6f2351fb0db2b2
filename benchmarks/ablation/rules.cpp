// SPDX-License-Identifier: BSD-3-Clause
#include <limits>

#include "ablation/changes.h"

namespace pcl_slim::ablation {

namespace {

using detail::FitConstants;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

std::vector<Change>
ballRules()
{
  return {
      {"lone normals", "off", [](FitConstants& c) { c.ball.lone_share = 0; }},
      {"glance", "off", [](FitConstants& c) { c.ball.glance_blocks = 1u << 30; }},
      {"recentring", "off", [](FitConstants& c) { c.ball.off_center = kInfinite; }},
      {"sheets split", "off", [](FitConstants& c) { c.ball.sheets.passes = 0; }},
      {"noise bias", "off", [](FitConstants& c) { c.ball.bias.most_share = 0; }},
      {"least seen share", "off", [](FitConstants& c) { c.radius.least_seen_share = 0; }},
      {"normal bound", "off",
       [](FitConstants& c) { c.normal_bound.least_points = 1000, c.preset.sharp_bound = 0; }},
  };
}

std::vector<Change>
radiusRules()
{
  return {
      {"lenience", "off", [](FitConstants& c) { c.preset.lenience = 1; }},
      {"lenient bisection", "off", [](FitConstants& c) { c.radius.lenient_steps = 0; }},
      {"lack of fit", "off", [](FitConstants& c) { c.preset.lack_of_fit = 0; }},
      {"thick", "off", [](FitConstants& c) { c.preset.thick = 0; }},
      {"sure margin", "off", [](FitConstants& c) { c.radius.sure_margin = kInfinite; }},
      {"wider at minimum support", "off", [](FitConstants& c) { c.radius.support_lenience = 0; }},
      {"scattered", "off", [](FitConstants& c) { c.radius.scattered_ratio = kInfinite; }},
      {"comparison", "off", [](FitConstants& c) { c.radius.comparison_worth = 0; }},
      {"comparison's rise of E", "off", [](FitConstants& c) { c.radius.comparison_rise = 1e300; }},
      {"comparison's trust", "off", [](FitConstants& c) { c.radius.comparison_trust = 1; }},
      {"comparison's radii", "off", [](FitConstants& c) { c.radius.comparison_radii = 1; }},
      {"lower degree", "off", [](FitConstants& c) { c.radius.degree_support = kInfinite; }},
      {"hidden detail", "off", [](FitConstants& c) { c.radius.detail_support = kInfinite; }},
      {"hidden detail's worth", "off", [](FitConstants& c) { c.radius.detail_worth = 0; }},
      {"hidden detail's cell", "off", [](FitConstants& c) { c.radius.detail_cell = 0; }},
      {"absorbed share", "off", [](FitConstants& c) { c.radius.absorbed_share = 0; }},
      {"degree at features", "off", [](FitConstants& c) { c.radius.feature_height = kInfinite; }},
      {"feature noise", "off", [](FitConstants& c) { c.radius.feature_noise = 0; }},
      {"feature steps", "one", [](FitConstants& c) { c.radius.feature_steps = 1; }},
      {"second robust pass", "off", [](FitConstants& c) { c.radius.robust_passes = 1; }},
  };
}

std::vector<Change>
coverRules()
{
  return {
      {"two wider levels", "off",
       [](FitConstants& c) { c.cover.first_radius = c.cover.paper_first_radius; }},
      {"start share", "off", [](FitConstants& c) { c.cover.start_share = 1; }},
      {"start slack", "off", [](FitConstants& c) { c.cover.start_slack = 0; }},
      {"alpha of supported leaves", "off",
       [](FitConstants& c) { c.cover.supported_alpha = c.cover.alpha; }},
      {"residual bound", "off", [](FitConstants& c) { c.cover.residual_bound = 0; }},
      {"residual floor", "off", [](FitConstants& c) { c.cover.residual_floor = 0; }},
      {"weak edges", "off", [](FitConstants& c) { c.orient.weak_edge = 2; }},
  };
}

std::vector<Change>
noiseRules()
{
  return {
      {"wider patches", "off",
       [](FitConstants& c) { c.noise.most_part = std::numeric_limits<std::size_t>::max(); }},
      {"filled patch", "off", [](FitConstants& c) { c.noise.filled_patch = 0; }},
      {"relief", "off", [](FitConstants& c) { c.noise.relief = kInfinite; }},
      {"bias of cubics", "off", [](FitConstants& c) { c.noise.bias_growth = 1e300; }},
      {"trim", "off", [](FitConstants& c) { c.noise.trim = 0; }},
      {"floor", "off", [](FitConstants& c) { c.noise.floor = 1e-30; }},
      {"sheets of patches", "off", [](FitConstants& c) { c.noise.sheets.passes = 0; }},
      {"shared noise", "off", [](FitConstants& c) { c.noise.shared.least = kInfinite; }},
      {"steps", "off", [](FitConstants& c) { c.noise.steps.least_points = kInfinite; }},
      {"scan lines", "off", [](FitConstants& c) { c.noise.least_width = 0; }},
      {"uneven noise", "off", [](FitConstants& c) { c.noise.uneven = kInfinite; }},
  };
}

}  // namespace

std::vector<Change>
rulesOff()
{
  std::vector<Change> all;
  for (const auto& rules : {ballRules(), radiusRules(), coverRules(), noiseRules()})
    all.insert(all.end(), rules.begin(), rules.end());
  return all;
}

}  // namespace pcl_slim::ablation

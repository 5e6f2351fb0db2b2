// SPDX-License-Identifier: BSD-3-Clause
#include "presets.h"

#include <algorithm>
#include <utility>

#include "pcl_slim/cloud/detail/normal_bound.h"

namespace pcl_slim::detail {

namespace {

/** T is the user's word on how fine to go: there are fewer reasons to stop above it. */
FitSettings
withGivenT(FitSettings settings)
{
  const PresetConstants& values = settings.constants.preset;
  settings.lenience = values.lenience_with_t;
  if (settings.lack_of_fit > 0) settings.lack_of_fit = values.lack_of_fit_with_t;
  settings.find_detail = settings.compare_nested = false;
  settings.energy.thick = values.thick_with_t;
  return settings;
}

FitSettings
presetOf(const FitParams& params, const FitConstants& constants)
{
  const bool given_t = params.hasThreshold();
  if (params.paper_mode) return given_t ? paperGivenTPreset(constants) : paperPreset(constants);
  return given_t ? givenTPreset(constants) : defaultPreset(constants);
}

/** The cosine above which two normals belong together. */
float
minDot(const PointStore& store, const FitParams& params, const FitConstants& constants)
{
  if (params.sharp_features) return constants.preset.sharp_bound;
  if (!store.hasSides() || params.paper_mode) return 0.0f;
  return normalBound(store, constants.normal_bound);
}

}  // namespace

FitSettings
paperPreset(const FitConstants& constants)
{
  FitSettings settings(constants);
  settings.paper = true;
  settings.fit_kernel = settings.wall_kernel = settings.cover_kernel = WeightKernel::kGaussian;
  settings.lack_of_fit = 0;
  settings.find_detail = settings.compare_nested = false;
  settings.residual_bound = 0;
  settings.skip_lone_normals = false;
  settings.energy.corrected = false;
  return settings;
}

FitSettings
defaultPreset(const FitConstants& constants)
{
  FitSettings settings(constants);
  // Balls two levels wider than the paper's first serve smooth parts under noise.
  settings.first_radius = constants.cover.first_radius;
  settings.supported_alpha = constants.cover.supported_alpha;
  return settings;
}

FitSettings
givenTPreset(const FitConstants& constants)
{
  return withGivenT(FitSettings(constants));
}

FitSettings
paperGivenTPreset(const FitConstants& constants)
{
  return withGivenT(paperPreset(constants));
}

FitSettings
sharpPreset(FitSettings preset)
{
  // Faces between edges are small: wider balls only hold more of other faces.
  preset.start_share = preset.constants.cover.sharp_start_share;
  return preset;
}

double
defaultKappa(const FitParams& params, const PresetConstants& constants)
{
  return params.sharp_features ? constants.sharp_kappa : constants.kappa;
}

FitParams
resolvedParams(const FitParams& params, const PresetConstants& constants)
{
  FitParams settled = params;
  const bool sharp = params.sharp_features;
  if (!params.degree) settled.degree = sharp ? constants.sharp_degree : constants.degree;
  if (auto* penalty = std::get_if<PenaltyWeight>(&settled.size); penalty && !penalty->kappa)
    penalty->kappa = defaultKappa(params, constants);
  return settled;
}

FitSettings
makeSettings(const PointStore& store, const FitParams& params, const FitConstants& constants)
{
  FitSettings s = presetOf(params, constants);
  if (params.sharp_features) s = sharpPreset(std::move(s));
  s.degree = *params.degree;
  // A size that is asked for is met by the paper's alpha, which takes fewer leaves.
  const auto* penalty = std::get_if<PenaltyWeight>(&params.size);
  const auto* threshold = std::get_if<MDLThreshold>(&params.size);
  if (!penalty && !threshold) s.supported_alpha = s.alpha;
  if (params.cover_radius) s.alpha = s.supported_alpha = *params.cover_radius;
  s.gamma = params.cover_threshold;
  s.diagonal = store.diagonal();
  s.center_grid = store.centerGrid();
  s.least_ball = std::min(params.least_radius.value_or(0) / store.scale(), s.levelRadius(1));
  s.with_normals = store.hasSides();
  s.min_dot = minDot(store, params, constants);
  s.split_sheets = !store.hasNormals() && !params.paper_mode;
  s.skip_lone_normals = s.skip_lone_normals && store.hasNormals();
  s.robust = params.robust;
  s.seed = params.seed;
  s.energy.kappa = penalty ? *penalty->kappa : defaultKappa(params, constants.preset);
  const double t_mdl = threshold ? threshold->t : params.paper_mode ? constants.preset.paper_t : 0;
  s.energy.t_mdl = t_mdl * store.diagonal();
  return s;
}

}  // namespace pcl_slim::detail

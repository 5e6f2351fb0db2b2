// SPDX-License-Identifier: BSD-3-Clause
#include "fit_plan.h"

#include <algorithm>
#include <utility>

namespace pcl_slim::detail {

namespace {

/** The choices of Ohtake et al. 2005 throughout. */
FitPlan
paperPreset(const FitConstants& constants)
{
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
FitPlan
defaultPreset(const FitConstants& constants)
{
  FitPlan plan(constants);
  // Balls two levels wider than the paper's first pay on smooth parts under noise.
  plan.first_radius = constants.cover.first_radius;
  plan.supported_alpha = constants.cover.supported_alpha;
  return plan;
}

/** T is the user's word on how fine to go: there are fewer reasons to stop above it (docs/theory.md, "T
 * given"). */
FitPlan
withGivenT(FitPlan plan)
{
  const PresetConstants& values = plan.constants.preset;
  plan.lenience = values.lenience_with_t;
  if (plan.lack_of_fit > 0) plan.lack_of_fit = values.lack_of_fit_with_t;
  plan.find_detail = plan.compare_nested = false;
  plan.energy.thick = values.thick_with_t;
  return plan;
}

FitPlan
presetOf(const FitParams& params, const FitConstants& constants)
{
  FitPlan plan = params.paper_mode       ? paperPreset(constants)
                 : params.hasThreshold() ? FitPlan(constants)
                                         : defaultPreset(constants);
  if (params.hasThreshold()) plan = withGivenT(std::move(plan));
  // Faces between edges are small: wider balls only contain more of other faces.
  if (params.sharp_features) plan.start_share = constants.cover.sharp_start_share;
  return plan;
}

double
defaultKappa(const FitParams& params, const PresetConstants& constants)
{
  return params.sharp_features ? constants.sharp_kappa : constants.kappa;
}

}  // namespace

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

FitPlan
framePlan(const StoreFrame& frame, const FitParams& params, const FitConstants& constants)
{
  FitPlan plan = presetOf(params, constants);
  plan.diagonal = frame.diagonal;
  plan.center_grid = frame.center_grid;
  plan.least_ball = std::min(params.least_radius.value_or(0) / frame.scale, plan.levelRadius(1));
  return plan;
}

FitPlan
planFor(const PointStore& store, const FitParams& params, const FitConstants& constants,
        const CloudMeasures& measures)
{
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
  // The paper's lambda, which T goes with, contains the surface's bend, too; the smallest balls follow it.
  if (!params.hasThreshold() && !params.paper_mode) plan.noise = measures.noise;
  plan.noise_profile = measures.noise_profile;
  plan.normal_error = measures.normal_error;
  return plan;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/fit/fit.h"
#include "presets.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr double kLeastHole = 2.0;  ///< spacings: smaller gaps are between neighbours
constexpr double kMostHole = 50.0;  ///< spacings: wider ones are never closed, no ball spans them
constexpr double kMostNormalError = 1.5707963267948966;  ///< pi/2: normals that tell nothing

Error
badNoise(const char* text)
{
  return {ErrorCode::kBadArgument, text};
}

/** What is said of the noise, and whether it can be said together. */
Error
validateNoise(const FitParams& params)
{
  const double tau = params.noise_correlation;
  if (!(tau == 0 || tau >= 1) || !std::isfinite(tau))
    return badNoise("1 point or more share their errors (0: told by the data)");
  if (tau > 1 && (params.t_mdl > 0 || params.paper_mode))
    return badNoise("T_MDL and the paper's choices leave no room for shared errors: drop one");
  if (!params.has_noise_model) return {};
  const double* model = params.noise_model;
  const auto valid = [](double value) { return value >= 0 && std::isfinite(value); };
  if (!std::all_of(model, model + 3, valid) || !(model[0] + model[1] + model[2] > 0))
    return badNoise("the noise model's a, b, c must not be negative nor all 0");
  if (params.lambda > 0 || params.local_noise == true || params.t_mdl > 0 || params.paper_mode)
    return badNoise(
        "a noise model stands in place of lambda, local noise, T_MDL and the paper's choices: give "
        "one");
  return {};
}

}  // namespace

Error
FitParams::validate() const
{
  const auto bad = [](const char* text) { return Error{ErrorCode::kBadArgument, text}; };
  if (degree < 0 || degree > kMaxDegree) {
    return bad("the polynomial degree must be 1, 2, 3 or 4 (0: by the other parameters)");
  }
  if (!(penalty >= 0) || !std::isfinite(penalty)) {
    return bad("the penalty kappa must be positive (0: by the other parameters)");
  }
  if (!(t_mdl >= 0) || !std::isfinite(t_mdl)) return bad("T_MDL must be positive (0: unused)");
  if (!(target_error >= 0 && target_error <= 1))
    return bad("the target error is a share of the diagonal: 0 to 1");
  if (!(lambda >= 0) || !std::isfinite(lambda)) return bad("lambda must not be negative");
  if (!(cover_radius >= 0 && cover_radius <= 1))
    return bad("the cover radius alpha must lie in (0, 1] (0: by the points behind a leaf)");
  if (!(cover_threshold > 0 && cover_threshold <= 1))
    return bad("the cover threshold gamma must lie in (0, 1]");
  if (!(least_radius >= 0) || !std::isfinite(least_radius))
    return bad("the least radius of balls must not be negative (0: none)");
  if (target_error > 0 && max_surfels > 0)
    return bad("give a target error or a number of surfels, not both");
  if (!(noise_factor >= 0) || !std::isfinite(noise_factor))
    return bad("the noise factor must be positive (0: unused)");
  if (noise_factor > 0 && (target_error > 0 || max_surfels > 0 || t_mdl > 0)) {
    return bad(
        "a target error or number of surfels solves for the noise factor, and T_MDL has none: give "
        "one");
  }
  if (t_mdl > 0 && (target_error > 0 || max_surfels > 0)) {
    return bad(
        "T_MDL is a penalty: a target error or number of surfels would replace it, give one");
  }
  if (!(normal_error >= 0 && normal_error <= kMostNormalError))
    return bad("the normals' error lies between 0 and pi/2 radians (0: measured)");
  if (normal_error > 0 && !normals_as_data)
    return bad("an error of normals matters where they are data: ask for that too, or leave it");
  if (normals_as_data && (t_mdl > 0 || paper_mode)) {
    return bad(
        "normals as data are weighed against the noise, which T_MDL and the paper's mode leave "
        "open: drop one");
  }
  if (Error error = checkThreads(threads)) return error;
  if (!(hole_size >= kLeastHole && hole_size <= kMostHole))
    return bad("the smallest hole's size must be 2 to 50 spacings of the points");
  if (Error error = validateNoise(*this)) return error;
  const auto finite = [](double value) { return std::isfinite(value); };
  if (has_viewpoint && !std::all_of(viewpoint, viewpoint + 3, finite)) {
    return bad("the viewpoint must be finite");
  }
  return {};
}

FitParams
FitParams::resolved() const
{
  return resolvedParams(*this, PresetConstants());
}

}  // namespace pcl_slim

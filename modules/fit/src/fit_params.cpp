// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "fit_plan.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/fit/fit.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr double kLeastHole = 2.0;  ///< spacings: smaller gaps are between neighbours
constexpr double kMostHole = 50.0;  ///< spacings: wider ones are never closed, no ball spans them
constexpr double kMostNormalError = 1.5707963267948966;  ///< pi/2: normals without information

Error
bad(const char* text)
{
  return {ErrorCode::kBadArgument, text};
}

/** Checks the parameters of the noise, one by one and together. */
Error
validateNoise(const FitParams& params)
{
  const double tau = params.noise_correlation.value_or(1);
  if (!(tau >= 1) || !std::isfinite(tau))
    return bad("1 point or more share their errors (0: told by the data)");
  if (tau > 1 && (params.hasThreshold() || params.paper_mode))
    return bad("T_MDL and the paper's choices leave no room for shared errors: drop one");
  if (!params.noise_model) return {};
  const auto& [a, b, c] = *params.noise_model;
  const auto valid = [](double value) { return value >= 0 && std::isfinite(value); };
  if (!valid(a) || !valid(b) || !valid(c) || !(a + b + c > 0))
    return bad("the noise model's a, b, c must not be negative nor all 0");
  if (params.lambda || params.local_noise == true || params.hasThreshold() || params.paper_mode)
    return bad(
        "a noise model stands in place of lambda, local noise, T_MDL and the paper's choices: give "
        "one");
  return {};
}

bool
isPositive(double value)
{
  return value > 0 && std::isfinite(value);
}

Error
validateSize(const SizeRule& size)
{
  if (const auto* penalty = std::get_if<PenaltyWeight>(&size)) {
    if (!isPositive(penalty->kappa.value_or(1)))
      return bad("the penalty kappa must be positive (0: by the other parameters)");
  } else if (const auto* threshold = std::get_if<MDLThreshold>(&size)) {
    if (!isPositive(threshold->t)) return bad("T_MDL must be positive (0: unused)");
  } else if (const auto* target = std::get_if<TargetError>(&size)) {
    if (!(target->rms > 0 && target->rms <= 1))
      return bad("the target error is a share of the diagonal: 0 to 1");
  } else if (const auto* most = std::get_if<MaxSurfels>(&size)) {
    if (most->leaves == 0) return bad("a surface has one surfel or more: raise their number");
  } else if (!isPositive(std::get<NoiseFactor>(size).factor)) {
    return bad("the noise factor must be positive (0: unused)");
  }
  return {};
}

}  // namespace

Error
FitParams::validate() const
{
  if (degree && (*degree < 1 || *degree > kMaxDegree))
    return bad("the polynomial degree must be 1, 2, 3 or 4 (0: by the other parameters)");
  if (Error error = validateSize(size)) return error;
  if (!isPositive(lambda.value_or(1))) return bad("lambda must be positive (0: estimated)");
  if (cover_radius && !(*cover_radius > 0 && *cover_radius <= 1))
    return bad("the cover radius alpha must lie in (0, 1] (0: by the points behind a leaf)");
  if (!(cover_threshold > 0 && cover_threshold <= 1))
    return bad("the cover threshold gamma must lie in (0, 1]");
  if (!isPositive(least_radius.value_or(1)))
    return bad("the least radius of balls must not be negative (0: none)");
  if (normal_error && !(*normal_error > 0 && *normal_error <= kMostNormalError))
    return bad("the normals' error lies between 0 and pi/2 radians (0: measured)");
  if (normal_error && !normals_as_data)
    return bad("an error of normals matters where they are data: ask for that too, or leave it");
  if (normals_as_data && (hasThreshold() || paper_mode)) {
    return bad(
        "normals as data are weighed against the noise, which T_MDL and the paper's mode leave "
        "open: drop one");
  }
  if (Error error = checkThreads(threads)) return error;
  if (!(hole_size >= kLeastHole && hole_size <= kMostHole))
    return bad("the smallest hole's size must be 2 to 50 spacings of the points");
  if (Error error = validateNoise(*this)) return error;
  const auto finite = [](double value) { return std::isfinite(value); };
  if (viewpoint && !std::all_of(viewpoint->begin(), viewpoint->end(), finite))
    return bad("the viewpoint must be finite");
  return {};
}

FitParams
FitParams::resolved() const
{
  return resolvedParams(*this, PresetConstants());
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/fit/fit_parameters.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <type_traits>
#include <utility>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

namespace {

constexpr double kMany = 1e18;  ///< of a number without upper bound in the help
constexpr double kAbove0 = std::numeric_limits<double>::denorm_min();
constexpr double kFinite = std::numeric_limits<double>::max();
constexpr double kMostNormalError = 1.5707963267948966;  ///< pi/2: normals without information
constexpr double kLeastHole = 2.0;  ///< spacings: smaller gaps are between neighbours
constexpr double kMostHole = 50.0;  ///< spacings: wider ones are never closed, no ball spans them

Error bad(std::string text) {
  return {ErrorCode::kBadArgument, std::move(text)};
}

/** auto, off or the number of points that share an error. */
Error readCorrelation(const std::string& word, FitParams& params) {
  if (word == "off") {
    params.noise_correlation = 1;
  } else if (word != "auto") {
    char* end = nullptr;
    params.noise_correlation = std::strtod(word.c_str(), &end);
    if (*end != '\0' || !(*params.noise_correlation >= 1))
      return bad("-correlation '" + word + "' is neither auto, off nor a number from 1 on");
  }
  return {};
}

using Option = FitOption;
using P = FitParams;

constexpr FitParameter row(const char* name, FitMember member, FitOption group, const char* help,
                           FitParameter::Option option = {}, FitParameter::Range range = {}) {
  return {name, member, group, help, option, range};
}

constexpr FitParameter kParameters[] = {
    row("degree", &P::degree, Option::kFit, "degree of the polynomials", {1, 4, "4, with -sharp 2"},
        {1, kMaxDegree, "the polynomial degree must be 1, 2, 3 or 4 (0: by the other parameters)"}),
    row("penalty", &PenaltyWeight::kappa, Option::kFit,
        "weight of the price of a coefficient; larger is smoother", {1e-6, 1e6, "3, with -sharp 1"},
        {kAbove0, kMany,
         "the penalty kappa must be positive and at most 1e18 (0: by the other "
         "parameters)"}),
    row("t_mdl", &MDLThreshold::t, Option::kFit, "the paper's T_MDL in place of -penalty",
        {1e-9, 1e3, "off"},
        {kAbove0, kMany, "T_MDL must be positive and at most 1e18 (0: unused)"}),
    row("target_error", &TargetError::rms, Option::kFit,
        "RMS residual to reach, as a share of the box diagonal", {1e-12, 1, "off"},
        {kAbove0, 1, "the target error is a share of the diagonal: 0 to 1"}),
    row("target_distance", &TargetDistance::rms, Option::kFit,
        "RMS residual to reach, in the scan's unit", {1e-30, 1e30, "off"},
        {kAbove0, kFinite, "the target distance must be positive (0: unused)"}),
    row("max_surfels", &MaxSurfels::leaves, Option::kFit,
        "most leaves allowed; 0: as many as it takes", {0, kMany, "0"},
        {1, kFinite, "a surface has one surfel or more: raise their number"}),
    row("noise_factor", &NoiseFactor::factor, Option::kFit,
        "residuals and penalty as if the noise variance were X times as large: what -target_error, "
        "-target_distance and -max_surfels solve for",
        {1e-6, 1e30, "off"}, {kAbove0, kFinite, "the noise factor must be positive (0: unused)"}),
    row("least_radius", &P::least_radius, Option::kFit,
        "radius of the smallest ball, in the scan's units: no finer detail is kept",
        {0, 1e300, "off"},
        {kAbove0, kFinite, "the least radius of balls must not be negative (0: none)"}),
    row("sharp", &P::sharp_features, Option::kScan, "keep sharp edges; needs normals"),
    row("outliers", &P::keep_outliers, Option::kFit,
        "fit points that stand apart from all others, too"),
    row("robust", &P::robust, Option::kFit, "reweight residuals against outliers"),
    row("local_noise", &P::local_noise, Option::kFit,
        "noise is measured along the scan, not once for all of it", {0, 1, "auto"}),
    row("sides", &P::sides, Option::kFit,
        "give points without normals sides first where parts are thin"),
    row("correlation", &P::noise_correlation, Option::kFit,
        "points that share their errors, as those of depth cameras do",
        {0, 0, "auto", "auto|off|N", {}, readCorrelation},
        {1, kFinite, "1 point or more share their errors (0: told by the data)"}),
    row("noise_model", &P::noise_model, Option::kFit,
        "RMS error A + B z + C z^2 along the ray at distance z from the sensor",
        {0, 0, "none", "A,B,C"}),
    row("normals_as_data", &P::normals_as_data, Option::kFit,
        "fit points and normals together; for normals measured apart from the points"),
    row("normal_error", &P::normal_error, Option::kFit,
        "their RMS error in radians; with -normals_as_data 1", {1e-6, 1.5707, "measured"},
        {kAbove0, kMostNormalError,
         "the normals' error lies between 0 and pi/2 radians (0: measured)"}),
    row("paper", &P::paper_mode, Option::kFit,
        "the choices of Ohtake, Belyaev, Alexa 2005 throughout"),
    row("compact", &P::cover_radius, Option::kFit,
        "leaves cover their whole balls: fewer surfels, thinner overlap", {0, 1, "0", "", 1.0},
        {kAbove0, 1, "the cover radius alpha must lie in (0, 1] (0: by the points behind a leaf)"}),
    row("lambda", &P::lambda, Option::kFit,
        "noise variance, as a share of the squared box diagonal; -noise gives it in the scan's "
        "unit",
        {1e-30, 1, "estimated"},
        {kAbove0, 1, "lambda is a share of the squared diagonal: 0 to 1 (0: estimated)"}),
    row("noise", &P::noise, Option::kFit,
        "RMS error of the points, in the scan's unit, in place of -lambda",
        {1e-30, 1e30, "estimated"},
        {kAbove0, kFinite, "the noise must be positive (0: estimated)"}),
    row("viewpoint", &P::viewpoint, Option::kSensor,
        "the side that the normals of a scan without normals shall face", {0, 0, "none", "X,Y,Z"}),
    row("threads", &P::threads, Option::kThreads, "threads, 0: all cores; never changes the result",
        {0, 4096}),
    row("seed", &P::seed, Option::kRun, "seed of the order in which centres are tried", {0, kMany}),
    row("trim", &P::trim, Option::kTrim,
        "end the surface where the scan ends, and keep the scan's holes"),
    row("hole", &P::hole_size, Option::kTrim,
        "diameter of the smallest hole kept, in spacings of the points", {kLeastHole, kMostHole},
        {kLeastHole, kMostHole, "the smallest hole's size must be 2 to 50 spacings of the points"}),
    row("cover_threshold", &P::cover_threshold, Option::kNone, "coverage of a covered point", {},
        {kAbove0, 1, "the cover threshold gamma must lie in (0, 1]"}),
    row("orient", &P::orient, Option::kNone, "one consistent side without normals"),
};

/** The value of a parameter that is a number and set. */
template <typename Holder, typename Value>
std::optional<double> numberAt(const FitParams& params, Value Holder::*member) {
  if constexpr (!std::is_same_v<Holder, FitParams>) {
    const auto* rule = std::get_if<Holder>(&params.size);
    return rule ? std::optional<double>(rule->*member) : std::nullopt;
  } else if constexpr (std::is_same_v<Value, std::optional<std::array<double, 3>>>) {
    return std::nullopt;
  } else {
    return std::optional<double>(params.*member);
  }
}

/** Checks what parameters demand of each other. */
Error validateTogether(const FitParams& params) {
  if (params.normal_error && !params.normals_as_data)
    return bad("an error of normals matters where they are data: ask for that too, or leave it");
  const bool no_noise = params.hasThreshold() || params.paper_mode;
  if (params.normals_as_data && no_noise) {
    return bad(
        "normals as data are weighed against the noise, which T_MDL and the paper's mode leave "
        "open: drop one");
  }
  if (params.noise_correlation.value_or(1) > 1 && no_noise)
    return bad("T_MDL and the paper's choices leave no room for shared errors: drop one");
  const auto infinite = [](double x) { return !std::isfinite(x); };
  if (params.viewpoint && std::any_of(params.viewpoint->begin(), params.viewpoint->end(), infinite))
    return bad("the viewpoint must be finite");
  if (params.noise && params.lambda)
    return bad("noise and lambda are one quantity in two units: give one");
  if (params.sensor_noise) {
    if (Error error = params.sensor_noise->validate()) return error;
  }
  const bool given = params.lambda || params.noise || params.noise_model || no_noise;
  if (params.sensor_noise && given) {
    return bad(
        "a sensor's noise stands in place of noise, lambda, a noise model, T_MDL and the paper's "
        "choices: give one");
  }
  if (params.sensor_noise && (params.noise_correlation || params.local_noise == true))
    return bad("a sensor's noise has its own correlation and varies by range: give one of them");
  if (!params.noise_model) return {};
  const auto& [a, b, c] = *params.noise_model;
  const auto valid = [](double value) { return value >= 0 && std::isfinite(value); };
  if (!valid(a) || !valid(b) || !valid(c) || !(a + b + c > 0))
    return bad("the noise model's a, b, c must not be negative nor all 0");
  if (params.lambda || params.noise || params.local_noise == true || no_noise)
    return bad(
        "a noise model stands in place of noise, lambda, local noise, T_MDL and the paper's "
        "choices: give one");
  return {};
}

}  // namespace

const std::vector<FitParameter>& fitParameters() {
  static const std::vector<FitParameter> parameters(std::begin(kParameters), std::end(kParameters));
  return parameters;
}

const std::vector<std::vector<const char*>>& exclusiveFitParameters() {
  static const std::vector<std::vector<const char*>> sets = {
      {"penalty", "t_mdl", "target_error", "target_distance", "max_surfels", "noise_factor"},
      {"paper", "penalty"},
      {"paper", "trim"},
      {"paper", "hole"},
      {"normals_as_data", "t_mdl"},
      {"normals_as_data", "paper"},
      {"noise", "lambda"},
      {"noise_model", "lambda"},
      {"noise_model", "noise"},
      {"noise_model", "local_noise"},
      {"noise_model", "t_mdl"},
      {"noise_model", "paper"}};
  return sets;
}

Error FitParams::validate() const {
  for (const FitParameter& row : kParameters) {
    const auto [least, most, error] = row.range;
    const auto at = [this](auto member) { return numberAt(*this, member); };
    const std::optional<double> x = std::visit(at, row.member);
    if (error && x && !(*x >= least && *x <= most)) return bad(error);
  }
  if (Error error = checkThreads(threads)) return error;
  return validateTogether(*this);
}

std::vector<IdleFitParameter> idleParameters(const FitParams& params, const FitStatistics& fit) {
  std::vector<IdleFitParameter> idle;
  const std::string given = params.lambda           ? "-lambda"
                            : params.noise          ? "-noise"
                            : params.hasThreshold() ? "-t_mdl"
                            : params.paper_mode     ? "-paper"
                                                    : "";
  if (params.local_noise == true && fit.noise.correlation > 1 && given.empty())
    idle.push_back({"local_noise", "shared noise is measured along the scan anyway"});
  if (params.local_noise == false && !given.empty())
    idle.push_back({"local_noise", "with " + given + " noise is the same everywhere"});
  if (params.noise_correlation == 1 && !given.empty())
    idle.push_back({"correlation", "with " + given + " errors count as independent"});
  const auto* most = std::get_if<MaxSurfels>(&params.size);
  if (most && fit.noise_factor == 1)
    idle.push_back({"max_surfels " + std::to_string(most->leaves), "this scan needs fewer"});
  if (params.sides) return idle;
  if (fit.sides.source == SideSource::kNormals)
    idle.push_back({"sides", "the scan has normals"});
  else if (fit.sides.source == SideSource::kViewpoint || fit.sides.source == SideSource::kOrigin)
    idle.push_back({"sides", "a viewpoint gives the sides"});
  else if (params.paper_mode || params.hasThreshold())
    idle.push_back({"sides", "-paper and -t_mdl give points no sides"});
  else if (fit.noise.line > 0)
    idle.push_back({"sides", "points on scan lines get no sides"});
  return idle;
}

std::vector<IdleFitParameter> overruledParameters(const FitParams& params) {
  std::vector<IdleFitParameter> idle;
  if (!params.trim && params.hole_size != FitParams().hole_size)
    idle.push_back({"hole", "-trim 0 keeps no borders"});
  if (params.paper_mode && params.keep_outliers)
    idle.push_back({"outliers", "-paper fits all points"});
  return idle;
}

}  // namespace pcl_slim

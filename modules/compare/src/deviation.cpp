// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/compare/deviation.h"

#include <cmath>
#include <limits>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

namespace {

constexpr double kNormal95 = 1.96;  ///< two-sided 95 % of a normal distribution

bool usable(double length) {
  return std::isfinite(length) && length >= 0;
}

}  // namespace

Error FootParams::validate() const {
  if (!usable(max_distance)) {
    return {ErrorCode::kBadArgument,
            "the largest distance is negative or not finite: set a length, or 0 for no limit"};
  }
  return checkThreads(threads);
}

Error DeviationParams::validate() const {
  if (Error error = feet.validate()) return error;
  if (!usable(registration_error)) {
    return {ErrorCode::kBadArgument,
            "the registration error is negative or not finite: set a standard error, or 0"};
  }
  return {};
}

DeviationClass Deviations::classOf(std::size_t i) const {
  if (state[i] != FootState::kFound) return DeviationClass::kNoCounterpart;
  return std::abs(distance[i]) > detection[i] ? DeviationClass::kSignificant
                                              : DeviationClass::kSame;
}

Vector3 Deviations::foot(const DeviationPlaces& places, std::size_t i) const {
  return along(places.positions[i], 1, {offset[i][0], offset[i][1], offset[i][2]});
}

double levelOfDetection(double sigma_place, double sigma_reference, double registration_error) {
  return kNormal95 * (std::sqrt(sigma_place * sigma_place + sigma_reference * sigma_reference) +
                      registration_error);
}

Error measureDeviations(const DeviationReference& reference, const DeviationPlaces& places,
                        const DeviationParams& params, Deviations& deviations, Progress* progress) {
  deviations = Deviations();
  if (Error error = params.validate()) return error;
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  const std::size_t n = places.count;
  const auto fill = [&] {
    deviations.distance.assign(n, kUnknown);
    deviations.sigma_reference.assign(n, kUnknown);
    deviations.detection.assign(n, kUnknown);
    deviations.state.assign(n, FootState::kNotFinite);
    if (!params.keep_feet) return;
    deviations.offset.assign(n, {kUnknown, kUnknown, kUnknown});
    deviations.normal.assign(n, {0, 0, 0});
  };
  const Error error = reference.forEach(
      places, params.feet, fill,
      [&](std::size_t i, const ReferenceFoot& foot) {
        deviations.state[i] = foot.state;
        if (foot.state != FootState::kFound) return;
        const double own = places.sigma && places.sigma[i] > 0 && std::isfinite(places.sigma[i])
                               ? places.sigma[i]
                               : 0.0;
        deviations.distance[i] = static_cast<float>(foot.distance);
        deviations.sigma_reference[i] = static_cast<float>(foot.sigma);
        deviations.detection[i] =
            static_cast<float>(levelOfDetection(own, foot.sigma, params.registration_error));
        if (!params.keep_feet) return;
        for (std::size_t a = 0; a < 3; ++a) {
          deviations.offset[i][a] = static_cast<float>(foot.position[a] - places.positions[i][a]);
          deviations.normal[i][a] = static_cast<float>(foot.normal[a]);
        }
      },
      progress);
  if (error) deviations = Deviations();
  return error;
}

}  // namespace pcl_slim

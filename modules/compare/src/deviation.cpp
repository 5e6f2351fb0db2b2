// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/compare/deviation.h"

#include <cmath>
#include <limits>

#include "pcl_slim/core/parallel.h"
#include "place_order.h"

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

Result<double> facingShare(const DeviationReference& reference, const DeviationPlaces& places,
                           const FootParams& params, Progress* progress) {
  if (Error error = params.validate()) return error;
  constexpr std::size_t kMostPlaces = 2000;
  std::vector<Vector3> positions;
  std::vector<Vector3> normals;
  if (places.normals) {
    for (const std::uint32_t i : detail::evenChoice(places.positions, places.count, kMostPlaces,
                                                    resolveThreads(params.threads))) {
      const auto& n = places.normals[i];
      positions.push_back(places.positions[i]);
      normals.push_back({n[0], n[1], n[2]});
    }
  }
  DeviationPlaces chosen;
  chosen.positions = positions.data();
  chosen.count = positions.size();
  std::vector<ReferenceFoot> feet;
  if (Error error = reference.find(chosen, params, feet, progress)) return error;
  double facing = 0, compared = 0;
  for (std::size_t k = 0; k < feet.size(); ++k) {
    const double cosine = dot(feet[k].normal, normals[k]);
    if (feet[k].state != FootState::kFound || !std::isfinite(cosine) || cosine == 0) continue;
    ++compared;
    facing += cosine > 0;
  }
  return compared > 0 ? facing / compared : std::numeric_limits<double>::quiet_NaN();
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

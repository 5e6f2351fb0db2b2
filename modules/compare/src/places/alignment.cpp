// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/compare/alignment.h"

#include <algorithm>
#include <utility>

namespace pcl_slim {
namespace {

constexpr std::size_t kMostPlaces = 20000;  ///< standard errors are those of leaves, not of places

PlaceColumns placed(PlaceColumns places, bool turned, const RigidMotion& motion, int threads) {
  if (turned) places.turn();
  places.move(motion, threads);
  return places;
}

}  // namespace

RigidMotion inverseOf(const RigidMotion& motion) {
  RigidMotion inverse;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) inverse.rotation[r][c] = motion.rotation[c][r];
  }
  inverse.center = along(motion.center, 1.0, motion.translation);
  inverse.translation = scaled(motion.translation, -1.0);
  return inverse;
}

PlaceColumns Alignment::forward(const PlaceColumns& places, int threads) const {
  return placed(places, turned, motion, threads);
}

PlaceColumns Alignment::backward(const PlaceColumns& places, int threads) const {
  return placed(places, turned, inverseOf(motion), threads);
}

Result<Alignment> alignmentOf(const DeviationReference& reference, const PlaceColumns& places,
                              const AlignmentParams& params, Progress* progress) {
  RegistrationParams registering = params.registration;
  registering.most_places = std::min(registering.most_places, kMostPlaces);
  if (Error error = registering.validate()) return error;
  Alignment alignment;
  const Result<bool> away = facesAway(reference, places, registering.feet);
  if (!away) return away.error();
  alignment.turned = *away;
  PlaceColumns facing = places;
  if (alignment.turned) facing.turn();
  Result<Registration> registration =
      registerPlaces(reference, facing.view(), registering, progress);
  if (registration) {
    alignment.registration = std::move(*registration);
    if (params.apply) alignment.motion = alignment.registration.motion;
    return alignment;
  }
  if (params.apply || registration.error().code == ErrorCode::kCancelled)
    return registration.error();
  alignment.unknown = registration.error();
  return alignment;
}

}  // namespace pcl_slim

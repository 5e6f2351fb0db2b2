// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/compare/place_columns.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

DeviationPlaces PlaceColumns::view() const {
  DeviationPlaces places;
  places.positions = positions.data();
  places.count = positions.size();
  places.normals = normals.empty() ? nullptr : normals.data();
  places.oriented = oriented;
  places.sigma = sigma.empty() ? nullptr : sigma.data();
  return places;
}

namespace {

std::array<float, 3> narrowed(const Vector3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

Vector3 widened(const std::array<float, 3>& v) {
  return {v[0], v[1], v[2]};
}

constexpr std::size_t kGrain = 4096;

}  // namespace

void PlaceColumns::move(const RigidMotion& motion, int threads) {
  parallelFor(positions.size(), resolveThreads(threads), kGrain,
              [&](std::size_t i, int) { positions[i] = motion.place(positions[i]); });
  parallelFor(normals.size(), resolveThreads(threads), kGrain, [&](std::size_t i, int) {
    normals[i] = narrowed(motion.direction(widened(normals[i])));
  });
}

void PlaceColumns::turn() {
  for (auto& normal : normals) {
    for (float& c : normal) c = -c;
  }
}

double noiseOf(const SLIMSurface& surface) {
  return std::sqrt(surface.info.lambda) * surface.info.diagonal * surface.info.scale;
}

double independentPlaces(const SLIMSurface& surface, ScanPlaces which) {
  const SurfaceInfo& info = surface.info;
  return which == ScanPlaces::kMoved ? static_cast<double>(surface.numLeaves())
                                     : static_cast<double>(info.num_points) / info.correlation;
}

PlaceColumns placesOf(const CloudView& cloud, const CloudProjection& projection,
                      const SLIMSurface& surface, ScanPlaces which, int threads) {
  PlaceColumns places;
  const std::size_t count = projection.size();
  const auto noise = static_cast<float>(noiseOf(surface));
  places.positions.resize(count);
  places.normals.resize(count);
  places.sigma.assign(count, noise);
  places.oriented = surface.info.oriented && !surface.info.sides_in_doubt;
  parallelFor(count, resolveThreads(threads), kGrain, [&](std::size_t i, int) {
    places.positions[i] = cloud.position(cloud.inputIndex(i));
    if (!projection.isSupported(i)) return;
    places.normals[i] = projection.surfaceNormal(i);
    if (which == ScanPlaces::kMeasured) return;
    const ProjectedPoint moved = projection.point(i);
    places.positions[i] = moved.position;
    places.sigma[i] = moved.errors.position;
  });
  return places;
}

Result<bool> facesAway(const DeviationReference& reference, const PlaceColumns& places,
                       const FootParams& params) {
  if (!places.oriented || !reference.oriented() || places.normals.empty()) return false;
  const Result<double> share = facingShare(reference, places.view(), params);
  if (!share) return share.error();
  return *share < 0.5;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// The planes through the neighbours of projected points: surface variation, and normals of points
// that no surfel supports.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pcl_slim/cloud/detail/sides.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/cloud/neighbor_planes.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/query/cloud_projection.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kLeastPoints = 3;  ///< of a plane

Vector3 wide(const std::array<float, 3>& n) {
  return {n[0], n[1], n[2]};
}

}  // namespace

Result<PointStore> CloudProjection::projectedStore(const PointStore& first,
                                                   std::vector<std::uint32_t>& place) const {
  const std::size_t count = projection_.position.size();
  place.resize(count);
  if (count == first.size()) {
    PointStore moved = first;
    moved.moveTo(projection_.position, params_.projection.threads);
    for (std::size_t s = 0; s < count; ++s) place[s] = static_cast<std::uint32_t>(s);
    return moved;
  }
  std::vector<Vector3> places(count);
  for (std::size_t i = 0; i < size(); ++i) {
    if (isFinite(i)) places[stored_[i]] = point(i).position;
  }
  CloudView view;
  view.xyz = places.data();
  view.xyz_stride = sizeof(Vector3);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = count;
  Result<PointStore> built = PointStore::build(view, params_.projection.threads);
  if (built) place = built->storeOfInput();
  return built;
}

void CloudProjection::addPlanes(const PointStore& first) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::size_t count = projection_.position.size();
  const bool variation = params_.projection.variation;
  if (variation) variation_.assign(count, kNan);
  const auto& supported = projection_.supported;
  if (!variation && std::find(supported.begin(), supported.end(), 0) == supported.end()) return;
  std::vector<std::uint32_t> place;
  const Result<PointStore> store = projectedStore(first, place);
  if (!store || store->size() < kLeastPoints) return;
  std::vector<std::uint32_t> unsupported;
  for (std::size_t s = 0; s < count; ++s) {
    if (supported[s] == 0 && place[s] != PointStore::kSkipped) unsupported.push_back(place[s]);
  }
  const NeighborPlanes planes =
      findNeighborPlanes(*store, kVariationNeighbors, variation, params_.projection.threads,
                         variation ? nullptr : &unsupported);
  for (std::size_t s = 0; s < count; ++s) {
    if (place[s] == PointStore::kSkipped) continue;
    if (variation) variation_[s] = planes.variation[place[s]];
    if (supported[s] != 0) continue;
    std::copy_n(planes.normals.begin() + 3 * static_cast<std::ptrdiff_t>(place[s]), 3,
                projection_.normal[s].begin());
  }
  turnPlanes(*store, place);
}

void CloudProjection::turnPlanes(const PointStore& projected,
                                 const std::vector<std::uint32_t>& place) {
  std::vector<std::uint32_t> stored_at(projected.size(), PointStore::kSkipped);
  for (std::size_t s = 0; s < place.size(); ++s)
    if (place[s] != PointStore::kSkipped) stored_at[place[s]] = static_cast<std::uint32_t>(s);
  NeighborSearch search(projected);
  std::vector<std::uint32_t> near;
  const bool has_sensors = cloud_.sensors != nullptr;
  for (std::size_t i = 0; i < size(); ++i) {
    if (!isFinite(i) || isSupported(i) || place[stored_[i]] == PointStore::kSkipped) continue;
    const std::size_t s = stored_[i], at = place[s];
    const Vector3 normal = wide(projection_.normal[s]);
    const Vector3 world = cloud_.position(cloud_.inputIndex(i));
    double agreement = 0;
    if (seen_.eye) agreement = dot(subtract(*seen_.eye, world), normal);
    if (!seen_.eye && has_sensors) {
      const Vector3 ray = subtract(cloud_.sensorPosition(cloud_.inputIndex(i)), world);
      const double along = dot(ray, normal);
      if (std::abs(along) > detail::SideConstants().clear_beam * length(ray)) agreement = along;
    }
    if (agreement == 0) {
      search.nearestSet(at, kVariationNeighbors, near);
      for (const std::uint32_t j : near) {
        const std::uint32_t other = stored_at[j];
        if (other == PointStore::kSkipped || projection_.supported[other] == 0) continue;
        const double along = dot(wide(projection_.normal[other]), normal);
        agreement += turned_[other] != 0 ? -along : along;
      }
    }
    if (agreement == 0) agreement = dot(projected.position(at), normal);  // 0 is the middle
    if (agreement >= 0) continue;
    for (float& value : projection_.normal[s]) value = -value;
  }
}

std::array<float, 3> CloudProjection::ownNormal(std::size_t i) const {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  if (cloud_.normal != nullptr) {
    const Vector3 given = wide(cloud_.givenNormal(cloud_.inputIndex(i)));
    const double size = length(given);
    if (size > 0 && std::isfinite(size)) {
      return {static_cast<float>(given[0] / size), static_cast<float>(given[1] / size),
              static_cast<float>(given[2] / size)};
    }
  }
  const std::array<float, 3>& found = projection_.normal[stored_[i]];
  if (found == std::array<float, 3>{}) return {kNan, kNan, kNan};
  return found;
}

}  // namespace pcl_slim

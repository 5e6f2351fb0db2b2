// SPDX-License-Identifier: BSD-3-Clause
#include "view/scene/point_spheres.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "pcl_slim/core/finite.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {
namespace {

constexpr std::size_t kSample = 20000;

std::array<float, 3>
floatsAt(const void* array, std::size_t stride, std::size_t i)
{
  std::array<float, 3> values{};
  std::memcpy(values.data(), static_cast<const unsigned char*>(array) + i * stride, sizeof(values));
  return values;
}

/** \brief Input indices of finite points, evenly over the cloud. */
std::vector<std::size_t>
sampleOf(const CloudView& points)
{
  std::vector<std::size_t> sample;
  const std::size_t step = 1 + points.count() / kSample;
  for (std::size_t k = 0; k < points.count(); k += step) {
    const std::size_t i = points.inputIndex(k);
    if (isFinite(positionOf(points, i))) sample.push_back(i);
  }
  return sample;
}

/** \brief Puts origin and scale to the middle and the diagonal of the sample's box. */
void
placeIn(const CloudView& points, const std::vector<std::size_t>& sample, BoundingSpheres& object)
{
  Vector3 low = positionOf(points, sample.front()), high = low;
  for (const std::size_t i : sample) {
    const Vector3 p = positionOf(points, i);
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  const double diagonal = length(subtract(high, low));
  object.origin = scaled(along(low, 1.0, high), 0.5);
  if (diagonal > 0.0) object.scale = diagonal;
}

}  // namespace

std::array<double, 3>
positionOf(const CloudView& points, std::size_t i)
{
  std::array<double, 3> position{};
  if (points.scalar == CloudView::Scalar::kDouble) {
    const auto* bytes = static_cast<const unsigned char*>(points.xyz) + i * points.xyz_stride;
    std::memcpy(position.data(), bytes, sizeof(position));
    return position;
  }
  const std::array<float, 3> narrow = floatsAt(points.xyz, points.xyz_stride, i);
  std::copy(narrow.begin(), narrow.end(), position.begin());
  return position;
}

BoundingSpheres
spheresOfPoints(const CloudView& points)
{
  BoundingSpheres object;
  object.oriented = points.normal != nullptr;
  object.seen_radius = 0.0;
  const std::vector<std::size_t> sample = sampleOf(points);
  if (sample.empty()) return object;
  placeIn(points, sample, object);
  const auto radius = static_cast<float>(1.0 / std::sqrt(static_cast<double>(sample.size())));
  for (const std::size_t i : sample) {
    const Vector3 p = scaled(subtract(positionOf(points, i), object.origin), 1.0 / object.scale);
    BoundingSphere sphere{{}, radius, {}};
    for (std::size_t a = 0; a < 3; ++a) sphere.center[a] = static_cast<float>(p[a]);
    if (points.normal) {
      const auto n = floatsAt(points.normal, points.normal_stride, i);
      if (isFinite({n[0], n[1], n[2]})) sphere.normal = n;
    }
    object.spheres.push_back(sphere);
  }
  return object;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "view/scene.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim {
namespace {

constexpr std::size_t kSample = 20000;

/** \brief Input indices of finite points, evenly over the cloud. */
std::vector<std::size_t> sampleOf(const CloudView& points) {
  std::vector<std::size_t> sample;
  const std::size_t step = 1 + points.count() / kSample;
  for (std::size_t k = 0; k < points.count(); k += step) {
    const std::size_t i = points.inputIndex(k);
    if (isFinite(points.position(i))) sample.push_back(i);
  }
  return sample;
}

/** \brief Puts origin and scale to the middle and the diagonal of the sample's box. */
void placeIn(const CloudView& points, const std::vector<std::size_t>& sample,
             BoundingSpheres& object) {
  Bounds box;
  for (const std::size_t i : sample) box.add(points.position(i));
  object.origin = scaled(along(box.low, 1.0, box.high), 0.5);
  if (box.diagonal() > 0.0) object.scale = box.diagonal();
}

}  // namespace

BoundingSpheres spheresOfPoints(const CloudView& points) {
  BoundingSpheres object;
  object.seen_radius = 0.0;
  const std::vector<std::size_t> sample = sampleOf(points);
  if (sample.empty()) return object;
  placeIn(points, sample, object);
  const auto radius = static_cast<float>(1.0 / std::sqrt(static_cast<double>(sample.size())));
  for (const std::size_t i : sample) {
    const Vector3 p = scaled(subtract(points.position(i), object.origin), 1.0 / object.scale);
    BoundingSphere sphere{{}, radius, {}};
    for (std::size_t a = 0; a < 3; ++a) sphere.center[a] = static_cast<float>(p[a]);
    if (points.normal) {
      const auto n = points.givenNormal(i);
      if (isFinite(n)) sphere.normal = n;
    }
    object.spheres.push_back(sphere);
  }
  return object;
}

}  // namespace pcl_slim

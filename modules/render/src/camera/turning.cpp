// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/turning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "camera/bulk.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

using namespace detail;
namespace {

constexpr double kFullCircle = 2 * M_PI;
constexpr int kLayers = 128;  ///< of the object, along the axis
constexpr int kSides = 32;  ///< spheres on a ring; between two a half percent of its radius is lost

/** \brief An axis and two directions across it, orthonormal. */
struct AxisFrame {
  Vector3 up, right, back;

  explicit AxisFrame(const Vector3& axis) : up(normalized(axis))
  {
    const Vector3 other = std::abs(up[0]) < 0.7 ? Vector3{1.0, 0.0, 0.0} : Vector3{0.0, 1.0, 0.0};
    right = normalized(cross(other, up));
    back = cross(up, right);
  }

  /** \brief Coordinates along right, back and up. */
  Vector3 of(const std::array<float, 3>& c) const
  {
    const Vector3 at{c[0], c[1], c[2]};
    return {dot(at, right), dot(at, back), dot(at, up)};
  }
  Vector3 point(const Vector3& c) const
  {
    return along(along(scaled(right, c[0]), c[1], back), c[2], up);
  }
};

/** \brief Corners of the centres' box, in the axis' coordinates. */
struct FrameBox {
  Vector3 low, high;

  FrameBox(const std::vector<BoundingSphere>& spheres, const AxisFrame& frame)
  {
    low = high = frame.of(spheres.front().center);
    for (const BoundingSphere& sphere : spheres) {
      const Vector3 c = frame.of(sphere.center);
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], c[a]);
        high[a] = std::max(high[a], c[a]);
      }
    }
  }
  Vector3 middle() const { return scaled(along(low, 1.0, high), 0.5); }
};

/** \brief The ring that a sphere passes through. */
struct Ring {
  double distance = -1.0;  ///< of the sphere's centre from the axis; below 0: no ring
  double height = 0.0;
  float radius = 0.0f;
};

/** \brief Of each layer across the axis, the ring that reaches farthest out. */
std::vector<Ring>
outermostRings(const std::vector<BoundingSphere>& spheres, const AxisFrame& frame,
               const FrameBox& box)
{
  std::vector<Ring> rings(kLayers);
  const Vector3 middle = box.middle();
  const double extent = std::max(box.high[2] - box.low[2], std::numeric_limits<double>::min());
  for (const BoundingSphere& sphere : spheres) {
    const Vector3 c = subtract(frame.of(sphere.center), middle);
    const double share = (c[2] + middle[2] - box.low[2]) / extent;
    Ring& ring = rings[static_cast<std::size_t>(std::min(kLayers - 1.0, share * kLayers))];
    const double distance = std::hypot(c[0], c[1]);
    if (distance + double{sphere.radius} <= ring.distance + double{ring.radius}) continue;
    ring = {distance, c[2], sphere.radius};
  }
  return rings;
}

void
appendRing(const Ring& ring, const AxisFrame& frame, std::vector<BoundingSphere>& spheres)
{
  for (int k = 0; k < kSides; ++k) {
    const double angle = kFullCircle * k / kSides;
    const Vector3 outwards = frame.point({std::cos(angle), std::sin(angle), 0.0});
    const Vector3 c = along(scaled(outwards, ring.distance), ring.height, frame.up);
    BoundingSphere sphere{{}, ring.radius, {}};
    for (std::size_t a = 0; a < 3; ++a) {
      sphere.center[a] = static_cast<float>(c[a]);
      sphere.normal[a] = static_cast<float>(outwards[a]);
    }
    spheres.push_back(sphere);
  }
}

/** \brief v turned about a unit axis (Rodrigues). */
Vector3
turned(const Vector3& v, const Vector3& axis, double angle)
{
  const Vector3 straight = scaled(axis, dot(axis, v) * (1.0 - std::cos(angle)));
  return along(along(straight, std::cos(angle), v), std::sin(angle), cross(axis, v));
}

}  // namespace

BoundingSpheres
sweptAbout(const BoundingSpheres& object, const std::array<double, 3>& axis)
{
  const std::vector<BoundingSphere> bulk = bulkOf(object.spheres);
  BoundingSpheres swept = object;
  if (bulk.empty()) return swept;
  const AxisFrame frame(axis);
  const FrameBox box(bulk, frame);
  swept.origin = along(object.origin, object.scale, frame.point(box.middle()));
  swept.no_strays = true;
  swept.spheres.clear();
  for (const Ring& ring : outermostRings(bulk, frame, box)) {
    if (ring.distance >= 0.0) appendRing(ring, frame, swept.spheres);
  }
  return swept;
}

Camera
turnedCamera(const Camera& camera, const std::array<double, 3>& pivot,
             const std::array<double, 3>& axis, int turn, int count)
{
  if (turn == 0) return camera;
  const double angle = kFullCircle * turn / count;
  const Vector3 unit = normalized(axis);
  const Vector3 view = turned(subtract(camera.look_at, camera.position), unit, angle);
  Camera moved = camera;
  moved.position = along(pivot, 1.0, turned(subtract(camera.position, pivot), unit, angle));
  moved.look_at = along(moved.position, 1.0, view);
  moved.up = turned(camera.up, unit, angle);
  return moved;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "render/turntable.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim {
namespace {

/** \brief The median of the spheres' centres, world coordinates. */
Vector3
middleOf(const BoundingSpheres& object)
{
  Vector3 middle = object.origin;
  if (object.spheres.empty()) return middle;
  std::vector<float> values(object.spheres.size());
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = object.spheres[i].center[a];
    const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), half, values.end());
    middle[a] += object.scale * *half;
  }
  return middle;
}

/** \brief v turned about a unit axis (Rodrigues). */
Vector3
turned(const Vector3& v, const Vector3& axis, double angle)
{
  const Vector3 straight = scaled(axis, dot(axis, v) * (1.0 - std::cos(angle)));
  return along(along(straight, std::cos(angle), v), std::sin(angle), cross(axis, v));
}

}  // namespace

Camera
turnedCamera(const Camera& camera, const BoundingSpheres& object, int turn, int count)
{
  if (turn == 0) return camera;
  const double angle = 2.0 * std::acos(-1.0) * turn / count;
  const Vector3 middle = middleOf(object), axis = normalized(camera.up);
  const Vector3 offset = subtract(camera.position, middle);
  Camera moved = camera;
  moved.position = along(middle, 1.0, turned(offset, axis, angle));
  const Vector3 view = turned(subtract(camera.look_at, camera.position), axis, angle);
  moved.look_at = along(moved.position, 1.0, view);
  return moved;
}

std::string
turntablePath(const std::string& path, int turn, int count)
{
  if (count == 1) return path;
  char number[16];
  std::snprintf(number, sizeof number, "_%03d", turn);
  const std::size_t dot = path.rfind('.');
  return path.substr(0, dot) + number + path.substr(dot);
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_motion.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim {

Vector3 RigidMotion::direction(const Vector3& d) const {
  return {dot(rotation[0], d), dot(rotation[1], d), dot(rotation[2], d)};
}

Vector3 RigidMotion::place(const Vector3& p) const {
  return along(along(center, 1, translation), 1, direction(subtract(p, center)));
}

std::array<double, 16> RigidMotion::matrix() const {
  const Vector3 shift = subtract(along(center, 1, translation), direction(center));
  std::array<double, 16> made{};
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) made[4 * a + b] = rotation[a][b];
    made[4 * a + 3] = shift[a];
  }
  made[15] = 1;
  return made;
}

namespace detail {

RigidMotion rigidMotion(const Vector3& translation, const Vector3& rotation,
                        const Vector3& center) {
  RigidMotion made;
  made.center = center;
  made.translation = translation;
  const double angle = length(rotation);
  const Vector3 axis = normalized(rotation);
  const double c = std::cos(angle), s = std::sin(angle);
  for (std::size_t a = 0; a < 3; ++a) {
    Vector3 unit{};
    unit[a] = 1;
    // Column a: where the a-th axis turns.
    const Vector3 turned =
        along(along(scaled(unit, c), s, cross(axis, unit)), (1 - c) * axis[a], axis);
    for (std::size_t b = 0; b < 3; ++b) made.rotation[b][a] = turned[b];
  }
  return made;
}

RigidMotion composed(const RigidMotion& after, const RigidMotion& first) {
  RigidMotion made;
  made.center = first.center;
  for (std::size_t a = 0; a < 3; ++a) {
    Vector3 column{};
    for (std::size_t b = 0; b < 3; ++b) column[b] = first.rotation[b][a];
    const Vector3 turned = after.direction(column);
    for (std::size_t b = 0; b < 3; ++b) made.rotation[b][a] = turned[b];
  }
  made.translation = subtract(after.place(first.place(first.center)), first.center);
  return made;
}

Vector3 rotationVector(const RigidMotion& motion) {
  const auto& r = motion.rotation;
  const Vector3 twice_sine = {r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]};
  const double sine = 0.5 * length(twice_sine);
  const double cosine = 0.5 * (r[0][0] + r[1][1] + r[2][2] - 1);
  const double angle = std::atan2(sine, cosine);
  if (sine > 1e-12) return scaled(twice_sine, 0.5 * angle / sine);
  return scaled(twice_sine, 0.5);  // no rotation; a half turn has no direction of its own
}

}  // namespace detail
}  // namespace pcl_slim

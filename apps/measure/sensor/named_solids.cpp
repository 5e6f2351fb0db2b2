// SPDX-License-Identifier: BSD-3-Clause
#include "measure/sensor/sensor_scan.h"

namespace pcl_slim::measure {

namespace {

Solid
plane(const Vector3& center, const Vector3& axis)
{
  Solid solid;
  solid.center = center;
  solid.axis = normalized(axis);
  return solid;
}

Solid
sphere(const Vector3& center, double radius)
{
  Solid solid;
  solid.kind = Solid::Kind::kSphere;
  solid.center = center;
  solid.radius = radius;
  return solid;
}

Solid
waves(double wavelength, double amplitude)
{
  Solid solid = plane({0, 0, 1.2}, {0.3, 0.2, -1});
  solid.kind = Solid::Kind::kWaves;
  solid.wavelength = wavelength;
  solid.amplitude = amplitude;
  return solid;
}

/** Part of an upright wall. */
Solid
wall(const Vector3& center, const Vector3& axis, double length, double height)
{
  Solid solid = plane(center, axis);
  for (int a = 0; a < 2; ++a) {
    solid.low[a] = center[a] - 0.5 * length;
    solid.high[a] = center[a] + 0.5 * length;
  }
  solid.low[2] = 0;
  solid.high[2] = height;
  return solid;
}

Solid
pole(double x, double y, double radius, double height)
{
  Solid solid;
  solid.kind = Solid::Kind::kPole;
  solid.center = {x, y, 0};
  solid.radius = radius;
  solid.low[2] = 0;
  solid.high[2] = height;
  return solid;
}

Solid
foot()
{
  Solid solid = pole(0.01, -0.02, 0.04, 0);
  solid.low[2] = -0.18;
  return solid;
}

/** Wall, floor and two spheres in the air, 1.2 to 2.8 m away.
 * \param[in] tilt of the wall across the view [slope] */
std::vector<Solid>
hall(double tilt)
{
  return {plane({0, 0, 2.5}, {tilt, 0.02, -1}), plane({0, 0.5, 0}, {0, -1, 0}),
          sphere({-0.4375, 0.1, 2}, 0.3), sphere({0.436, 0.15, 1.6}, 0.25)};
}

std::vector<Solid>
street()
{
  return {plane({0, 0, 0}, {0, 0, 1}),
          wall({3, 9, 0}, {0, 1, 0}, 40, 6),
          wall({-4, -11, 0}, {0.05, 1, 0}, 36, 5),
          wall({22, 0, 0}, {1, 0.1, 0}, 16, 7),
          pole(6, 4, 0.15, 5),
          pole(-7, 5, 0.2, 5),
          pole(9, -6, 0.12, 5),
          pole(-5, -6, 0.3, 4)};
}

}  // namespace

std::vector<Solid>
namedSolids(const std::string& name)
{
  if (name == "room") {
    return {plane({0, 0, 3}, {0.15, 0, -1}), plane({0, 0.7, 0}, {0, -1, 0}),
            sphere({-0.35, 0.2, 1.6}, 0.3), sphere({0.45, 0.35, 1.1}, 0.2)};
  }
  if (name == "hall") return hall(0.2);
  if (name == "frontal hall") return hall(0.1);
  if (name == "balls") {
    return {plane({0, 0, 1.7}, {0.3, 0.1, -1}), plane({0, 0.5, 1.4}, {0, -1, -0.25}),
            sphere({-0.4, -0.1, 1.35}, 0.25),   sphere({0.1, 0.15, 1.1}, 0.16),
            sphere({0.35, -0.2, 1.2}, 0.1),     sphere({-0.1, -0.2, 0.9}, 0.08),
            sphere({0.2, 0.25, 0.85}, 0.06)};
  }
  if (name == "wave40") return {waves(0.4, 0.03)};
  if (name == "wave15") return {waves(0.15, 0.01)};
  if (name == "wave6") return {waves(0.06, 0.004)};
  if (name == "street") return street();
  if (name == "figure") {
    return {sphere({0, 0, 0}, 0.09), sphere({0.02, 0.01, 0.1}, 0.05), foot()};
  }
  return {};
}

}  // namespace pcl_slim::measure

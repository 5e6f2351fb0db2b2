// SPDX-License-Identifier: BSD-3-Clause
#include "measure/sensor/solids.h"

#include <cmath>
#include <limits>

namespace pcl_slim::measure {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kTwoPi = 2 * M_PI;
constexpr double kNear = 1e-6;  ///< rays start so far off
constexpr int kMarch = 400;     ///< steps in which waves are looked for around their plane
constexpr int kHalvings = 60;

/** The tangent that waves run along: as near to x as the axis allows. */
Vector3
firstTangent(const Vector3& axis)
{
  return normalized({1 - axis[0] * axis[0], -axis[0] * axis[1], -axis[0] * axis[2]});
}

/** Height above a plane with waves, in the direction of its axis. */
double
heightOver(const Solid& s, const Vector3& p)
{
  const Vector3 d = subtract(p, s.center);
  const double phase = kTwoPi / s.wavelength * dot(d, firstTangent(s.axis));
  return dot(d, s.axis) - s.amplitude * std::sin(phase);
}

/** The nearer root of a quadratic a t^2 + 2 b t + c that is positive. */
double
nearerRoot(double a, double b, double c)
{
  const double discriminant = b * b - a * c;
  if (!(discriminant > 0) || !(a > 0)) return kNever;
  const double root = std::sqrt(discriminant);
  if ((-b - root) / a > kNear) return (-b - root) / a;
  return (-b + root) / a > kNear ? (-b + root) / a : kNever;
}

double
meetWaves(const Solid& s, const Vector3& origin, const Vector3& direction)
{
  const double slope = dot(direction, s.axis), height = dot(subtract(origin, s.center), s.axis);
  const double near = (-height + s.amplitude) / slope, far = (-height - s.amplitude) / slope;
  double low = std::min(near, far), last = heightOver(s, along(origin, low, direction));
  const double step = std::abs(far - near) / kMarch;
  for (int i = 0; i <= kMarch; ++i, low += step) {
    const double next = heightOver(s, along(origin, low + step, direction));
    if ((next > 0) == (last > 0)) continue;
    double high = low + step;
    for (int k = 0; k < kHalvings; ++k) {
      const double middle = 0.5 * (low + high);
      const bool same = (heightOver(s, along(origin, middle, direction)) > 0) == (last > 0);
      (same ? low : high) = middle;
    }
    return low > kNear ? low : kNever;
  }
  return kNever;
}

double
meetUnbounded(const Solid& s, const Vector3& origin, const Vector3& direction)
{
  const Vector3 d = subtract(origin, s.center);
  switch (s.kind) {
    case Solid::Kind::kPlane: {
      const double t = -dot(d, s.axis) / dot(direction, s.axis);
      return t > kNear ? t : kNever;
    }
    case Solid::Kind::kWaves: return meetWaves(s, origin, direction);
    case Solid::Kind::kSphere:
      return nearerRoot(dot(direction, direction), dot(d, direction),
                        dot(d, d) - s.radius * s.radius);
    default:
      return nearerRoot(direction[0] * direction[0] + direction[1] * direction[1],
                        d[0] * direction[0] + d[1] * direction[1],
                        d[0] * d[0] + d[1] * d[1] - s.radius * s.radius);
  }
}

Foot
footFrom(const Vector3& offset, double radius)
{
  return {length(offset) - radius, normalized(offset)};
}

/** Newton steps along the plane's tangent to where the waves' normal points at the point. */
Foot
footOnWaves(const Solid& s, const Vector3& point)
{
  const Vector3 d = subtract(point, s.center), tangent = firstTangent(s.axis);
  const double k = kTwoPi / s.wavelength, x = dot(d, tangent), h = dot(d, s.axis);
  double u = x;
  for (int step = 0; step < 30; ++step) {
    const double wave = s.amplitude * std::sin(k * u), slope = s.amplitude * k * std::cos(k * u);
    const double residual = (u - x) + slope * (wave - h);
    const double bend = -k * k * wave;
    u -= residual / std::max(0.2, 1 + slope * slope + bend * (wave - h));
  }
  const double wave = s.amplitude * std::sin(k * u), slope = s.amplitude * k * std::cos(k * u);
  return {((h - wave) - slope * (x - u)) / std::sqrt(1 + slope * slope),
          normalized(along(s.axis, -slope, tangent))};
}

}  // namespace

double
meet(const Solid& solid, const Vector3& origin, const Vector3& direction)
{
  const double t = meetUnbounded(solid, origin, direction);
  if (t == kNever) return kNever;
  const Vector3 p = along(origin, t, direction);
  for (int a = 0; a < 3; ++a) {
    if (p[a] < solid.low[a] || p[a] > solid.high[a]) return kNever;
  }
  return t;
}

Foot
footOn(const Solid& solid, const Vector3& point)
{
  const Vector3 d = subtract(point, solid.center);
  switch (solid.kind) {
    case Solid::Kind::kPlane: return {dot(d, solid.axis), solid.axis};
    case Solid::Kind::kWaves: return footOnWaves(solid, point);
    case Solid::Kind::kSphere: return footFrom(d, solid.radius);
    default: return footFrom({d[0], d[1], 0}, solid.radius);
  }
}

}  // namespace pcl_slim::measure

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

/** \brief Evenly spread points of the unit square, turned by pixel: the sequence of the generalised
 * golden ratio from a place that hashes the pixel. */
class SquareSamples {
 public:
  SquareSamples(std::uint64_t pixel, std::uint64_t stream)
  {
    std::uint64_t z = (pixel * 64 + stream + 1) * 0x9e3779b97f4a7c15u;  // SplitMix64
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    x_ = static_cast<double>(z >> 40) * 0x1p-24;
    y_ = static_cast<double>(z & 0xffffffu) * 0x1p-24;
  }

  struct Place {
    double x, y;
  };
  Place at(std::uint64_t i) const
  {
    const double n = static_cast<double>(i);
    return {fraction(x_ + n * 0.75487766624669276), fraction(y_ + n * 0.56984029099805327)};
  }

 private:
  static double fraction(double v) { return v - std::floor(v); }

  double x_, y_;
};

constexpr double kFullTurn = 6.28318530717958648;

/** \brief A direction of the half space above a unit normal, as often as its cosine is large. */
inline Vector3
cosineDirection(const Vector3& normal, const SquareSamples::Place& at)
{
  const LocalFrame frame(normal);
  const double rho = std::sqrt(at.x), angle = kFullTurn * at.y;
  const Vector3 flat =
      along(scaled(frame.u, rho * std::cos(angle)), rho * std::sin(angle), frame.v);
  return along(flat, std::sqrt(1.0 - at.x), frame.w);
}

/** \brief A direction within an angle, given by its tangent, of a unit axis. */
inline Vector3
coneDirection(const Vector3& axis, double tangent, const SquareSamples::Place& at)
{
  if (!(tangent > 0.0)) return axis;
  const LocalFrame frame(axis);
  const double rho = tangent * std::sqrt(at.x), angle = kFullTurn * at.y;
  const Vector3 flat =
      along(scaled(frame.u, rho * std::cos(angle)), rho * std::sin(angle), frame.v);
  return normalized(along(flat, 1.0, frame.w));
}

}  // namespace pcl_slim::detail

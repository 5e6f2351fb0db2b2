// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>

#include "pcl_slim/core/vector3.h"

/** \brief A surface with detail of many sizes and a formula: a ball with folds, waves and grains,
 * one radius in each direction from its middle. */
namespace pcl_slim::bench {

/** \brief The radius in a unit direction: five octaves of products of sines, each turned against
 * the last. */
inline double generatedRadius(const Vector3& d) {
  double radius = 1.0, size = 0.16, wave = 5.0;
  Vector3 p = d;
  for (int octave = 0; octave < 5; ++octave) {
    radius += size * std::sin(wave * p[0] + 1.0) * std::sin(wave * p[1] + 2.0) *
              std::sin(wave * p[2] + octave);
    p = {0.6 * p[0] + 0.8 * p[1], 0.6 * (0.6 * p[1] - 0.8 * p[0]) + 0.8 * p[2],
         0.6 * p[2] - 0.8 * (0.6 * p[1] - 0.8 * p[0])};
    size *= 0.33;
    wave *= 2.6;
  }
  return radius;
}

/** \brief The surface's point in a unit direction. */
inline Vector3 generatedPoint(const Vector3& d) {
  return scaled(d, generatedRadius(d));
}

/** \brief The outer normal, from differences. */
inline Vector3 generatedNormal(const Vector3& d) {
  constexpr double kStep = 1e-5;
  const Vector3 a =
      normalized(cross(d, std::abs(d[0]) < 0.7 ? Vector3{1.0, 0.0, 0.0} : Vector3{0.0, 1.0, 0.0}));
  const Vector3 b = cross(d, a);
  const auto slope = [&](const Vector3& t) {
    return subtract(generatedPoint(normalized(along(d, kStep, t))),
                    generatedPoint(normalized(along(d, -kStep, t))));
  };
  return normalized(cross(slope(a), slope(b)));
}

/** \brief Direction i of count evenly spread ones (Fibonacci). */
inline Vector3 generatedDirection(std::size_t i, std::size_t count) {
  const double z = 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
  const double rho = std::sqrt(1.0 - z * z), angle = 2.39996322972865332 * static_cast<double>(i);
  return {rho * std::cos(angle), rho * std::sin(angle), z};
}

}  // namespace pcl_slim::bench

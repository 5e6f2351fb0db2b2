// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <random>

#include "support/clouds.h"

namespace pcl_slim_test {

/** \brief A sphere of radius .5 about the origin with a finger along z, round at its end. */
struct Finger {
  static constexpr double kRadius = 0.5, kEnd = 1.05;
  double thin;  ///< the finger's radius

  /** \brief Distance to the surface of both, negative inside either: next to the crease about that.
   */
  double distance(const std::array<double, 3>& p) const {
    const double along = std::clamp(p[2], 0.0, kEnd);
    return std::min(std::hypot(p[0], p[1], p[2]) - kRadius,
                    std::hypot(p[0], p[1], p[2] - along) - thin);
  }

  /** \brief Random points of its surface, by the areas of its parts, with isotropic noise. */
  Cloud cloud(std::size_t count, double noise) const {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    std::normal_distribution<double> gauss;
    const double sphere = 4 * kRadius * kRadius, side = 2 * thin * kEnd, ends = 4 * thin * thin;
    Cloud cloud;
    while (cloud.size() < count) {
      const double turn = 2 * M_PI * unit(random), z = 2 * unit(random) - 1;
      const double r = std::sqrt(1 - z * z), part = unit(random) * (sphere + side + ends);
      std::array<double, 3> p{kRadius * r * std::cos(turn), kRadius * r * std::sin(turn),
                              kRadius * z};
      if (part > sphere + side) {
        p = {thin * r * std::cos(turn), thin * r * std::sin(turn), kEnd + thin * z};
      } else if (part > sphere) {
        p = {thin * std::cos(turn), thin * std::sin(turn), kEnd * unit(random)};
      }
      if (distance(p) < -1e-9) continue;
      for (double& x : p) x += noise * gauss(random);
      cloud.add(p[0], p[1], p[2]);
    }
    return cloud;
  }
};

}  // namespace pcl_slim_test

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "clouds.h"

namespace pcl_slim_test {

/** Points in a box of a land survey's coordinates: metres, millions of them from the origin. */
inline Cloud surveyCloud(std::size_t count) {
  Cloud cloud;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (std::size_t i = 0; i < count; ++i) {
    cloud.add(432100.5 + 800 * u(random), 5412345.25 + 600 * u(random), 310 + 50 * u(random));
  }
  return cloud;
}

/** Largest distance between a stored point, brought back, and what was given [local]. */
inline double largestOffset(const Cloud& cloud, const pcl_slim::PointStore& store) {
  double worst = 0;
  for (std::size_t i = 0; i < store.size(); ++i) {
    const auto p = store.position(i);
    for (std::size_t a = 0; a < 3; ++a) {
      const double given = cloud.points[3 * store.orderOfStore()[i] + a];
      const double offset = std::abs((given - store.origin()[a]) / store.scale() - p[a]);
      if (!std::isfinite(offset)) return offset;
      worst = std::max(worst, offset);
    }
  }
  return worst;
}

}  // namespace pcl_slim_test

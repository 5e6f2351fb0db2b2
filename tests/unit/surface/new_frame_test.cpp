// SPDX-License-Identifier: BSD-3-Clause
// A polynomial in another ball and frame is the same surface.
#include "pcl_slim/surface/detail/new_frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace pcl_slim::detail {
namespace {

/** \brief Largest distance, in radii, between the two balls' surfaces along the new frame's normal.
 */
double largestOffset(const SurfelFrame& from, const std::array<float, 15>& c,
                     const SurfelFrame& to) {
  const auto rewritten = inNewFrame(4, c.data(), from, to);
  std::array<float, 15> single;
  std::copy(rewritten.begin(), rewritten.end(), single.begin());
  const LocalFrame old(from.normal), frame(to.normal);
  double worst = 0.0;
  for (double u = -0.6; u <= 0.6; u += 0.1) {
    for (double v = -0.6; v <= 0.6; v += 0.1) {
      const double h = evaluateHeight(4, single.data(), u, v);
      Vector3 p = along(to.center, to.radius * u, frame.u);
      p = along(along(p, to.radius * v, frame.v), to.radius * h, frame.w);
      const Vector3 d = scaled(subtract(p, from.center), 1.0 / from.radius);
      const double height = evaluateHeight(4, c.data(), dot(d, old.u), dot(d, old.v));
      worst = std::max(worst, std::abs(dot(d, old.w) - height));
    }
  }
  return worst;
}

std::array<float, 15> someCoefficients() {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> value(-0.1f, 0.1f);
  std::array<float, 15> c;
  for (float& x : c) x = value(random);
  return c;
}

TEST(NewFrame, IsExactForAnotherBall) {
  const SurfelFrame from{{0.1, 0.2, 0.3}, normalized({0.3, -0.5, 0.8}), 0.05};
  SurfelFrame to = from;
  to.center = {0.1007, 0.1995, 0.3003};
  to.radius = 0.0511;
  // The height above the plane changes with the centre, but not the directions: floats alone are
  // left.
  EXPECT_LT(largestOffset(from, someCoefficients(), to), 1e-7);
}

TEST(NewFrame, LeavesTiltTimesHeight) {
  const SurfelFrame from{{0.1, 0.2, 0.3}, normalized({0.3, -0.5, 0.8}), 0.05};
  for (const double tilt : {1e-3, 2e-3}) {
    SurfelFrame to = from;
    to.normal = normalized(along(from.normal, tilt, {1.0, 0.4, -0.2}));
    const double offset = largestOffset(from, someCoefficients(), to);
    // Heights and slopes reach .25 here.
    EXPECT_LT(offset, 0.1 * tilt);
    EXPECT_GT(offset, 0.0);
  }
}

TEST(NewFrame, KeepsAPlaneWhereTheFrameTurnsOver) {
  const std::array<float, 15> flat{};
  const SurfelFrame from{{0.0, 0.0, 0.0}, normalized({0.6, 0.8, 1e-3}), 1.0};
  SurfelFrame to = from;
  to.normal = normalized({0.6, 0.8, 2e-3});
  EXPECT_LT(largestOffset(from, flat, to), 1e-6);
}

}  // namespace
}  // namespace pcl_slim::detail

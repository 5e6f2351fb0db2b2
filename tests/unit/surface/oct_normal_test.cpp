// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/oct_normal.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim {
namespace {

/** Random directions, many of them in or near the coordinate planes and axes. */
std::array<double, 3> awkwardDirection(std::mt19937& random, int i) {
  std::normal_distribution<double> normal;
  std::array<double, 3> n{normal(random), normal(random), normal(random)};
  if (i % 3 == 0) n[static_cast<std::size_t>(i / 3 % 3)] *= 1e-7;
  if (i % 7 == 0) n[static_cast<std::size_t>(i / 7 % 3)] = 0.0;
  if (i % 11 == 0) n[static_cast<std::size_t>(i / 11 % 3)] *= -0.0;
  return n;
}

TEST(OctNormal, EncodingADecodedNormalGivesItsCode) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000000; ++i) {
    const OctNormal code = encodeNormal(awkwardDirection(random, i));
    const auto n = decodeNormal(code);
    const OctNormal again = encodeNormal({n[0], n[1], n[2]});
    ASSERT_EQ(code.a, again.a) << i;
    ASSERT_EQ(code.b, again.b) << i;
    ASSERT_NE(n[2], 0.0f);
  }
}

TEST(OctNormal, StaysNearAndTurnsRoundExactly) {
  std::mt19937 random(2);
  for (int i = 0; i < 200000; ++i) {
    const auto n = awkwardDirection(random, i);
    const double length = std::hypot(n[0], n[1], n[2]);
    if (!(length > 0.0)) continue;
    const auto snapped = snapNormal(n);
    ASSERT_LT(std::hypot(n[0] / length - snapped[0], n[1] / length - snapped[1],
                         n[2] / length - snapped[2]),
              6.5e-7);
    const auto opposite = snapNormal({-n[0], -n[1], -n[2]});
    for (std::size_t a = 0; a < 3; ++a) ASSERT_EQ(opposite[a], -snapped[a]) << i;
  }
}

TEST(OctNormal, SnappedFramesTurnRoundExactly) {
  std::mt19937 random(3);
  for (int i = 0; i < 20000; ++i) {
    const auto n = snapNormal(awkwardDirection(random, i));
    const LocalFrame frame({n[0], n[1], n[2]}), turned({-n[0], -n[1], -n[2]});
    ASSERT_EQ(frame.u, turned.u);
    for (std::size_t a = 0; a < 3; ++a) ASSERT_EQ(frame.v[a], -turned.v[a]);
  }
}

TEST(OctNormal, NothingUsableCountsAsUp) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::array<float, 3> up{0.0f, 0.0f, 1.0f};
  EXPECT_EQ(snapNormal({0.0, 0.0, 0.0}), up);
  EXPECT_EQ(snapNormal({nan, 1.0, 0.0}), up);
}

}  // namespace
}  // namespace pcl_slim

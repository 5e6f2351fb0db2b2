// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/trim_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/sphere_surface.h"
#include "support/trim_maps.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

/** A map whose nodes left of a column are inside. */
std::vector<std::uint8_t>
leftOf(int column, int side)
{
  std::vector<std::uint8_t> bits(TrimMap::numBytes(side));
  for (int k = 0; k < side * side; ++k) {
    if (k % side < column)
      bits[static_cast<std::size_t>(k >> 3)] |= static_cast<std::uint8_t>(1 << (k & 7));
  }
  return bits;
}

TEST(TrimMap, ClosedIsInsideEverywhere)
{
  EXPECT_TRUE(TrimMap().closed());
  EXPECT_EQ(outsideShare(TrimMap(), 0.3, -0.9), 0.0);
}

TEST(TrimMap, AStraightBorderLiesHalfWayBetweenItsNodes)
{
  const int side = 9;
  const auto bits = leftOf(6, side);
  const TrimMap map{side, bits.data()};
  const double step = 2.0 / (side - 1), border = -1.0 + 5.5 * step;
  for (double v = -0.9; v < 1.0; v += 0.13) {
    EXPECT_NEAR(outsideShare(map, border, v), 0.5, 1e-12);
    EXPECT_NEAR(outsideShare(map, border - 1.5 * step, v), 0.0, 1e-12);
    EXPECT_NEAR(outsideShare(map, border + 1.5 * step, v), 1.0, 1e-12);
    for (double u = -1.0; u < 0.99; u += 0.01) {
      EXPECT_LE(outsideShare(map, u, v), outsideShare(map, u + 0.01, v) + 1e-12);
    }
  }
}

TEST(TrimMap, FlippingASurfelMirrorsItsMap)
{
  SLIMSurface surface = sphereSurface(3, 100);
  setRandomTrimMaps(surface);
  SLIMSurface flipped = surface;
  for (std::size_t i = 0; i < surface.size(); ++i) flipped.flip(i);
  ASSERT_FALSE(flipped.validate());
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const TrimMap map = surface.trimMap(i), turned = flipped.trimMap(i);
    ASSERT_EQ(map.closed(), i % 3 == 0);
    for (double u = -0.95; u < 1.0; u += 0.31) {
      for (double v = -0.95; v < 1.0; v += 0.31) {
        EXPECT_NEAR(outsideShare(map, u, v), outsideShare(turned, u, -v), 1e-12) << i;
      }
    }
  }
  for (std::size_t i = 0; i < surface.size(); ++i) flipped.flip(i);
  EXPECT_EQ(surface.trim_maps, flipped.trim_maps);
}

TEST(TrimMap, ValidationNamesBrokenMaps)
{
  SLIMSurface surface = sphereSurface(2, 20);
  setRandomTrimMaps(surface);
  ASSERT_FALSE(surface.validate());
  const auto defectOf = [&](const auto& damage) {
    SLIMSurface broken = surface;
    damage(broken);
    return broken.validate().message;
  };
  EXPECT_NE(defectOf([](SLIMSurface& s) { s.flags[1] ^= kSurfelOpen; }), "");
  EXPECT_NE(defectOf([](SLIMSurface& s) { s.flags[0] |= kSurfelOpen; }), "");
  EXPECT_NE(defectOf([](SLIMSurface& s) { s.trim_maps.pop_back(); }), "");
  EXPECT_NE(defectOf([](SLIMSurface& s) { s.trim_maps[0] = 200; }), "");
  EXPECT_NE(defectOf([](SLIMSurface& s) { s.trim_begin.pop_back(); }), "");
  EXPECT_EQ(defectOf([](SLIMSurface& s) { s.dropTrimMaps(); }), "");
}

}  // namespace
}  // namespace pcl_slim

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
std::vector<std::uint8_t> leftOf(int column, int side) {
  std::vector<std::uint8_t> bits(TrimMap::numBytes(side));
  for (int k = 0; k < side * side; ++k) {
    if (k % side < column)
      bits[static_cast<std::size_t>(k >> 3)] |= static_cast<std::uint8_t>(1 << (k & 7));
  }
  return bits;
}

TEST(TrimMap, ClosedIsInsideEverywhere) {
  EXPECT_TRUE(TrimMap().closed());
  EXPECT_EQ(outsideShare(TrimMap(), 0.3, -0.9), 0.0);
}

TEST(TrimMap, AStraightBorderLiesHalfWayBetweenItsNodes) {
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

TEST(TrimMap, AHalfMapHasHalfOfThePoints) {
  EXPECT_EQ(filledShare(TrimMap(), WeightKernel::kPower4), 1.0);
  const int side = 12;
  const auto half = leftOf(side / 2, side), all = leftOf(side, side), none = leftOf(0, side);
  EXPECT_NEAR(filledShare({side, half.data()}, WeightKernel::kPower4), 0.5, 1e-12);
  EXPECT_NEAR(filledShare({side, all.data()}, WeightKernel::kPower4), 1.0, 1e-12);
  EXPECT_EQ(filledShare({side, none.data()}, WeightKernel::kPower4), 1.0);
}

TEST(TrimMap, FlippingASurfelMirrorsItsMap) {
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

TEST(TrimMap, ValidationNamesBrokenMaps) {
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

/** A map of one round hole, so many nodes wide, in its middle. */
std::vector<std::uint8_t> aroundHole(double width, int side) {
  std::vector<std::uint8_t> bits(TrimMap::numBytes(side));
  const double middle = 0.5 * (side - 1);
  for (int k = 0; k < side * side; ++k) {
    if (std::hypot(k % side - middle, k / side - middle) > 0.5 * width)
      bits[static_cast<std::size_t>(k >> 3)] |= static_cast<std::uint8_t>(1 << (k & 7));
  }
  return bits;
}

TEST(TrimMap, HolesAreClosedByTheirWidth) {
  constexpr int kSide = 33;
  SLIMSurface surface = sphereSurface(2, 3);
  // Two holes, eight and fourteen spacings wide in the data, and a straight border.
  std::vector<std::uint8_t> bits;
  for (const auto& map : {aroundHole(7.0, kSide), aroundHole(13.0, kSide), leftOf(20, kSide)}) {
    bits.insert(bits.end(), map.begin(), map.end());
  }
  surface.setTrimMaps(std::vector<std::uint8_t>(3, kSide), bits);
  const SLIMSurface before = surface;

  surface.closeHoles(4.0);
  EXPECT_EQ(surface.trim_maps, before.trim_maps);
  surface.closeHoles(10.0, 3);
  EXPECT_TRUE(surface.trimMap(0).closed());
  ASSERT_FALSE(surface.trimMap(1).closed());
  EXPECT_FALSE(surface.trimMap(1).at(kSide / 2, kSide / 2));
  surface.closeHoles(18.0);
  EXPECT_TRUE(surface.trimMap(1).closed());
  surface.closeHoles(1e6);  // a border is no hole, however wide
  ASSERT_FALSE(surface.trimMap(2).closed());
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      EXPECT_EQ(surface.trimMap(2).at(column, row), column < 20) << column << ' ' << row;
    }
  }
  EXPECT_FALSE(surface.validate());
}

TEST(TrimMap, ClosingHolesOpensNothing) {
  SLIMSurface surface = sphereSurface(3, 200);
  setRandomTrimMaps(surface);
  SLIMSurface closed = surface, again = surface;
  closed.closeHoles(5.0, 1);
  again.closeHoles(5.0, 4);
  EXPECT_EQ(closed.trim_maps, again.trim_maps);
  ASSERT_FALSE(closed.validate());
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const TrimMap map = surface.trimMap(i), later = closed.trimMap(i);
    if (later.closed()) continue;
    for (int k = 0; k < map.side * map.side; ++k) {
      EXPECT_GE(later.at(k % map.side, k / map.side), map.at(k % map.side, k / map.side));
    }
  }
}

}  // namespace
}  // namespace pcl_slim

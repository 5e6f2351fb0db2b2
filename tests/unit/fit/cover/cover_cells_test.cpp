// SPDX-License-Identifier: BSD-3-Clause
// The cells of a level: which touch which.
#include "cover/cover.h"

#include <gtest/gtest.h>

#include <set>

#include "pcl_slim/cloud/morton.h"
#include "support/clouds.h"

namespace pcl_slim {

using namespace detail;

namespace {

/** Coordinates of a cell, bit by bit. */
std::array<int, 3> placeOf(std::uint64_t code) {
  std::array<int, 3> place{};
  for (int bit = 0; bit < kMortonBits; ++bit) {
    for (int a = 0; a < 3; ++a)
      place[static_cast<std::size_t>(a)] |= static_cast<int>(code >> (3 * bit + 2 - a) & 1) << bit;
  }
  return place;
}

TEST(CoverCells, KnowTheCellsTheyTouch) {
  const PointStore store = pcl_slim_test::storeOf(
      pcl_slim_test::sceneCloud(measure::Shape::kTorus, 5000, 0.01).withoutNormals());
  AlignedVector<std::uint32_t> points(store.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) points[i] = i;
  for (const double reach : {0.2, 0.05, 0.02}) {
    CoverCells cells;
    cells.divide(store, points, reach);
    ASSERT_GT(cells.size(), 1u);
    for (std::uint32_t i = 0; i < cells.size(); ++i) {
      std::set<std::uint32_t> touching, expected;
      cells.forTouching(i, [&](std::uint32_t j) { touching.insert(j); });
      const auto own = placeOf(cells[i].code);
      for (std::uint32_t j = 0; j < cells.size(); ++j) {
        const auto other = placeOf(cells[j].code);
        int apart = 0;
        for (std::size_t a = 0; a < 3; ++a) apart = std::max(apart, std::abs(own[a] - other[a]));
        if (apart == 1) expected.insert(j);
      }
      ASSERT_EQ(touching, expected) << i;
      for (const std::uint32_t j : touching) EXPECT_NE(cells.colorOf(i), cells.colorOf(j));
    }
  }
}

}  // namespace
}  // namespace pcl_slim

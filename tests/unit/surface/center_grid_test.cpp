// SPDX-License-Identifier: BSD-3-Clause
// Neighbours among surfels' centres against all pairs.
#include "pcl_slim/surface/detail/center_grid.h"

#include <gtest/gtest.h>

#include <random>
#include <tuple>

namespace pcl_slim {

using namespace detail;

namespace {

SLIMSurface randomCenters(std::size_t count, float spread, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-spread, spread);
  SLIMSurface surface;
  surface.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    surface.cx[i] = place(random);
    surface.cy[i] = place(random);
    surface.cz[i] = place(random);
  }
  return surface;
}

std::vector<std::uint32_t> everyNth(const SLIMSurface& surface, std::uint32_t step) {
  std::vector<std::uint32_t> surfels;
  for (std::uint32_t i = 0; i < surface.size(); i += step) surfels.push_back(i);
  return surfels;
}

float distanceSq(const SLIMSurface& s, std::uint32_t i, std::uint32_t j) {
  const float ex = s.cx[j] - s.cx[i], ey = s.cy[j] - s.cy[i], ez = s.cz[j] - s.cz[i];
  return ex * ex + ey * ey + ez * ez;
}

// Widths from a few cells in all to more than an axis has digits for in one pass.
class CenterGridTest : public testing::TestWithParam<std::tuple<std::size_t, float>> {};

TEST_P(CenterGridTest, AWalkFindsWhatAllPairsFind) {
  const auto [count, width] = GetParam();
  const SLIMSurface surface = randomCenters(count, width < 0.01f ? 0.02f : 0.5f, 3);
  const auto members = everyNth(surface, 2), seekers = everyNth(surface, 3);
  const CenterGrid grid(surface, members, width);
  CenterGrid::Walk walk(grid);
  CenterGrid::Near near;
  std::int64_t last_cell = -1;
  std::uint32_t last_surfel = 0;
  std::size_t found = 0, expected = 0;
  for (const auto& [cell, i] : grid.sortedByCell(surface, seekers)) {
    ASSERT_TRUE(cell > last_cell || (cell == last_cell && i > last_surfel));
    last_cell = cell;
    last_surfel = i;
    const float place[3] = {surface.cx[i], surface.cy[i], surface.cz[i]};
    grid.findWithin(walk.around(cell), place, width * width, near);
    for (std::size_t k = 0; k < near.count; ++k) {
      const std::uint32_t j = grid.memberAt(near.places[k]);
      ASSERT_EQ(j % 2, 0u);
      ASSERT_EQ(near.distances_sq[k], distanceSq(surface, i, j));
      ASSERT_LT(near.distances_sq[k], width * width);
    }
    found += near.count;
    for (const std::uint32_t j : members) expected += distanceSq(surface, i, j) < width * width;
  }
  EXPECT_EQ(found, expected);
  EXPECT_GT(found, seekers.size());
}

INSTANTIATE_TEST_SUITE_P(Sizes, CenterGridTest,
                         testing::Values(std::make_tuple(100u, 0.7f), std::make_tuple(1500u, 0.2f),
                                         std::make_tuple(1500u, 0.09f),
                                         std::make_tuple(3000u, 0.004f)));

TEST(CenterGrid, EqualPlacesStandInOrderAndFarOnesAtTheRim) {
  SLIMSurface surface = randomCenters(1000, 0.0f, 1);
  surface.cx[500] = 40.0f;
  surface.cy[501] = -40.0f;
  const auto all = everyNth(surface, 1);
  const CenterGrid grid(surface, all, 0x1p-19f);
  std::size_t at_rim = 0, in_middle = 0;
  grid.forEachNear(40.0f, 0.0f, 0.0f, [&](std::uint32_t i, float) { at_rim += i == 500; });
  std::uint32_t last = 0;
  grid.forEachNear(0.0f, 0.0f, 0.0f, [&](std::uint32_t i, float distance_sq) {
    EXPECT_EQ(distance_sq, 0.0f);
    EXPECT_GE(i, last);
    last = i;
    ++in_middle;
  });
  EXPECT_EQ(at_rim, 1u);
  EXPECT_EQ(in_middle, 998u);
}

}  // namespace
}  // namespace pcl_slim

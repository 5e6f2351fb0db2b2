// SPDX-License-Identifier: BSD-3-Clause
#include "sides/cell_sheet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "support/clouds.h"

namespace pcl_slim::detail {
namespace {

using namespace pcl_slim_test;

TEST(CellSheet, NearestCellsAreThoseOfASort)
{
  std::mt19937_64 rng(5);
  std::normal_distribution<double> gauss(0, 1);
  Cloud cloud;
  for (int i = 0; i < 20000; ++i) {
    const double x = gauss(rng), y = gauss(rng), z = gauss(rng), r = std::hypot(x, y, z);
    const double radius = 1 + 0.05 * gauss(rng);
    cloud.add(radius * x / r, radius * y / r, radius * z / r);
  }
  const SideCells cut(storeOf(cloud), 0.02, 1);
  const SideConstants constants;
  for (std::uint32_t c = 0; c < cut.cells.size(); c += 97) {
    std::array<std::uint32_t, SideCells::kWindow> window;
    std::vector<std::pair<float, std::uint32_t>> nearest;
    for (std::size_t k = 0, n = cut.cellsAbout(c, window); k < n; ++k) {
      const Vector3 d = subtract(cut.cells[window[k]].mean, cut.cells[c].mean);
      nearest.emplace_back(static_cast<float>(dot(d, d)), window[k]);
    }
    std::sort(nearest.begin(), nearest.end());
    const CellSheet sheet = sheetOf(cut, c, constants);
    ASSERT_GT(sheet.count, 0u);
    EXPECT_EQ(sheet.cells[0], c);
    for (std::size_t k = 0; k < sheet.count; ++k) EXPECT_EQ(sheet.cells[k], nearest[k].second) << k;
  }
}

TEST(CellSheet, WindowHasTheCellsWithinTwoSteps)
{
  std::mt19937_64 rng(6);
  std::uniform_real_distribution<double> unit(0, 1);
  Cloud cloud;
  for (int i = 0; i < 3000; ++i) cloud.add(unit(rng), unit(rng), unit(rng));
  const SideCells cut(storeOf(cloud), 0.07, 1);
  const auto placeOf = [&](std::uint32_t c, std::size_t a) {
    return static_cast<int>(std::floor((cut.cells[c].mean[a] + 0.5) / cut.width));
  };
  for (std::uint32_t c = 0; c < cut.cells.size(); ++c) {
    std::array<std::uint32_t, SideCells::kWindow> window;
    std::vector<std::uint32_t> found(window.begin(), window.begin() + cut.cellsAbout(c, window));
    std::vector<std::uint32_t> expected;
    for (std::uint32_t other = 0; other < cut.cells.size(); ++other) {
      bool near = true;
      for (std::size_t a = 0; a < 3; ++a) near &= std::abs(placeOf(c, a) - placeOf(other, a)) <= 2;
      if (near) expected.push_back(other);
    }
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected) << c;
  }
}

}  // namespace
}  // namespace pcl_slim::detail

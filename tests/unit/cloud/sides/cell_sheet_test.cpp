// SPDX-License-Identifier: BSD-3-Clause
#include "sides/side_cells.h"

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

TEST(CellSheet, NearestCellsAreThoseOfASort) {
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
    SheetCells from;
    sheetOf(cut, c, constants, from);
    ASSERT_GT(from.count, 0u);
    EXPECT_EQ(from.cells[0], c);
    for (std::size_t k = 0; k < from.count; ++k) EXPECT_EQ(from.cells[k], nearest[k].second) << k;
  }
}

// Every neighbourhood of a plane's size contains all sides of a rod six points around.
TEST(CellSheet, NormalsOfAThinRodAreRadial) {
  Cloud cloud;
  for (int ring = 0; ring < 100; ++ring) {
    for (int i = 0; i < 6; ++i) {
      const double angle = (i + 0.5 * (ring % 2)) * M_PI / 3;
      cloud.add(std::cos(angle), std::sin(angle), ring);
    }
  }
  const PointStore store = storeOf(cloud);
  const SideCells cut(store, 1.2 / store.scale(), 1);
  const SideConstants constants;
  std::size_t rods = 0;
  for (std::uint32_t c = 0; c < cut.cells.size(); ++c) {
    SheetCells from;
    const CellSheet sheet = sheetOf(cut, c, constants, from);
    if (!sheet.isRod()) continue;
    ++rods;
    EXPECT_GT(std::abs(sheet.axis[2]), 0.99);
    for (std::size_t i = 0; i < store.size(); ++i) {
      if (cut.cell_of[i] != c) continue;
      const Vector3 normal = sheet.rodNormal(subtract(store.position(i), cut.cells[c].mean));
      const std::uint32_t at = store.orderOfStore()[i];
      const double angle = (at % 6 + 0.5 * (at / 6 % 2)) * M_PI / 3;
      EXPECT_GT(normal[0] * std::cos(angle) + normal[1] * std::sin(angle), 0.9);
    }
    for (std::size_t k = 1; k < from.count; ++k) {
      const Vector3 between = subtract(cut.cells[from.cells[k]].mean, cut.cells[c].mean);
      const double beyond = sheet.middle - dot(between, sheet.normal);
      if (std::abs(beyond) > 1e-6) {
        EXPECT_EQ(from.isOther(k), beyond > 0) << k;
      }
    }
  }
  EXPECT_GT(rods, cut.cells.size() * 9 / 10);
}

TEST(CellSheet, WindowHasTheCellsWithinTwoSteps) {
  std::mt19937_64 rng(6);
  std::uniform_real_distribution<double> unit(0, 1);
  Cloud cloud;
  for (int i = 0; i < 9000; ++i) cloud.points.push_back(unit(rng));
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

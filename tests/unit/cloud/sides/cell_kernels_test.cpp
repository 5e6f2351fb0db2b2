// SPDX-License-Identifier: BSD-3-Clause
#include "sides/side_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "support/instruction_sets.h"

namespace pcl_slim::detail {
namespace {

using namespace pcl_slim_test;

constexpr std::size_t kCells = SideConstants::kMostNeighbors;

/** Cells on two sheets, .6 apart along z, and the covariances of their points. */
NearCells twoSheets(std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  NearCells near;
  for (auto& column : near.columns) column.fill(0);
  for (std::size_t k = 0; k < kCells; ++k) {
    near.columns[0][k] = std::ceil(9 * unit(rng));
    for (std::size_t c = 1; c < 10; ++c) near.columns[c][k] = 0.1 * (unit(rng) - 0.5);
    near.columns[3][k] += 0.3 * static_cast<double>(k % 3 == 0);
  }
  return near;
}

double heightOf(const NearCells& near, std::size_t k, const std::array<double, 3>& n) {
  return n[0] * near.columns[1][k] + n[1] * near.columns[2][k] + n[2] * near.columns[3][k];
}

TEST(CellKernels, SumsAreThoseOfALoop) {
  const NearCells near = twoSheets(1);
  forEachInstructionSet([&](const char* target) {
    for (const std::uint64_t chosen :
         {0x0ull, 0xfffull, 0x3f000ull, 0xfffffffffull, 0x924924924ull}) {
      CellSums expected{};
      for (std::size_t k = 0; k < kCells; ++k) {
        if ((chosen >> k & 1) == 0) continue;
        const double count = near.columns[0][k];
        expected[0] += count;
        for (std::size_t a = 0, c = 4; a < 3; ++a) {
          expected[1 + a] += count * near.columns[1 + a][k];
          for (std::size_t b = a; b < 3; ++b, ++c) {
            expected[c] +=
                count * (near.columns[c][k] + near.columns[1 + a][k] * near.columns[1 + b][k]);
          }
        }
      }
      const CellSums sums = kernels::sumCells(near, chosen);
      for (std::size_t c = 0; c < sums.size(); ++c)
        EXPECT_NEAR(sums[c], expected[c], 1e-12) << target << ' ' << chosen << ' ' << c;
    }
  });
}

TEST(CellKernels, SheetsArePartedAsByALoop) {
  const std::array<double, 3> normal = {0.1, 0.2, std::sqrt(0.95)};
  forEachInstructionSet([&](const char* target) {
    for (const std::size_t count : {std::size_t{12}, std::size_t{18}, kCells}) {
      const NearCells near = twoSheets(count);
      double total = 0, mean = 0;
      for (std::size_t k = 0; k < count; ++k) {
        total += near.columns[0][k];
        mean += near.columns[0][k] * heightOf(near, k, normal);
      }
      mean /= total;
      const TwoSheets two = kernels::separateCells(near, count, normal, mean, 4);
      double above = 0, sums[2] = {0, 0};
      for (std::size_t k = 0; k < count; ++k) {
        const bool high = k % 3 == 0;
        EXPECT_EQ((two.higher >> k & 1) != 0, high) << target << ' ' << count << ' ' << k;
        above += high ? near.columns[0][k] : 0;
        sums[high] += near.columns[0][k] * (heightOf(near, k, normal) - mean);
      }
      EXPECT_EQ(two.higher >> count, 0u) << target;
      EXPECT_DOUBLE_EQ(two.above, above) << target;
      EXPECT_NEAR(two.gap, sums[1] / above - sums[0] / (total - above), 1e-12) << target;
    }
  });
}

TEST(CellKernels, CellsOfOneHeightAreNotParted) {
  NearCells near;
  for (auto& column : near.columns) column.fill(0);
  std::fill_n(near.columns[0].begin(), kCells, 2.0);
  forEachInstructionSet([&](const char* target) {
    const TwoSheets two = kernels::separateCells(near, kCells, {0, 0, 1}, 0, 4);
    EXPECT_EQ(two.gap, 0) << target;
    EXPECT_EQ(two.square, 0) << target;
  });
}

}  // namespace
}  // namespace pcl_slim::detail

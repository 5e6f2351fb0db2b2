// SPDX-License-Identifier: BSD-3-Clause
#include "cell_counts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <vector>

namespace {

using namespace pcl_slim;
using namespace pcl_slim::detail;

/** Codes of points of which half are in one small cube. */
std::vector<std::uint64_t> someKeys(std::size_t count) {
  std::mt19937_64 random(3);
  std::vector<std::uint64_t> keys;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t key = random() >> 1;
    keys.push_back(i % 2 == 0 ? key : (std::uint64_t{5} << 48) | (key >> 21));
  }
  return keys;
}

TilePlan planOf(const std::vector<std::uint64_t>& keys, std::uint64_t most_of_cell,
                std::uint64_t tile, CellCounts& counts) {
  do {
    const Error error = counts.add(keys.data(), keys.size());
    EXPECT_FALSE(error) << error.message;
  } while (counts.divideCells(most_of_cell));
  TilePlan plan;
  plan.cells = counts.cells();
  plan.makeTiles(tile);
  return plan;
}

TEST(CellCounts, CountEveryPointInTheCellThatHoldsIt) {
  const auto keys = someKeys(20000);
  CellCounts counts;
  const TilePlan plan = planOf(keys, 100, 1000, counts);
  std::uint64_t sum = 0, end = 0;
  for (const TilePlan::Cell& cell : plan.cells) {
    const std::uint64_t width = std::uint64_t{1} << (3 * (kDeepestCell - cell.depth));
    EXPECT_GE(cell.first_key, end) << "cells ascend and do not overlap";
    end = cell.first_key + width;
    const auto inside = std::count_if(keys.begin(), keys.end(), [&](std::uint64_t key) {
      return key >= cell.first_key && key < end;
    });
    EXPECT_EQ(cell.points, inside);
    EXPECT_LE(cell.points, 100u);
    sum += cell.points;
  }
  EXPECT_EQ(sum, keys.size());
}

TEST(CellCounts, LeavePointsOutThatNoStoreTakes) {
  const std::vector<std::uint64_t> keys{7, PointKeys::kLeftOut, 8};
  CellCounts counts;
  const TilePlan plan = planOf(keys, 100, 1000, counts);
  EXPECT_EQ(plan.points, 2u);
}

TEST(CellCounts, GiveEachCellItsNumber) {
  const auto keys = someKeys(5000);
  CellCounts counts;
  const TilePlan plan = planOf(keys, 50, 1000, counts);
  counts.numberCells();
  for (const std::uint64_t key : keys) {
    const std::uint32_t number = counts.numberOf(key);
    ASSERT_LT(number, plan.cells.size());
    const TilePlan::Cell& cell = plan.cells[number];
    EXPECT_EQ(cellOf(key, static_cast<int>(cell.depth)),
              cellOf(cell.first_key, static_cast<int>(cell.depth)));
  }
}

TEST(TilePlan, TilesHoldEveryCellOnceAndNoMorePointsThanAsked) {
  const auto keys = someKeys(30000);
  CellCounts counts;
  const TilePlan plan = planOf(keys, 40, 1500, counts);
  ASSERT_GT(plan.tiles.size(), 20u);
  std::size_t cell = 0;
  std::uint64_t end = 0, sum = 0;
  for (const TilePlan::Tile& tile : plan.tiles) {
    EXPECT_EQ(tile.first_cell, cell);
    EXPECT_GE(tile.first_key, end);
    EXPECT_LE(tile.points, 1500u);
    cell = tile.end_cell;
    end = tile.end_key;
    sum += tile.points;
    const auto inside = std::count_if(keys.begin(), keys.end(), [&](std::uint64_t key) {
      return key >= tile.first_key && key < tile.end_key;
    });
    EXPECT_EQ(tile.points, static_cast<std::uint64_t>(inside));
  }
  EXPECT_EQ(cell, plan.cells.size());
  EXPECT_EQ(sum, plan.points);
  EXPECT_LT(plan.tiles.size(), 4 * plan.points / 1500) << "small neighbours are joined";
}

TEST(TilePlan, PointsAtOnePlaceAreOneTile) {
  const std::vector<std::uint64_t> keys(5000, 123456789);
  CellCounts counts;
  const TilePlan plan = planOf(keys, 40, 1500, counts);
  ASSERT_EQ(plan.tiles.size(), 1u);
  EXPECT_EQ(plan.tiles[0].points, 5000u);
}

}  // namespace

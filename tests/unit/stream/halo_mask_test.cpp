// SPDX-License-Identifier: BSD-3-Clause
#include "tile_store.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "cell_counts.h"
#include "pcl_slim/cloud/morton.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::detail;

using Place = std::array<double, 3>;

std::uint64_t keyOf(const Place& p) {
  return mortonCode(p[0], p[1], p[2]);
}

/** The mask of one tile of all these points. */
HaloMask maskOf(const AlignedVector<std::uint64_t>& keys, double reach) {
  CellCounts counts;
  EXPECT_FALSE(counts.add(keys.data(), keys.size()));
  TilePlan plan;
  plan.cells = counts.cells();
  plan.makeTiles(keys.size());
  return {plan, plan.tiles.at(0), keys, reach};
}

/** Points of a curved strip. */
std::vector<Place> strip(std::size_t count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-0.2, 0.1);
  std::vector<Place> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = uniform(random), y = 0.5 * uniform(random);
    points.push_back({x, y, 0.5 * x * x + 0.3 * y});
  }
  return points;
}

TEST(HaloMask, HoldsEveryPlaceWithinReachAndFewFarOff) {
  const double reach = 0.03;
  const auto core = strip(3000);
  AlignedVector<std::uint64_t> keys;
  for (const Place& p : core) keys.push_back(keyOf(p));
  const HaloMask mask = maskOf(keys, reach);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-0.3, 0.3);
  std::size_t near = 0, far = 0, held_far = 0;
  for (int i = 0; i < 20000; ++i) {
    const Place p{uniform(random), uniform(random), uniform(random)};
    double least = 1;
    for (const Place& q : core)
      least = std::min(least, std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
    const bool held = mask.holds(keyOf(p));
    if (least <= reach) {
      ++near;
      EXPECT_TRUE(held) << least;
    } else if (least > 2 * reach) {
      ++far;
      held_far += held;
    }
  }
  EXPECT_GT(near, 100u);
  EXPECT_GT(far, 1000u);
  EXPECT_EQ(held_far, 0u);  // cells are a quarter of the reach at most: half of it beyond
}

TEST(HaloMask, MeetsACellWhereItHoldsAPlaceInIt) {
  const auto core = strip(500);
  AlignedVector<std::uint64_t> keys;
  for (const Place& p : core) keys.push_back(keyOf(p));
  const HaloMask mask = maskOf(keys, 0.01);
  for (const std::uint32_t depth : {4u, 8u, 11u}) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-0.25, 0.25);
    for (int i = 0; i < 5000; ++i) {
      const Place p{uniform(random), uniform(random), uniform(random)};
      TilePlan::Cell cell;
      cell.depth = depth;
      const int below = 3 * (kDeepestCell - static_cast<int>(depth));
      cell.first_key = keyOf(p) >> below << below;
      EXPECT_TRUE(!mask.holds(keyOf(p)) || mask.meets(cell));
    }
  }
}

TEST(HaloMask, DoesNotDependOnTheOrderOfPoints) {
  const auto core = strip(2000);
  AlignedVector<std::uint64_t> keys, reversed;
  for (const Place& p : core) keys.push_back(keyOf(p));
  reversed.assign(keys.rbegin(), keys.rend());
  const HaloMask mask = maskOf(keys, 0.02), other = maskOf(reversed, 0.02);
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform(-0.25, 0.25);
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t key = keyOf({uniform(random), uniform(random), uniform(random)});
    EXPECT_EQ(mask.holds(key), other.holds(key));
  }
}

}  // namespace

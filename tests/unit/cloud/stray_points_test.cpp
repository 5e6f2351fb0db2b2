// SPDX-License-Identifier: BSD-3-Clause
// Which points a store leaves out as strays depends on where points are, not on their order or
// number.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "pcl_slim/cloud/point_store.h"
#include "support/survey_cloud.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

/** The store of a cloud's points in another order. */
PointStore shuffledStore(const Cloud& cloud, unsigned seed) {
  std::vector<std::size_t> order(cloud.points.size() / 3);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  Cloud shuffled;
  for (const std::size_t i : order) {
    shuffled.add(cloud.points[3 * i], cloud.points[3 * i + 1], cloud.points[3 * i + 2]);
  }
  return storeOf(shuffled);
}

TEST(StrayPoints, ThatManyPointsShareOnePlaceKeepsNoStray) {
  // As of a camera that writes 0 0 0 where it saw nothing: more than half of the points.
  const Cloud near = surveyCloud(9000);
  for (const double place : {0.0, 432500.0}) {
    Cloud cloud = near;
    for (int i = 0; i < 20000; ++i) cloud.add(place, place, 0);
    for (const double distance : {1e10, 1e20, 1e38}) {
      Cloud with_stray = cloud;
      with_stray.add(distance, 0, 0);
      const PointStore store = storeOf(with_stray);
      EXPECT_EQ(store.statistics().far_away, 1u) << distance;
      EXPECT_EQ(store.size(), 9001u);
      EXPECT_EQ(store.scale(), storeOf(cloud).scale());
    }
  }
}

TEST(StrayPoints, OrderAndRepetitionChangeNothing) {
  // At each distance around the limit, 2^14 times that between quartiles, a point is in or out.
  std::uint64_t strays = 0;
  for (int step = -40; step <= 40; ++step) {
    Cloud cloud = surveyCloud(6000);
    cloud.add(432900 + 0x1p14 * 495 * (1.0 + 0.001 * step), 5412645, 335);
    const std::uint64_t expected = storeOf(cloud).statistics().far_away;
    strays += expected;
    for (const unsigned seed : {1u, 2u, 3u}) {
      ASSERT_EQ(shuffledStore(cloud, seed).statistics().far_away, expected) << step;
    }
    for (int i = 0; i < 3000; ++i) cloud.add(432900, 5412645, 335);
    cloud.add(432900, 5412645, 335);
    for (std::size_t i = 0; i < 6000; ++i) {
      if (i % 3 == 0)
        cloud.add(cloud.points[3 * i], cloud.points[3 * i + 1], cloud.points[3 * i + 2]);
    }
    ASSERT_NEAR(static_cast<double>(storeOf(cloud).statistics().far_away),
                static_cast<double>(expected), step * step < 400 ? 1 : 0);
  }
  EXPECT_GT(strays, 0u);
  EXPECT_LT(strays, 81u);
}

TEST(StrayPoints, UnitsAndStraysAreThoseOfALargerCloudWhereItIsNamed) {
  const PointStore frame = storeOf(surveyCloud(500));
  Cloud cloud;
  cloud.add(432500, 5412500, 320);
  const auto near = PointStore::build(cloud.view(), 1, &frame);
  ASSERT_TRUE(near);
  EXPECT_EQ(near->scale(), frame.scale());
  EXPECT_LT(storeOf(cloud).scale(), frame.scale());
  cloud.add(1e12, 0, 0);
  const auto both = PointStore::build(cloud.view(), 1, &frame);
  ASSERT_TRUE(both);
  EXPECT_EQ(both->size(), 1u);
  EXPECT_EQ(both->statistics().far_away, 1u);
  EXPECT_EQ(both->scale(), frame.scale());
  EXPECT_EQ(storeOf(cloud).statistics().far_away, 0u) << "two points tell no stray";
  Cloud far;
  far.add(1e12, 0, 0);
  EXPECT_FALSE(PointStore::build(far.view(), 1, &frame)) << "nothing near";
}

}  // namespace
}  // namespace pcl_slim

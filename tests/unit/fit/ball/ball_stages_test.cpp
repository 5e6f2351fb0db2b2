// SPDX-License-Identifier: BSD-3-Clause
// The stages of one ball, each on its own: gathered, framed, parted from another sheet, moved onto
// its fit.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "ball.h"
#include "fit_plan.h"
#include "support/clouds.h"

namespace pcl_slim {

using namespace detail;

namespace {

using pcl_slim_test::Cloud;
using pcl_slim_test::heightField;
using pcl_slim_test::storeOf;

/** A store with the plan that its fit would have, and a gatherer that reaches all of it. */
struct Bench {
  explicit Bench(const Cloud& cloud, double lambda = 1e-8)
      : store(storeOf(cloud)),
        plan(planFor(store, FitParams().resolved(), FitConstants(), {})),
        gatherer(store, plan),
        search(plan) {
    plan.energy.lambda = plan.noise = lambda;
    const float low[3] = {-2, -2, -2}, high[3] = {2, 2, 2};
    gatherer.nearby().collect(store.tree(), low, high);
  }

  /** The ball of the stored point nearest to the middle, framed and begun on. */
  FramedBall framedBall(double radius) {
    std::size_t nearest = 0;
    double least = 1e9;
    for (std::size_t i = 0; i < store.size(); ++i) {
      const auto p = store.position(i);
      const double d = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
      if (d < least) {
        least = d;
        nearest = i;
      }
    }
    const FramedBall ball = framed(gatherer.gather(siteOf(store, plan, nearest, radius)), plan);
    search.setNoise(ball.site.lambda);
    search.begin(*ball.points, radius, 1.0);
    return ball;
  }

  PointStore store;
  FitPlan plan;
  BallGatherer gatherer;
  RadiusSearch search;
};

TEST(BallStages, AGatheredBallHoldsThePointsWithinItsRadius) {
  Bench bench(heightField(4000, 3, [](double x, double y) { return 0.1 * x * y; }));
  const BallSite site = siteOf(bench.store, bench.plan, 77, 0.1);
  const GatheredBall ball = bench.gatherer.gather(site);
  std::size_t expected = 0;
  for (std::size_t i = 0; i < bench.store.size(); ++i) {
    const auto p = bench.store.position(i);
    double d_sq = 0;
    for (std::size_t a = 0; a < 3; ++a) d_sq += (p[a] - site.center[a]) * (p[a] - site.center[a]);
    expected += d_sq < 0.1 * 0.1;
  }
  ASSERT_GT(expected, 50u);
  EXPECT_NEAR(static_cast<double>(ball.points->count), static_cast<double>(expected), 1.0);
  EXPECT_FALSE(ball.empty());
}

TEST(BallStages, ATiltedPlaneIsFlatInItsFrame) {
  const Cloud plain = heightField(4000, 3, [](double x, double y) { return 0.5 * x - 0.2 * y; });
  const double length = std::sqrt(1 + 0.25 + 0.04);
  Cloud with_normals;
  for (std::size_t i = 0; i < plain.points.size(); i += 3) {
    with_normals.add({plain.points[i], plain.points[i + 1], plain.points[i + 2]},
                     {-0.5 / length, 0.2 / length, 1 / length});
  }
  for (const Cloud& cloud : {plain, with_normals}) {
    Bench bench(cloud);
    const FramedBall ball = bench.framedBall(0.1);
    EXPECT_NEAR(std::abs(ball.normal[2]), 1 / length, 1e-3);
    ASSERT_GT(ball.points->count, 50u);
    for (std::size_t i = 0; i < ball.points->count; ++i) {
      ASSERT_LT(ball.points->s_sq[i], 1.001f);
      ASSERT_NEAR(ball.points->w[i], 0.0f, 2e-3f);
    }
  }
}

TEST(BallStages, ANormalThatNeighboursDoNotShareIsAlone) {
  const Cloud plain = heightField(4000, 3, [](double, double) { return 0.0; });
  Cloud cloud;
  for (std::size_t i = 0; i < plain.points.size(); i += 3) {
    const double side = i == 0 ? -1 : 1;
    cloud.add({plain.points[i], plain.points[i + 1], plain.points[i + 2]}, {0, 0, side});
  }
  Bench bench(cloud);
  std::size_t alone = 0;
  for (std::size_t i = 0; i < bench.store.size(); ++i) {
    const bool turned = bench.store.normal(i)[2] < 0;
    const auto ball = bench.gatherer.gather(siteOf(bench.store, bench.plan, i, 0.1));
    ASSERT_EQ(normalIsAlone(ball, bench.plan), turned) << i;
    alone += turned;
  }
  EXPECT_EQ(alone, 1u);
}

TEST(BallStages, TheOtherOfTwoSheetsIsDropped) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  Cloud cloud = heightField(8000, 12, [&](double, double) { return 0.001 * normal(random); });
  for (std::size_t i = 0; i < cloud.points.size(); i += 6) cloud.points[i + 2] += 0.1;
  Bench bench(cloud);
  const FramedBall both = bench.framedBall(0.1);
  const std::size_t gathered = both.points->count;
  SheetSplitter splitter;
  const FramedBall own = splitter.ownSheet(both, SheetConstants(), bench.search);
  EXPECT_EQ(splitter.numSplit(), 1u);
  EXPECT_NEAR(static_cast<double>(own.points->count) / static_cast<double>(gathered), 0.5, 0.1);
  EXPECT_GT(std::abs(own.normal[2]), 0.99f);
  for (std::size_t i = 0; i < own.points->count; ++i)
    ASSERT_NEAR(own.points->w[i], 0.0f, 0.1f) << "a point of the other sheet";
}

TEST(BallStages, OneSheetIsLeftWhole) {
  Bench bench(heightField(4000, 3, [](double x, double y) { return 0.3 * x * y; }));
  const FramedBall ball = bench.framedBall(0.1);
  const std::size_t gathered = ball.points->count;
  SheetSplitter splitter;
  EXPECT_EQ(splitter.ownSheet(ball, SheetConstants(), bench.search).points->count, gathered);
  EXPECT_EQ(splitter.numSplit(), 0u);
}

TEST(BallStages, AStrayCentreMovesOntoItsFit) {
  Bench bench(heightField(4000, 3, [](double, double) { return 0.0; }));
  BallSite site = bench.framedBall(0.1).site;
  const float plane = site.center[2];
  site.center[2] += 0.01f;  // a tenth of the radius off
  const FramedBall ball = framed(bench.gatherer.gather(site), bench.plan);
  bench.search.setNoise(site.lambda);
  bench.search.begin(*ball.points, site.radius, 1.0);
  const FramedBall moved = recentred(ball, bench.plan, 1, bench.gatherer, bench.search);
  EXPECT_NEAR(moved.site.center[2], plane, 1e-3) << "moved by " << moved.site.center[2] - plane;
  // There it stays.
  const FramedBall again = recentred(moved, bench.plan, 1, bench.gatherer, bench.search);
  EXPECT_EQ(again.site.center, moved.site.center);
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/splat/hole_check.h"

#include "painted_clouds.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

/** A flat square of side 1 with count points. */
PaintedCloud square(int count) {
  PaintedCloud cloud;
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int i = 0; i < count; ++i) cloud.add({u(random), u(random), 0.0}, {0, 0, 1}, {9, 9, 9});
  return cloud;
}

SplatSet oneDisc(double x, double y, double radius) {
  SplatSet s;
  s.resize(1, false);
  s.x[0] = static_cast<float>(x);
  s.y[0] = static_cast<float>(y);
  s.z[0] = 0.0f;
  s.nx[0] = s.ny[0] = 0.0f;
  s.nz[0] = 1.0f;
  s.radius[0] = static_cast<float>(radius);
  return s;
}

TEST(HoleCheck, MeasuresTheAreaOfOneDisc) {
  const PaintedCloud cloud = square(20000);
  const HoleCheck half = holesSeen(cloud, oneDisc(0.5, 0.5, 0.4), 60000);
  EXPECT_NEAR(1.0 - half.holes(), 3.14159265 * 0.16, 0.01);
  EXPECT_NEAR(half.overlap, 3.14159265 * 0.16, 0.01);
  EXPECT_EQ(holesSeen(cloud, oneDisc(0.5, 0.5, 2.0), 20000).missed, 0u);
}

TEST(HoleCheck, SeesHolesBetweenDiscsThatHoldEveryPoint) {
  // Each disc just reaches its cell's own points, so every point is covered; between them is nothing.
  const PaintedCloud cloud = painted(20000);
  SplatParams params;
  SplatSet splats = sampled(cloud, params);
  SplatStatistics statistics;
  sampled(cloud, params, &statistics);
  for (float& r : splats.radius) r = std::max(1e-6f, r - static_cast<float>(statistics.spacing));
  EXPECT_GT(holesSeen(cloud, splats, 20000).holes(), 0.01);
}

TEST(HoleCheck, DiscsFarBelowTheSurfaceDoNotCount) {
  const PaintedCloud cloud = square(5000);
  SplatSet low = oneDisc(0.5, 0.5, 0.1);
  low.z[0] = -5.0f;
  EXPECT_EQ(holesSeen(cloud, low, 5000).overlap, 0.0);
}

TEST(HoleCheck, LeavesOutWhatIsTooSparseToTell) {
  PaintedCloud cloud = square(5000);
  for (int i = 0; i < 200; ++i) cloud.add({5.0 + i, 3.0 * i, 0.0}, {0, 0, 1}, {9, 9, 9});
  const HoleCheck check = holesSeen(cloud, oneDisc(0.5, 0.5, 2.0), 20000);
  EXPECT_NEAR(static_cast<double>(check.sparse), 20000.0 * 200 / 5200, 200.0);
  EXPECT_EQ(check.missed, 0u);
  EXPECT_EQ(check.rays + check.sparse, 20000u);
}

TEST(HoleCheck, LeavesOutWhatIsNoSheet) {
  // Half the points fill a cube densely, where no normal exists; the others are on the square.
  PaintedCloud cloud = square(5000);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> u(0.0, 0.2);
  for (int i = 0; i < 5000; ++i) {
    cloud.add({3.0 + u(random), u(random), u(random)}, {0, 0, 1}, {9, 9, 9});
  }
  const HoleCheck check = holesSeen(cloud, oneDisc(0.5, 0.5, 2.0), 20000);
  EXPECT_NEAR(static_cast<double>(check.rough), 9700.0, 500.0);
  EXPECT_EQ(check.rays + check.sparse + check.rough, 20000u);
  EXPECT_LT(check.holes(), 0.05) << "what is left of the cube";
}

TEST(HoleCheck, IsTheSameForAnyNumberOfThreads) {
  const PaintedCloud cloud = painted(10000);
  SplatParams sampling;
  sampling.threads = 1;
  const SplatSet splats = sampled(cloud, sampling);
  const auto store = PointStore::build(cloud.view(), 1);
  ASSERT_TRUE(store);
  HoleCheckParams params;
  params.rays = 10000;
  params.threads = 1;
  const auto one = checkHoles(*store, splats, params);
  params.threads = 8;
  const auto many = checkHoles(*store, splats, params);
  ASSERT_TRUE(one && many);
  EXPECT_EQ(one->missed, many->missed);
  EXPECT_EQ(one->overlap, many->overlap);
}

TEST(HoleCheck, BadInputIsAnError) {
  const PaintedCloud cloud = square(100);
  const auto store = PointStore::build(cloud.view(), 1);
  ASSERT_TRUE(store);
  EXPECT_FALSE(checkHoles(*store, SplatSet()));
  HoleCheckParams params;
  params.tilt = 90.0;
  EXPECT_FALSE(checkHoles(*store, oneDisc(0, 0, 1), params));
  params.tilt = 60.0;
  params.thickness = -0.1;
  EXPECT_FALSE(checkHoles(*store, oneDisc(0, 0, 1), params));
  params.thickness = 0.4;
  params.tilt = std::nan("");
  EXPECT_FALSE(checkHoles(*store, oneDisc(0, 0, 1), params));
}

}  // namespace
}  // namespace pcl_slim

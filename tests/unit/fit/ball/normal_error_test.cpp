// SPDX-License-Identifier: BSD-3-Clause
// How far normals are off, and whether they say more than the points do.
#include "measures/measures.h"

#include <gtest/gtest.h>

#include "support/clouds.h"
#include "support/plane_normals.h"

namespace pcl_slim {

using namespace detail;

namespace {

using measure::Shape;
using namespace pcl_slim_test;

TEST(NormalError, IsThatOfNormalsMeasuredApart) {
  for (const Shape shape : {Shape::kSphere, Shape::kTorus, Shape::kBumpy}) {
    for (const double noise : {0.0005, 0.002, 0.005}) {
      const double per_axis = 0.08;
      const auto e = measureNormalError(storeOf(sceneCloud(shape, 50000, noise, per_axis)), {}, 1);
      EXPECT_TRUE(e.independent()) << e.with_heights << ' ' << e.with_neighbors;
      // Of two axes; a point that noise moved sideways brings the normal of another place with it.
      EXPECT_GT(e.radians, 0.95 * std::sqrt(2.0) * per_axis);
      EXPECT_LT(e.radians, 1.25 * std::sqrt(2.0) * per_axis);
    }
  }
}

TEST(NormalError, NormalsComputedFromThePointsAreNoNews) {
  for (const Shape shape : {Shape::kSphere, Shape::kBumpy}) {
    const Cloud cloud = sceneCloud(shape, 20000, 0.002);
    for (const std::size_t k : {8, 15, 30, 60, 150}) {
      const auto e = measureNormalError(storeOf(withPlaneNormals(cloud, k)), {}, 1);
      EXPECT_GT(e.radians, 0.0);
      EXPECT_FALSE(e.independent()) << k << ' ' << e.with_heights << ' ' << e.with_neighbors;
    }
  }
}

TEST(NormalError, FewPointsTellNothing) {
  const auto few = measureNormalError(storeOf(sceneCloud(Shape::kSphere, 90, 0.002, 0.05)), {}, 1);
  EXPECT_EQ(few.radians, 0.0);
  EXPECT_FALSE(few.independent());
}

TEST(NormalError, IsTheSameForAnyNumberOfThreads) {
  const PointStore store = storeOf(sceneCloud(Shape::kRelief, 20000, 0.002, 0.05));
  const auto one = measureNormalError(store, {}, 1);
  for (const int threads : {2, 8}) {
    const auto more = measureNormalError(store, {}, threads);
    EXPECT_EQ(more.radians, one.radians);
    EXPECT_EQ(more.with_heights, one.with_heights);
    EXPECT_EQ(more.with_neighbors, one.with_neighbors);
  }
}

}  // namespace
}  // namespace pcl_slim

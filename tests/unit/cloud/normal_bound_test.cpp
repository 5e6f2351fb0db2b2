// SPDX-License-Identifier: BSD-3-Clause
// How far normals may differ before they count as those of different sheets.
#include "pcl_slim/cloud/detail/noise.h"

#include <gtest/gtest.h>

#include "support/clouds.h"

namespace pcl_slim {

using namespace detail;

namespace {

using measure::Shape;
using namespace pcl_slim_test;

TEST(NormalGate, KeepsFacesAtRightAnglesTogether) {
  Cloud cloud;
  for (int face = 0; face < 3; ++face) {
    for (int i = 0; i < 4900; ++i) {
      double p[3] = {0, 0, 0};
      p[(face + 1) % 3] = 0.01 + i % 70 * 0.01;
      p[(face + 2) % 3] = 0.01 + i / 70 * 0.01;
      cloud.add(p[0], p[1], p[2]);
      for (int a = 0; a < 3; ++a) cloud.normals.push_back(a == face ? 1.0f : 0.0f);
    }
  }
  EXPECT_NEAR(normalBound(storeOf(cloud)), -0.25f, 1e-3f);
}

TEST(NormalGate, WidensWithTheErrorsOfNormals) {
  const auto bound = [](double error) {
    return normalBound(storeOf(sceneCloud(Shape::kSphere, 50000, 0.0, error)));
  };
  const float exact = bound(0.0), good = bound(0.1), bad = bound(0.3);
  EXPECT_FLOAT_EQ(exact, -0.25f);
  EXPECT_LT(good, exact);
  EXPECT_GT(good, -0.4f);
  EXPECT_LT(bad, -0.5f);
  EXPECT_GE(bad, -0.6001f);
}

TEST(NormalGate, PointsWithBadNormalsAreProjectedToo) {
  for (const Shape shape : {Shape::kSphere, Shape::kTorus}) {
    const auto f = fitted(sceneCloud(shape, 50000, 0.001, 0.3), FitParams(), true);
    EXPECT_EQ(f.projection.num_unsupported, 0u);
  }
}

TEST(NormalGate, IsNotFooledByTwoSheets) {
  Cloud cloud = sceneCloud(Shape::kRelief, 20000, 0.0);
  const std::size_t count = cloud.size();
  for (std::size_t i = 0; i < count; ++i) {
    cloud.points.insert(cloud.points.end(), {cloud.points[3 * i], cloud.points[3 * i + 1],
                                             cloud.points[3 * i + 2] - 0.001});
    for (std::size_t a = 0; a < 3; ++a) cloud.normals.push_back(-cloud.normals[3 * i + a]);
  }
  EXPECT_GT(normalBound(storeOf(cloud)), -0.3f);
}

}  // namespace
}  // namespace pcl_slim

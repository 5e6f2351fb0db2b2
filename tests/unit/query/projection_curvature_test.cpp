// SPDX-License-Identifier: BSD-3-Clause
// Mean and Gaussian curvature of projected points: values, units and signs.
#include <gtest/gtest.h>

#include <cmath>

#include "support/clouds.h"

namespace pcl_slim {
namespace {

using measure::Shape;
using namespace pcl_slim_test;

/** A sphere's points and normals, turned by sign, with another radius and place. */
Cloud sphere(double radius, double sign) {
  Cloud cloud = sceneCloud(Shape::kSphere, 4000, 0.0);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    cloud.points[i] = 1000.0 + radius * cloud.points[i];
    cloud.normals[i] *= static_cast<float>(sign);
  }
  return cloud;
}

TEST(Curvature, OfASphereIsOneOverItsRadius) {
  for (const double radius : {0.02, 1.0, 37.0}) {
    for (const double sign : {1.0, -1.0}) {
      const auto f = fitted(sphere(radius, sign), {}, true);
      const double scale = f.store.scale();
      for (std::size_t i = 0; i < f.store.size(); ++i) {
        ASSERT_NEAR(f.projection.curvature[i][0] / scale * radius, sign, 2e-3);
        ASSERT_NEAR(f.projection.curvature[i][1] / (scale * scale) * radius * radius, 1.0, 4e-3);
      }
    }
  }
}

TEST(Curvature, OfATorusHasBothSigns) {
  const double major = 1.0, minor = 0.4;
  const auto f = fitted(sceneCloud(Shape::kTorus, 20000, 0.0), {}, true);
  const double scale = f.store.scale();
  double mean_off = 0, gauss_off = 0;
  for (std::size_t i = 0; i < f.store.size(); ++i) {
    const auto p = f.world(f.projection.position[i]);
    const double rho = std::hypot(p[0], p[1]);
    const double along = (rho - major) / minor / rho;  // cos b / (R + r cos b)
    mean_off += std::pow(f.projection.curvature[i][0] / scale - 0.5 * (1.0 / minor + along), 2);
    gauss_off += std::pow(f.projection.curvature[i][1] / (scale * scale) - along / minor, 2);
  }
  const double n = static_cast<double>(f.store.size());
  EXPECT_LT(std::sqrt(mean_off / n), 0.005);
  EXPECT_LT(std::sqrt(gauss_off / n), 0.015);
}

TEST(Curvature, OfASaddleAndACylinder) {
  // z = x y / 2 bends both ways; z = sqrt(4 - x^2) bends away from its upper side, one way only.
  const auto saddle =
      fitted(pcl_slim_test::heightField(8000, 95, [](double x, double y) { return 0.5 * x * y; }),
             {}, true);
  const auto cylinder = fitted(
      pcl_slim_test::heightField(8000, 96, [](double x, double) { return std::sqrt(4.0 - x * x); }),
      {}, true);
  for (std::size_t i = 0; i < saddle.store.size(); ++i) {
    const auto p = saddle.world(saddle.projection.position[i]);
    const double slope_sq = 0.25 * (p[0] * p[0] + p[1] * p[1]);
    const double expected = -0.25 / std::pow(1.0 + slope_sq, 2);
    ASSERT_NEAR(saddle.projection.curvature[i][1] / std::pow(saddle.store.scale(), 2), expected,
                0.01);
  }
  for (std::size_t i = 0; i < cylinder.store.size(); ++i) {
    const double up = cylinder.projection.normal[i][2] > 0 ? 1.0 : -1.0;
    const double scale = cylinder.store.scale();
    ASSERT_NEAR(up * cylinder.projection.curvature[i][0] / scale, 0.25, 0.01);
    ASSERT_NEAR(cylinder.projection.curvature[i][1] / (scale * scale), 0.0, 0.02);
  }
}

TEST(Curvature, IsLeftOutUnlessAskedFor) {
  EXPECT_TRUE(fitted(sceneCloud(Shape::kSphere, 500, 0.0)).projection.curvature.empty());
}

}  // namespace
}  // namespace pcl_slim

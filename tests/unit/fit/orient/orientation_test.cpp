// SPDX-License-Identifier: BSD-3-Clause
// Signs of surfels fitted without normals.
#include <gtest/gtest.h>

#include <cmath>

#include "support/clouds.h"

namespace pcl_slim {
namespace {

using measure::Shape;
using namespace pcl_slim_test;

std::array<double, 3> centerOf(const Fitted& f, std::size_t i) {
  return f.world({f.surface.cx[i], f.surface.cy[i], f.surface.cz[i]});
}

/** Leaves, and internal surfels up to a radius, whose normal points against outward(place). */
template <typename Outward>
std::size_t numInward(const Fitted& f, double internal_radius, const Outward& outward) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < f.surface.size(); ++i) {
    const double radius = f.surface.radius[i] * f.surface.info.scale;
    if (!f.surface.isLeaf(i) && radius > internal_radius) continue;
    const auto n = outward(centerOf(f, i));
    count += n[0] * f.surface.nx[i] + n[1] * f.surface.ny[i] + n[2] * f.surface.nz[i] < 0;
  }
  return count;
}

TEST(Orientation, PointsOutOfClosedSurfaces) {
  for (const Shape shape : {Shape::kSphere, Shape::kTorus, Shape::kBumpy}) {
    for (const double noise : {0.0, 0.002}) {
      const auto f = fitted(sceneCloud(shape, 8000, noise).withoutNormals());
      expectSound(f);
      const auto outward = [&](const auto& p) { return measure::truthAt(shape, p).normal; };
      // A ball wider than the torus' tube, of radius .4, contains both of its sides.
      EXPECT_EQ(numInward(f, 0.4, outward), 0u) << static_cast<int>(shape) << " noise " << noise;
    }
  }
}

TEST(Orientation, PointsOutOfEachOfTwoSpheres) {
  Cloud cloud = sceneCloud(Shape::kSphere, 6000, 0.0005).withoutNormals();
  const std::size_t half = cloud.points.size();
  for (std::size_t i = 0; i < half; ++i) {
    cloud.points.push_back(0.6 * cloud.points[i] + (i % 3 == 0 ? 2.5 : 0.0));
  }
  const auto f = fitted(cloud);
  const auto outward = [](const std::array<double, 3>& p) {
    return std::array<double, 3>{p[0] > 1.4 ? p[0] - 2.5 : p[0], p[1], p[2]};
  };
  EXPECT_EQ(numInward(f, 0.0, outward), 0u);
}

TEST(Orientation, OfAFlatPieceIsOneSideThroughout) {
  const auto f = fitted(pcl_slim_test::heightField(
      6000, 101, [](double x, double y) { return 0.1 * std::sin(3 * x) * std::cos(2 * y); }));
  const auto up = [](const auto&) { return std::array<double, 3>{0, 0, 1}; };
  const std::size_t down = numInward(f, 0.0, up);
  EXPECT_TRUE(down == 0 || down == f.surface.numLeaves())
      << down << " of " << f.surface.numLeaves();
}

TEST(Orientation, LooksTowardsAViewpoint) {
  FitParams params;
  params.viewpoint = {{5, 0, -20}};
  Cloud cloud = sceneCloud(Shape::kRelief, 6000, 0.0).withoutNormals();
  for (std::size_t i = 0; i < cloud.points.size(); i += 3) cloud.points[i] += 5.0;
  const auto f = fitted(cloud, params);
  const auto down = [](const auto&) { return std::array<double, 3>{0, 0, -1}; };
  EXPECT_EQ(numInward(f, 0.0, down), 0u);
  params.viewpoint = {{5, 0, 20}};
  const auto turned = fitted(cloud, params);
  EXPECT_EQ(numInward(turned, 0.0, down), turned.surface.numLeaves());
}

TEST(Orientation, ChangesSignsOnly) {
  const Cloud cloud = sceneCloud(Shape::kTorus, 8000, 0.001).withoutNormals();
  FitParams params;
  params.orient = false;
  const auto as_is = fitted(cloud, params), oriented = fitted(cloud);
  ASSERT_EQ(as_is.surface.size(), oriented.surface.size());
  std::size_t turned = 0;
  for (std::size_t i = 0; i < as_is.surface.size(); ++i) {
    ASSERT_EQ(as_is.surface.cx[i], oriented.surface.cx[i]);
    ASSERT_EQ(std::abs(as_is.surface.nz[i]), std::abs(oriented.surface.nz[i]));
    turned += as_is.surface.nz[i] != oriented.surface.nz[i];
  }
  EXPECT_GT(turned, 0u);
  for (std::size_t i = 0; i < as_is.store.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      ASSERT_NEAR(as_is.projection.position[i][a], oriented.projection.position[i][a], 1e-7);
    }
  }
}

TEST(Orientation, KeepsTheSideOfGivenNormals) {
  Cloud cloud = sceneCloud(Shape::kSphere, 5000, 0.0005);
  for (float& value : cloud.normals) value = -value;
  const auto f = fitted(cloud);
  EXPECT_TRUE(f.surface.info.oriented);
  const auto inward = [](const auto& p) { return std::array<double, 3>{-p[0], -p[1], -p[2]}; };
  EXPECT_EQ(numInward(f, 0.4, inward), 0u);
  for (std::size_t i = 0; i < f.store.size(); ++i) {
    const auto p = f.world(f.projection.position[i]);
    const auto& n = f.projection.normal[i];
    ASSERT_LT(p[0] * n[0] + p[1] * n[1] + p[2] * n[2], 0.0);
  }
}

}  // namespace
}  // namespace pcl_slim

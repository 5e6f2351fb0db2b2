// SPDX-License-Identifier: BSD-3-Clause
// A cloud projected in its own order and units.
#include "pcl_slim/query/cloud_projection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "support/clouds.h"

namespace pcl_slim {
namespace {

constexpr double kSphereRadius = 40, kGolden = 0.6180339887498949;
constexpr std::size_t kPoints = 4000;
const Vector3 kMiddle = {5000, -300, 20};

/** A sphere without noise far from the origin; the point in front of it has no coordinates, that
 * behind it is far from all others. */
pcl_slim_test::Cloud sphereBetweenStrangers() {
  pcl_slim_test::Cloud cloud;
  cloud.add(0, std::numeric_limits<double>::quiet_NaN(), 0);
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / kPoints;
    const double turn = 2 * M_PI * std::fmod(static_cast<double>(i) * kGolden, 1.0);
    const double level = std::sqrt(1 - z * z);
    const Vector3 direction = {level * std::cos(turn), level * std::sin(turn), z};
    const Vector3 p = along(kMiddle, kSphereRadius, direction);
    cloud.add(p[0], p[1], p[2]);
  }
  cloud.add(kMiddle[0] + 1e5 * kSphereRadius, 0, 0);
  return cloud;
}

SLIMSurface surfaceOf(const CloudView& cloud) {
  SLIMSurface surface;
  const auto store = PointStore::build(cloud, 1);
  EXPECT_TRUE(store);
  if (store) {
    const Error error = fitSurface(*store, {}, surface);
    EXPECT_FALSE(error) << error.message;
  }
  return surface;
}

TEST(CloudProjection, KeepsTheOrderAndTheUnitsOfTheCloud) {
  const pcl_slim_test::Cloud cloud = sphereBetweenStrangers();
  const SLIMSurface surface = surfaceOf(cloud.view());
  CloudProjectionParams params;
  params.projection.curvature = true;
  const auto projected = CloudProjection::make(cloud.view(), surface, params);
  ASSERT_TRUE(projected) << projected.error().message;
  ASSERT_EQ(projected->size(), kPoints + 2);
  EXPECT_FALSE(projected->isFinite(0));
  EXPECT_EQ(projected->unsupported(), std::vector<std::int32_t>{kPoints + 1});
  EXPECT_EQ(projected->statistics().non_finite, 1u);
  EXPECT_EQ(projected->statistics().moved, kPoints);
  for (std::size_t i = 1; i <= kPoints; ++i) {
    ASSERT_TRUE(projected->isSupported(i)) << i;
    const ProjectedPoint point = projected->point(i);
    const Vector3 ray = subtract(point.position, kMiddle);
    EXPECT_NEAR(length(ray), kSphereRadius, 1e-4 * kSphereRadius) << i;
    // The spacing is sqrt(4 pi / 4000) of the radius: no other point is as near.
    const Vector3 given = {cloud.points[3 * i], cloud.points[3 * i + 1], cloud.points[3 * i + 2]};
    EXPECT_LT(length(subtract(point.position, given)), 1e-3 * kSphereRadius) << i;
    EXPECT_NEAR(point.mean_curvature, 1 / kSphereRadius, 1e-2 / kSphereRadius) << i;
  }
}

TEST(CloudProjection, NormalsAreTheSameWithoutSurfaceVariation) {
  pcl_slim_test::Cloud cloud = sphereBetweenStrangers();
  const SLIMSurface surface = surfaceOf(cloud.view());
  // Points of a line beside the sphere: no surfel supports them, planes give them normals.
  for (int i = 0; i < 40; ++i) cloud.add(kMiddle[0] + 60 + i, kMiddle[1], kMiddle[2]);
  CloudProjectionParams params;
  params.projection.planes = true;
  const auto all = CloudProjection::make(cloud.view(), surface, params);
  params.projection.variation = false;
  const auto few = CloudProjection::make(cloud.view(), surface, params);
  ASSERT_TRUE(all && few);
  ASSERT_GE(few->unsupported().size(), 30u);
  for (std::size_t i = 1; i < few->size(); ++i) {
    if (i == kPoints + 1) continue;  // too far from all others for a plane
    const ProjectedPoint point = few->point(i), other = all->point(i);
    EXPECT_EQ(point.position, other.position) << i;
    for (std::size_t a = 0; a < 3; ++a) EXPECT_FLOAT_EQ(point.normal[a], other.normal[a]) << i;
    EXPECT_GE(other.surface_variation, 0) << i;
  }
}

TEST(CloudProjection, MeasuresFromTheCloudsPlacesWhereAFitMovedTheStores) {
  const pcl_slim_test::Cloud cloud = sphereBetweenStrangers();
  const SLIMSurface surface = surfaceOf(cloud.view());
  auto store = PointStore::build(cloud.view(), 1);
  ASSERT_TRUE(store);
  std::vector<Vector3> moved;
  for (std::size_t i = 0; i < store->size(); ++i) {
    const Vector3 p = along(store->origin(), store->scale(), store->position(i));
    const Vector3 out = along(kMiddle, 1.005, subtract(p, kMiddle));
    moved.push_back(scaled(subtract(out, store->origin()), 1 / store->scale()));
  }
  store->moveTo(moved, 1);
  CloudProjectionParams params;
  params.projection.reach = 0.5;
  const auto projected = CloudProjection::make(cloud.view(), surface, params, nullptr, &*store);
  ASSERT_TRUE(projected) << projected.error().message;
  EXPECT_EQ(projected->statistics().moved, kPoints);
  EXPECT_LT(projected->statistics().max_displacement, 1e-3 * kSphereRadius);
}

TEST(CloudProjection, RefusesASurfaceOfAnotherCloud) {
  const pcl_slim_test::Cloud cloud = sphereBetweenStrangers();
  const SLIMSurface surface = surfaceOf(cloud.view());
  pcl_slim_test::Cloud elsewhere;
  for (std::size_t i = 0; i < kPoints; ++i)
    elsewhere.add(static_cast<double>(i % 60), static_cast<double>(i / 60), 0);
  CloudProjectionParams params;
  params.least_support = kLeastSharedSupport;
  const auto projected = CloudProjection::make(elsewhere.view(), surface, params);
  ASSERT_FALSE(projected);
  EXPECT_EQ(projected.error().code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace pcl_slim

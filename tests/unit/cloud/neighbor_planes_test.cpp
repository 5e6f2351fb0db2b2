// SPDX-License-Identifier: BSD-3-Clause
// Planes through neighbours, against surfaces whose variation is known.
#include "pcl_slim/cloud/neighbor_planes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim {
namespace {

CloudView placesOf(const std::vector<Vector3>& points) {
  CloudView view;
  view.xyz = points.data();
  view.xyz_stride = sizeof(Vector3);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = points.size();
  return view;
}

std::vector<Vector3> randomSphere(std::size_t count) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Vector3> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back(normalized({normal(random), normal(random), normal(random)}));
  return points;
}

TEST(NeighborPlanes, VariationOfASphereFollowsItsCurvature) {
  for (const std::size_t count : {5000u, 100000u}) {
    const auto points = randomSphere(count);
    double mean = 0;
    for (const float value : surfaceVariation(placesOf(points), 1)) mean += value;
    mean /= static_cast<double>(count);
    // A disc of radius r has (r k)^2 / 24, and 30 points where r^2 = 4 * 30 / count.
    const double expected = 4.0 * kVariationNeighbors / static_cast<double>(count) / 24;
    EXPECT_NEAR(mean, expected, 0.05 * expected) << count;
  }
}

TEST(NeighborPlanes, VariationGrowsWithNoiseTillItIsIsotropic) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> share;
  std::normal_distribution<double> normal;
  std::vector<Vector3> ball, plane;
  for (int i = 0; i < 20000; ++i) {
    ball.push_back({normal(random), normal(random), normal(random)});
    plane.push_back({share(random), share(random), 0.001 * normal(random)});
  }
  double of_ball = 0, of_plane = 0;
  for (const float value : surfaceVariation(placesOf(ball), 1)) of_ball += value / 20000;
  for (const float value : surfaceVariation(placesOf(plane), 1)) of_plane += value / 20000;
  EXPECT_GT(of_ball, 0.2);
  EXPECT_LT(of_ball, 1.0 / 3.0);
  // sigma^2 (1 - 1/30 - 2/30) over the disc's r^2 / 2, pi r^2 = 30 / 20000.
  EXPECT_NEAR(of_plane, 0.9 * 1e-6 / (15.0 / 20000 / M_PI), 5e-4);
}

TEST(NeighborPlanes, AreTheSameForAnyNumberOfThreadsAndInAnyUnit) {
  auto points = randomSphere(5000);
  const auto one = surfaceVariation(placesOf(points), 1);
  EXPECT_EQ(one, surfaceVariation(placesOf(points), 4));
  for (Vector3& p : points) p = {1024 * p[0], 1024 * p[1], 1024 * p[2]};
  EXPECT_EQ(one, surfaceVariation(placesOf(points), 1));
}

TEST(NeighborPlanes, FewAndBadPointsHaveNone) {
  EXPECT_TRUE(surfaceVariation(placesOf({}), 1).empty());
  for (const float value : surfaceVariation(placesOf({{0, 0, 0}, {1, 0, 0}}), 1))
    EXPECT_TRUE(std::isnan(value));
  const auto three = surfaceVariation(placesOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), 1);
  for (const float value : three) EXPECT_NEAR(value, 0, 1e-6);
  auto points = randomSphere(100);
  points[3][1] = std::numeric_limits<double>::quiet_NaN();
  points[4] = points[5];
  const auto values = surfaceVariation(placesOf(points), 1);
  EXPECT_TRUE(std::isnan(values[3]));
  EXPECT_EQ(values[4], values[5]);
}

}  // namespace
}  // namespace pcl_slim

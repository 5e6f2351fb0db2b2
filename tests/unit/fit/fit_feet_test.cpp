// SPDX-License-Identifier: BSD-3-Clause
// Sides of points that are moved to local planes first: docs/sides.md, "Sides before the cover".
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "fit_constants.h"
#include "pcl_slim/core/vector3.h"
#include "support/clouds.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

/** Two spheres about one middle, a gap apart, spacing 1, with white noise. */
Cloud nestedSpheres(double radius, double gap, double noise, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> gauss(0, 1), error(0, noise);
  Cloud cloud;
  for (const double r : {radius, radius + gap}) {
    const int points = static_cast<int>(4 * M_PI * r * r);
    for (int i = 0; i < points; ++i) {
      const Vector3 p = scaled(normalized({gauss(rng), gauss(rng), gauss(rng)}), r);
      cloud.addNoisy(p, error, rng);
    }
  }
  return cloud;
}

/** Three rods side by side, one point for each squared unit, with white noise. */
struct Rods {
  double radius = 4, noise = 2, length = 60, apart = 30;

  Cloud cloud(unsigned seed) const {
    std::mt19937_64 rng(seed);
    std::normal_distribution<double> gauss(0, noise);
    std::uniform_real_distribution<double> along(0, length), around(0, 2 * M_PI);
    Cloud cloud;
    for (int i = 0; i < 3 * static_cast<int>(2 * M_PI * radius * length); ++i) {
      const double x = along(rng), angle = around(rng);
      const double y = radius * std::cos(angle) + apart * (i % 3), z = radius * std::sin(angle);
      cloud.addNoisy({x, y, z}, gauss, rng);
    }
    return cloud;
  }

  double rms(const Fitted& f) const {
    double sum = 0;
    for (const auto& local : f.projection.position) {
      const Vector3 p = f.world(local);
      const double rod = std::clamp(std::round(p[1] / apart), 0.0, 2.0);
      sum += std::pow(std::hypot(p[1] - apart * rod, p[2]) - radius, 2);
    }
    return std::sqrt(sum / static_cast<double>(f.store.size()));
  }
};

// Four deviations of the noise thick, which is two spacings: many cells contain both sides.
TEST(FitSides, SidesOfFeetAreFoundWherePointsLeaveDoubts) {
  const Rods rods;
  detail::FitConstants constants;
  constants.side_search.least_plane_neighbors = 1000;
  double with = 0, without = 0;
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Cloud cloud = rods.cloud(seed);
    const Fitted feet = fitted(cloud);
    EXPECT_GE(feet.statistics.sides.plane_neighbors, 16u);
    EXPECT_GT(feet.store.drift(), 0);
    with += rods.rms(feet);

    Fitted points;
    points.store = storeOf(cloud);
    ASSERT_FALSE(detail::fitWithConstants(constants, points.store, {}, points.surface,
                                          &points.statistics, nullptr, &points.store));
    ASSERT_FALSE(projectPoints(points.store, points.surface, {}, points.projection));
    EXPECT_EQ(points.statistics.sides.plane_neighbors, 0u);
    EXPECT_EQ(points.store.drift(), 0);
    without += rods.rms(points);
  }
  EXPECT_LT(with, 0.85 * without) << with << " " << without;
}

// Two spheres about one middle.
TEST(FitSides, TheNoiseOfTheReportIsThatOfThePointsNotOfTheirFeet) {
  const double noise = 1.5;
  const Fitted f = fitted(nestedSpheres(30, 6, noise, 1));
  EXPECT_GE(f.statistics.sides.plane_neighbors, 16u);
  const double diagonal = f.store.diagonal() * f.store.scale();
  EXPECT_NEAR(std::sqrt(f.statistics.lambda) * diagonal, noise, 0.1 * noise);
}

TEST(FitSides, WhereFeetGetNoSidesNarrowerCellsAreTried) {
  // A sphere in another, 3 to 12 spacings from it. Cells far wider than both: the feet get no
  // sides.
  detail::FitConstants no_sides, no_feet;
  no_sides.side_search.least_moved_noise = 1000;
  no_feet.side_search.least_plane_neighbors = 1000;
  const double radius = 30, inner = 22.5, gap = 3, noise = 1.5;
  std::mt19937_64 rng(1);
  std::normal_distribution<double> gauss(0, 1), error(0, noise);
  Cloud cloud;
  for (const double r : {radius, inner}) {
    const double shift = r < radius ? radius - inner - gap : 0;
    const int points = static_cast<int>(4 * M_PI * r * r);
    for (int i = 0; i < points; ++i) {
      Vector3 p = scaled(normalized({gauss(rng), gauss(rng), gauss(rng)}), r);
      p[0] += shift;
      cloud.addNoisy(p, error, rng);
    }
  }
  PointStore store = storeOf(cloud), other = store;
  SLIMSurface surface, expected;
  FitStatistics statistics, expected_statistics;
  ASSERT_FALSE(
      detail::fitWithConstants(no_sides, store, {}, surface, &statistics, nullptr, &store));
  ASSERT_FALSE(detail::fitWithConstants(no_feet, other, {}, expected, &expected_statistics, nullptr,
                                        &other));
  EXPECT_GT(statistics.sides.points, 0u);
  EXPECT_EQ(statistics.sides.plane_neighbors, 0u);
  EXPECT_EQ(statistics.sides.confidence, expected_statistics.sides.confidence);
  EXPECT_EQ(surface.cx, expected.cx);
}

TEST(FitSides, SurfacesOfFeetAreTheSameForAnyNumberOfThreads) {
  const Cloud cloud = nestedSpheres(30, 6, 1.5, 4);
  FitParams params;
  params.threads = 1;
  SLIMSurface one, three;
  FitStatistics statistics;
  PointStore store = storeOf(cloud), other = storeOf(cloud);
  ASSERT_FALSE(fitSurface(store, params, one, &statistics));
  ASSERT_GT(statistics.sides.plane_neighbors, 0u);
  params.threads = 3;
  ASSERT_FALSE(fitSurface(other, params, three));
  EXPECT_EQ(one.cx, three.cx);
  EXPECT_EQ(one.radius, three.radius);
  EXPECT_EQ(one.coefficients, three.coefficients);
  for (std::size_t i = 0; i < store.size(); ++i) ASSERT_EQ(store.position(i), other.position(i));
}

// Outliers stay where they are; the others are moved in the store of all.
TEST(FitSides, FeetAreThoseOfThePointsThatAreNoOutliers) {
  Cloud cloud = nestedSpheres(30, 6, 1.5, 4);
  const std::array<double, 3> stray = {60, 300, -100};
  cloud.add(stray[0], stray[1], stray[2]);
  const PointStore before = storeOf(cloud);
  const Fitted f = fitted(cloud);
  ASSERT_GT(f.statistics.sides.plane_neighbors, 0u);
  ASSERT_GT(f.statistics.outliers, 0u);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    moved += before.position(i) != f.store.position(i);
  EXPECT_GT(moved, before.size() * 99 / 100);
  for (const std::uint32_t i : f.statistics.outlier_points) {
    for (std::size_t a = 0; a < 3; ++a)
      EXPECT_NEAR(before.position(i)[a], f.store.position(i)[a], 1e-6);
  }
}

}  // namespace

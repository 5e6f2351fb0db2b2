// SPDX-License-Identifier: BSD-3-Clause
// A surface among scattered points: noise as without them, no surface where they are.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/clouds.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using measure::Shape;

constexpr double kTorusNoise = 0.002;  ///< [L]

/** A torus, and points spread evenly over the box about it. */
Cloud torusAmongOutliers(double share) {
  Cloud cloud = sceneCloud(Shape::kTorus, 30000, kTorusNoise).withoutNormals();
  double low[3] = {1e9, 1e9, 1e9}, high[3] = {-1e9, -1e9, -1e9};
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], cloud.points[3 * i + a]);
      high[a] = std::max(high[a], cloud.points[3 * i + a]);
    }
  }
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  const auto count = static_cast<std::size_t>(share / (1 - share) * 30000);
  for (std::size_t i = 0; i < count; ++i) {
    cloud.add(low[0] + (high[0] - low[0]) * u(random), low[1] + (high[1] - low[1]) * u(random),
              low[2] + (high[2] - low[2]) * u(random));
  }
  return cloud;
}

TEST(FitOutliers, NoiseIsThatOfTheSurface) {
  const double clean = std::sqrt(fitted(torusAmongOutliers(0)).statistics.lambda);
  for (const double share : {0.01, 0.05, 0.1}) {
    const Fitted f = fitted(torusAmongOutliers(share));
    EXPECT_NEAR(std::sqrt(f.statistics.lambda) / clean, 1.0, 0.2) << share;
    EXPECT_GT(static_cast<double>(f.statistics.outliers), 0.7 * share * 30000) << share;
  }
}

/** A unit sphere with thin noise, and points spread over a box of 3 about it: many are so near to it
 * that it has eight points within the spacing. */
TEST(FitOutliers, NoiseIsThatOfTheSurfaceAmongMany) {
  constexpr double kThin = 0.001;
  for (const double share : {0.1, 0.2}) {
    std::mt19937_64 random(4);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> inside(-1.5, 1.5);
    Cloud cloud;
    for (int i = 0; i < 10000; ++i) {
      std::array<double, 3> p;
      const bool scattered = i < 10000 * share;
      for (double& x : p) x = scattered ? inside(random) : normal(random);
      const double length = std::hypot(p[0], p[1], p[2]);
      for (double& x : p) x = scattered ? x : x / length + kThin * normal(random);
      cloud.add(p[0], p[1], p[2]);
    }
    const Fitted f = fitted(cloud);
    const double sigma = std::sqrt(f.statistics.lambda) * f.store.diagonal() * f.store.scale();
    EXPECT_NEAR(sigma / kThin, 1.0, 0.2) << share;
  }
}

TEST(FitOutliers, CarryNoSurfaceUnlessAsked) {
  const Cloud cloud = torusAmongOutliers(0.05);
  const Fitted without = fitted(cloud);
  std::size_t supported = 0;
  for (const std::uint32_t i : without.statistics.outlier_points)
    supported += without.projection.supported[i];
  EXPECT_LT(static_cast<double>(supported), 0.1 * static_cast<double>(without.statistics.outliers));

  FitParams keep;
  keep.keep_outliers = true;
  const Fitted with = fitted(cloud, keep);
  EXPECT_TRUE(with.statistics.outlier_points.empty());
  EXPECT_GT(with.statistics.leaves, 3 * without.statistics.leaves);
}

TEST(FitOutliers, PaperModeKeepsThem) {
  FitParams paper;
  paper.paper_mode = true;
  paper.degree = 2;
  paper.size = MDLThreshold{0.1};
  EXPECT_TRUE(fitted(torusAmongOutliers(0.05), paper).statistics.outlier_points.empty());
}

}  // namespace
}  // namespace pcl_slim

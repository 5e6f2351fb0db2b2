// SPDX-License-Identifier: BSD-3-Clause
// Normals of clouds that come without, against those of the surface they were taken from.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "disc/splat_builder.h"
#include "painted_clouds.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

constexpr int kNeighbors = 16;

/** Adds random points of a unit sphere around x, off by noise along their true normals. */
void addSphere(PaintedCloud& cloud, double x, int count, double noise) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> gauss;
  for (int k = 0; k < count; ++k) {
    Vector3 n{gauss(random), gauss(random), gauss(random)};
    n = normalized(n);
    const double r = 1.0 + noise * gauss(random);
    cloud.add({x + r * n[0], r * n[1], r * n[2]}, n, {0, 0, 0});
  }
}

std::vector<float> estimated(const PaintedCloud& cloud, int threads = 1) {
  CloudView view = cloud.view();
  view.normal = nullptr;
  const Result<PointStore> store = PointStore::build(view, threads);
  EXPECT_TRUE(store);
  return detail::estimateNormals(*store, view, kNeighbors, {}, threads);
}

/** RMS angle between the estimated lines and the true ones, in radians. */
double errorOf(const PaintedCloud& cloud, const std::vector<float>& normals) {
  double sum = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3 n{normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]};
    EXPECT_NEAR(length(n), 1.0, 1e-4) << i;
    const Vector3 truth{cloud.normals[3 * i], cloud.normals[3 * i + 1], cloud.normals[3 * i + 2]};
    const double sine = length(cross(n, truth));
    sum += sine * sine;
  }
  return std::sqrt(sum / static_cast<double>(cloud.size()));
}

TEST(NormalEstimation, IsAsCloseAsTheNeighboursAllow) {
  PaintedCloud clean, noisy;
  addSphere(clean, 0.0, 20000, 0.0);
  addSphere(noisy, 0.0, 20000, 0.005);
  // Of exactly the 16 nearest: .0075, .074, and .026 below.
  EXPECT_LT(errorOf(clean, estimated(clean)), 0.009);
  EXPECT_LT(errorOf(noisy, estimated(noisy)), 0.09);
}

TEST(NormalEstimation, IsAsCloseWhereDensityChangesAndAtGaps) {
  PaintedCloud cloud;
  addSphere(cloud, 0.0, 30000, 0.0);
  addSphere(cloud, 2.1, 600, 0.0);
  addSphere(cloud, -50.0, 3000, 0.0);
  EXPECT_LT(errorOf(cloud, estimated(cloud)), 0.03);
}

TEST(NormalEstimation, FindsTheNormalsOfFewPointsAndOfLines) {
  PaintedCloud few, line;
  addSphere(few, 0.0, 5, 0.0);
  for (int i = 0; i < 40; ++i) line.add({0.1 * i, 0.0, 0.0}, {0, 0, 1}, {0, 0, 0});
  for (const PaintedCloud* cloud : {&few, &line}) {
    const std::vector<float> normals = estimated(*cloud);
    for (std::size_t i = 0; i < cloud->size(); ++i) {
      EXPECT_NEAR(std::hypot(normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]), 1.0, 1e-4);
      if (cloud == &line) {
        EXPECT_NEAR(normals[3 * i], 0.0, 1e-4);
      }
    }
  }
}

TEST(NormalEstimation, ThreadsChangeNothing) {
  PaintedCloud cloud;
  addSphere(cloud, 0.0, 20000, 0.003);
  EXPECT_EQ(estimated(cloud, 1), estimated(cloud, 3));
}

}  // namespace
}  // namespace pcl_slim

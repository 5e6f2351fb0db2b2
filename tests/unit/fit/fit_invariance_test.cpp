// SPDX-License-Identifier: BSD-3-Clause
// Changes of the input that must not change the fit, or only its units.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <thread>

#include "pcl_slim/surface/surface_io.h"
#include "support/clouds.h"

namespace pcl_slim {
namespace {

using measure::Shape;
using namespace pcl_slim_test;

/** The points of a cloud in another order, each as often as order names it. */
Cloud reordered(const Cloud& cloud, const std::vector<std::size_t>& order) {
  Cloud result;
  for (const std::size_t i : order) {
    const auto at = static_cast<std::ptrdiff_t>(3 * i);
    result.points.insert(result.points.end(), cloud.points.begin() + at,
                         cloud.points.begin() + at + 3);
    if (cloud.normals.empty()) continue;
    result.normals.insert(result.normals.end(), cloud.normals.begin() + at,
                          cloud.normals.begin() + at + 3);
  }
  return result;
}

TEST(FitInvariance, OrderAndCopiesChangeNoByte) {
  for (const bool normals : {true, false}) {
    Cloud cloud = sceneCloud(Shape::kBumpy, 6000, 0.0005, 0.1);
    if (!normals) cloud = cloud.withoutNormals();
    std::vector<std::size_t> order(cloud.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto expected = encodeSlim(fitted(cloud).surface);
    std::shuffle(order.begin(), order.end(), std::mt19937_64(111));
    EXPECT_EQ(encodeSlim(fitted(reordered(cloud, order)).surface), expected);
    if (normals) continue;  // the mean of equal normals rounds
    order.insert(order.end(), order.begin(), order.end());
    order.insert(order.end(), order.begin(), order.begin() + 3000);
    EXPECT_EQ(encodeSlim(fitted(reordered(cloud, order)).surface), expected);
  }
}

TEST(FitInvariance, SeveralCallersGetTheSameBytes) {
  const Cloud cloud = sceneCloud(Shape::kBumpy, 6000, 0.0005, 0.1);
  FitParams params;
  params.threads = 1;
  const auto expected = encodeSlim(fitted(cloud, params).surface);
  params.threads = 4;
  std::array<bool, 4> same{};
  std::vector<std::thread> callers;
  for (bool& result : same) {
    callers.emplace_back([&] { result = encodeSlim(fitted(cloud, params).surface) == expected; });
  }
  for (std::thread& caller : callers) caller.join();
  for (const bool result : same) EXPECT_TRUE(result);
}

/** Levels of one cell, of tens and of hundreds are shared in different ways. */
TEST(FitInvariance, AnyNumberOfThreadsGivesTheSame) {
  for (const double noise : {0.0, 0.002, 0.01}) {
    const Cloud cloud = sceneCloud(Shape::kTorus, 20000, noise);
    FitParams params;
    params.threads = 1;
    const auto expected = encodeSlim(fitted(cloud, params).surface);
    for (const int threads : {2, 3, 8}) {
      params.threads = threads;
      EXPECT_EQ(encodeSlim(fitted(cloud, params).surface), expected) << noise << " " << threads;
    }
  }
}

TEST(FitInvariance, APowerOfTwoScalesTheUnitsOnly) {
  Cloud cloud = sceneCloud(Shape::kTorus, 6000, 0.0005);
  const auto one = fitted(cloud);
  for (double& value : cloud.points) value *= 1024.0;
  const auto large = fitted(cloud);
  EXPECT_EQ(large.surface.info.scale, 1024.0 * one.surface.info.scale);
  EXPECT_EQ(large.surface.cx, one.surface.cx);
  EXPECT_EQ(large.surface.radius, one.surface.radius);
  EXPECT_EQ(large.surface.coefficients, one.surface.coefficients);
  EXPECT_EQ(large.projection.position, one.projection.position);
}

TEST(FitInvariance, ThePlaceOnEarthDoesNotMatter) {
  for (const double noise : {0.0, 0.001}) {
    const Cloud cloud = sceneCloud(Shape::kTorus, 8000, noise);
    const auto here = errorsOf(Shape::kTorus, fitted(cloud));
    Cloud far = cloud;
    const double shift[] = {432100.5, 5412345.25, -310.0};
    for (std::size_t i = 0; i < far.points.size(); ++i) far.points[i] += shift[i % 3];
    auto f = fitted(far);
    expectSound(f);
    // Measured where the exact surface is: double holds the shifted points to 1e-9.
    double sum = 0;
    for (const auto& local : f.projection.position) {
      auto p = f.world(local);
      for (std::size_t a = 0; a < 3; ++a) p[a] -= shift[a];
      sum += std::pow(measure::truthAt(Shape::kTorus, p).distance, 2);
    }
    const double there = std::sqrt(sum / static_cast<double>(f.store.size()));
    EXPECT_LT(there, 1.1 * here.position + 1e-9) << noise;
  }
}

TEST(FitInvariance, ATurnedCloudIsFittedAsWell) {
  // No axis is special: the same points about a skew axis give like errors and leaves.
  const Cloud cloud = sceneCloud(Shape::kBumpy, 12000, 0.0005).withoutNormals();
  const auto straight = fitted(cloud);
  Cloud turned;
  const LocalFrame frame({0.36, 0.48, -0.8});
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double* p = cloud.points.data() + 3 * i;
    std::array<double, 3> q;
    for (std::size_t a = 0; a < 3; ++a)
      q[a] = p[0] * frame.u[a] + p[1] * frame.v[a] + p[2] * frame.w[a];
    turned.add(q[0], q[1], q[2]);
  }
  const auto skew = fitted(turned);
  double sum = 0;
  for (const auto& local : skew.projection.position) {
    const auto q = skew.world(local);
    std::array<double, 3> p{};
    for (std::size_t a = 0; a < 3; ++a) {
      p[0] += q[a] * frame.u[a];
      p[1] += q[a] * frame.v[a];
      p[2] += q[a] * frame.w[a];
    }
    sum += std::pow(measure::truthAt(Shape::kBumpy, p).distance, 2);
  }
  const double rms = std::sqrt(sum / static_cast<double>(skew.store.size()));
  EXPECT_NEAR(rms / errorsOf(Shape::kBumpy, straight).position, 1.0, 0.15);
  EXPECT_NEAR(double(skew.statistics.leaves) / double(straight.statistics.leaves), 1.0, 0.2);
}

TEST(FitInvariance, ManyThreadsForFewPoints) {
  const Cloud cloud = sceneCloud(Shape::kSphere, 60, 0.0);
  const PointStore store = pcl_slim_test::storeOf(cloud, 64);
  FitParams params;
  params.threads = 64;
  SLIMSurface surface;
  ASSERT_FALSE(fitSurface(store, params, surface));
  EXPECT_EQ(encodeSlim(surface), encodeSlim(fitted(cloud).surface));
}

TEST(FitInvariance, ExtremeCoverSettingsEnd) {
  const Cloud cloud = sceneCloud(Shape::kBumpy, 2000, 0.0005);
  for (const double radius : {0.01, 1.0}) {
    for (const double threshold : {1e-6, 1.0}) {
      FitParams params;
      params.cover_radius = radius;
      params.cover_threshold = threshold;
      const auto f = fitted(cloud, params);
      expectSound(f);
      EXPECT_GT(f.statistics.leaves, 0u);
      EXPECT_LE(f.statistics.leaves, 40u * cloud.size());
    }
  }
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Outliers are scattered points, of which the truth is known here; clean clouds have next to none.
#include "pcl_slim/cloud/outliers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include "support/clouds.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using measure::Shape;

constexpr std::size_t kPoints = 20000;
constexpr double kNoise = 0.005;

/** A unit sphere with white noise, then points spread evenly over a box about it. */
Cloud sphereAmongOutliers(double share) {
  Cloud cloud;
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> inside(-1.3, 1.3);
  for (std::size_t i = 0; i < kPoints; ++i) {
    double p[3], length = 0;
    for (double& x : p) x = normal(random);
    for (const double x : p) length = std::hypot(length, x);
    for (double& x : p) x = x / length + kNoise * normal(random);
    cloud.add(p[0], p[1], p[2]);
  }
  const auto outliers = static_cast<std::size_t>(share / (1 - share) * kPoints);
  for (std::size_t i = 0; i < outliers; ++i)
    cloud.add(inside(random), inside(random), inside(random));
  return cloud;
}

double offSphere(const Cloud& cloud, std::size_t i) {
  const double* p = &cloud.points[3 * i];
  return std::abs(std::hypot(p[0], p[1], p[2]) - 1);
}

/** Input points that are outliers. */
std::set<std::size_t> outliersOf(const Cloud& cloud, int threads = 1) {
  const PointStore store = storeOf(cloud, threads);
  std::set<std::size_t> found;
  for (const std::uint32_t i : findOutliers(store, threads)) found.insert(store.orderOfStore()[i]);
  return found;
}

TEST(Outliers, ScatteredPointsAreFoundAndPointsOfTheSurfaceAreNot) {
  const double spacing = std::sqrt(4 * M_PI / kPoints);
  for (const double share : {0.01, 0.05, 0.1, 0.2}) {
    const Cloud cloud = sphereAmongOutliers(share);
    const auto found = outliersOf(cloud);
    std::size_t far = 0, missed = 0, near = 0, wrong = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const double off = offSphere(cloud, i);
      const bool marked = found.count(i) != 0;
      if (off > 2 * spacing) {
        ++far;
        missed += !marked;
      } else if (off < 4 * kNoise && i < kPoints) {
        ++near;
        wrong += marked;
      }
    }
    EXPECT_LE(static_cast<double>(missed), 0.06 * static_cast<double>(far)) << share;
    EXPECT_LE(static_cast<double>(wrong), 0.001 * static_cast<double>(near)) << share;
  }
}

TEST(Outliers, CleanCloudsHaveNextToNone) {
  for (const Shape shape : {Shape::kSphere, Shape::kTorus, Shape::kBumpy, Shape::kRelief}) {
    for (const double noise : {0.0, 0.001, 0.01}) {
      EXPECT_LE(outliersOf(sceneCloud(shape, 20000, noise)).size(), 5u)
          << static_cast<int>(shape) << " " << noise;
    }
  }
}

TEST(Outliers, UnevenDensityAndScanLinesAreNoReason) {
  // A plane scanned from one of its corners: rings whose spacing grows a hundredfold.
  Cloud rings;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, 0.002);
  for (int ring = 0; ring < 60; ++ring) {
    const double radius = 0.05 * std::pow(1.09, ring);
    for (int k = 0; k < 200; ++k) {
      const double angle = 0.5 * M_PI * k / 200;
      rings.add(radius * std::cos(angle), radius * std::sin(angle), normal(random));
    }
  }
  EXPECT_TRUE(outliersOf(rings).empty());
}

TEST(Outliers, TurnedShuffledAndScaledCloudsHaveTheSame) {
  const Cloud cloud = sphereAmongOutliers(0.1);
  const auto found = outliersOf(cloud);
  std::vector<std::size_t> order(cloud.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  Cloud changed;
  const double c = std::cos(0.7), s = std::sin(0.7), scale = 250.0;
  for (const std::size_t i : order) {
    const double* p = &cloud.points[3 * i];
    changed.add(scale * (c * p[0] - s * p[1]) + 1000, scale * p[2], scale * (s * p[0] + c * p[1]));
  }
  std::set<std::size_t> again;
  for (const std::size_t i : outliersOf(changed)) again.insert(order[i]);
  std::vector<std::size_t> differ;
  std::set_symmetric_difference(found.begin(), found.end(), again.begin(), again.end(),
                                std::back_inserter(differ));
  EXPECT_LE(static_cast<double>(differ.size()), 0.03 * static_cast<double>(found.size()));
}

TEST(Outliers, AreTheSameForAnyNumberOfThreads) {
  const Cloud cloud = sphereAmongOutliers(0.05);
  const auto found = outliersOf(cloud);
  EXPECT_FALSE(found.empty());
  EXPECT_EQ(outliersOf(cloud, 2), found);
  EXPECT_EQ(outliersOf(cloud, 3), found);
}

TEST(Outliers, FewOrEqualPointsHaveNone) {
  Cloud few;
  for (int i = 0; i < 40; ++i) few.add(i, i % 7, i == 39 ? 1000 : i % 3);
  EXPECT_TRUE(outliersOf(few).empty());
  Cloud equal;
  for (int i = 0; i < 500; ++i) equal.add(1, 2, 3);
  EXPECT_TRUE(outliersOf(equal).empty());
}

TEST(PointStoreWithout, KeepsTheOthersAndTheirOrder) {
  Cloud cloud = sceneCloud(Shape::kBumpy, 1000, 0.001);
  for (int i = 0; i < 20; ++i)
    cloud.add({cloud.points[60 * i], cloud.points[60 * i + 1], cloud.points[60 * i + 2]},
              {0, 0, 1});
  const PointStore all = storeOf(cloud);
  std::vector<std::uint32_t> dropped;
  for (std::uint32_t i = 3; i < all.size(); i += 7) dropped.push_back(i);
  const PointStore rest = all.without(dropped, 3);
  ASSERT_EQ(rest.size(), all.size() - dropped.size());
  EXPECT_EQ(rest.scale(), all.scale());
  EXPECT_EQ(rest.numBlocks(), (rest.size() + PointStore::kBlock - 1) / PointStore::kBlock);
  std::size_t j = 0;
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    if (i % 7 == 3) continue;
    for (std::size_t a = 0; a < 3; ++a)
      ASSERT_NEAR(rest.position(j)[a], all.position(i)[a], 1e-7) << i;
    ASSERT_EQ(rest.normal(j), all.normal(i)) << i;
    ASSERT_EQ(rest.keys()[j], all.keys()[i]);
    ASSERT_EQ(rest.orderOfStore()[j], all.orderOfStore()[i]);
    ++j;
  }
  const auto map = rest.storeOfInput(), before = all.storeOfInput();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (before[i] % 7 == 3) {
      EXPECT_EQ(map[i], PointStore::kSkipped);
    } else {
      ASSERT_LT(map[i], rest.size());
      EXPECT_EQ(rest.orderOfStore()[map[i]], all.orderOfStore()[before[i]]);
    }
  }
  std::vector<std::uint32_t> blocks;
  const auto p = rest.position(0);
  const float center[3] = {static_cast<float>(p[0]), static_cast<float>(p[1]),
                           static_cast<float>(p[2])};
  rest.tree().blocksInBall(center, 2.0f, blocks);
  EXPECT_EQ(blocks.size(), rest.numBlocks());
}

}  // namespace
}  // namespace pcl_slim

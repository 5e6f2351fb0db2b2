// SPDX-License-Identifier: BSD-3-Clause
// What a store keeps: precision, order, units, the same for any number of threads.
#include "pcl_slim/cloud/point_store.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "support/survey_cloud.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

/** Coordinate of a Morton code's cell: every third bit from the one given on. */
double cellOf(std::uint64_t key, int axis) {
  std::uint64_t cell = 0;
  for (int bit = 0; bit < 21; ++bit) cell |= (key >> (3 * bit + 2 - axis) & 1u) << bit;
  return static_cast<double>(cell);
}

TEST(PointStore, KeepsSurveyCoordinatesToABillionthOfTheDiagonal) {
  const Cloud cloud = surveyCloud(20000);
  const PointStore store = storeOf(cloud);
  ASSERT_EQ(store.size(), 20000u);
  // Blocks that span two halves of the box store offsets as long as the half.
  EXPECT_LT(largestOffset(cloud, store), 0x1p-25);
  double sum = 0;
  for (std::size_t i = 0; i < store.size(); ++i) {
    const auto p = store.position(i);
    const double x = cloud.points[3 * store.orderOfStore()[i]];
    sum += std::pow((x - store.origin()[0]) / store.scale() - p[0], 2);
  }
  EXPECT_LT(std::sqrt(sum / 20000), 1e-9);
}

TEST(PointStore, ScaleIsAPowerOfTwoAndTheBoxFits) {
  for (const double size : {1e-9, 0.003, 1.0, 77.7, 4e6}) {
    Cloud cloud = surveyCloud(500);
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      cloud.points[i] = (cloud.points[i] - cloud.points[i % 3]) * size;
    }
    const PointStore store = storeOf(cloud);
    int exponent = 0;
    EXPECT_EQ(std::frexp(store.scale(), &exponent), 0.5) << size;
    EXPECT_GT(store.diagonal(), 0.49) << size;
    EXPECT_LT(store.diagonal(), 1.0) << size;
    for (std::size_t i = 0; i < store.size(); ++i) {
      for (const double value : store.position(i)) ASSERT_LE(std::abs(value), 0.5);
    }
  }
}

TEST(PointStore, StandsInMortonOrder) {
  const PointStore store = storeOf(surveyCloud(20000));
  const std::uint64_t* keys = store.keys();
  for (std::size_t i = 0; i < store.size(); ++i) {
    ASSERT_LE(keys[i == 0 ? 0 : i - 1], keys[i]);
    ASSERT_EQ(keys[i] >> 63, 0u);
    const auto p = store.position(i);
    for (int a = 0; a < 3; ++a) {
      const double cell = (p[static_cast<std::size_t>(a)] + 0.5) * 0x1p21;
      ASSERT_NEAR(cellOf(keys[i], a) + 0.5, cell, 0.52) << i;
    }
  }
}

TEST(PointStore, AFarOutlierCostsTheClusterNothing) {
  Cloud cloud;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int i = 0; i < 5000; ++i) cloud.add(u(random), u(random), u(random));
  cloud.add(1e6, 2e6, -3e6);
  const PointStore store = storeOf(cloud);
  EXPECT_EQ(store.size(), 5000u);
  EXPECT_EQ(store.statistics().far_away, 1u);
  EXPECT_EQ(store.storeOfInput()[5000], PointStore::kSkipped);
  EXPECT_LT(largestOffset(cloud, store), 1e-7);
}

TEST(PointStore, AnOutlierThatStaysCostsTheClusterLittle) {
  Cloud cloud;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int i = 0; i < 5000; ++i) cloud.add(u(random), u(random), u(random));
  cloud.add(3e3, 2e3, -3e3);
  const PointStore store = storeOf(cloud);
  ASSERT_EQ(store.size(), 5001u);
  EXPECT_LT(largestOffset(cloud, store), 4e-8);
  // A block with the outlier in it has float offsets of half the box; every other is near its own.
  const std::size_t far = store.storeOfInput()[5000];
  for (std::size_t i = 0; i < store.size(); ++i) {
    if (i / PointStore::kBlock == far / PointStore::kBlock) continue;
    const double x = store.origin()[0] + store.scale() * store.position(i)[0];
    ASSERT_NEAR(x, cloud.points[3 * store.orderOfStore()[i]], 1e-6);
  }
}

TEST(PointStore, FloatAndDoubleInputAgree) {
  Cloud cloud = surveyCloud(3000);
  for (double& value : cloud.points) value = static_cast<float>(value);
  struct Record {
    float x, y, z, pad;
  };
  std::vector<Record> records;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    records.push_back({static_cast<float>(cloud.points[3 * i]),
                       static_cast<float>(cloud.points[3 * i + 1]),
                       static_cast<float>(cloud.points[3 * i + 2]), -1.0f});
  }
  CloudView view;
  view.xyz = records.data();
  view.xyz_stride = sizeof(Record);
  view.size = records.size();
  const auto of_floats = PointStore::build(view, 1);
  ASSERT_TRUE(of_floats);
  const PointStore of_doubles = storeOf(cloud);
  ASSERT_EQ(of_floats->size(), of_doubles.size());
  EXPECT_EQ(of_floats->orderOfStore(), of_doubles.orderOfStore());
  for (std::size_t i = 0; i < of_doubles.size(); ++i) {
    ASSERT_EQ(of_floats->position(i), of_doubles.position(i));
  }
}

TEST(PointStore, IsTheSameForAnyNumberOfThreads) {
  Cloud cloud = surveyCloud(80000);
  for (std::size_t i = 0; i < 80000; i += 13) {
    cloud.points[3 * i + 1] = std::numeric_limits<double>::quiet_NaN();
  }
  for (std::size_t i = 40000; i < 60000; ++i) cloud.points[3 * i] = cloud.points[3 * (i - 40000)];
  for (std::size_t i = 40001; i < 60000; i += 2) {
    for (std::size_t a = 1; a < 3; ++a) cloud.points[3 * i + a] = cloud.points[3 * (i - 40000) + a];
  }
  cloud.normals.assign(240000, 0.5f);
  cloud.normals[77] = -0.25f;
  const PointStore one = storeOf(cloud, 1);
  EXPECT_GT(one.statistics().duplicates, 5000u);
  for (const int threads : {2, 8}) {
    const PointStore many = storeOf(cloud, threads);
    ASSERT_EQ(many.size(), one.size());
    EXPECT_EQ(many.orderOfStore(), one.orderOfStore());
    EXPECT_EQ(many.storeOfInput(), one.storeOfInput());
    EXPECT_EQ(many.scale(), one.scale());
    EXPECT_EQ(many.origin(), one.origin());
    const std::size_t padded = one.numBlocks() * PointStore::kBlock;
    const auto same = [&](const float* a, const float* b, std::size_t n) {
      return std::equal(a, a + n, b);
    };
    EXPECT_TRUE(same(many.x(), one.x(), padded));
    EXPECT_TRUE(same(many.y(), one.y(), padded));
    EXPECT_TRUE(same(many.z(), one.z(), padded));
    EXPECT_TRUE(same(many.nx(), one.nx(), padded));
    EXPECT_TRUE(same(many.nz(), one.nz(), padded));
    EXPECT_TRUE(same(many.blockOriginX(), one.blockOriginX(), one.numBlocks()));
    EXPECT_TRUE(same(many.blockOriginZ(), one.blockOriginZ(), one.numBlocks()));
    EXPECT_TRUE(std::equal(one.keys(), one.keys() + one.size(), many.keys()));
  }
}

TEST(PointStore, StaysWithin48BytesAPoint) {
  Cloud cloud = surveyCloud(30000);
  EXPECT_LE(storeOf(cloud).memoryBytes(), 36u * 30000u);
  cloud.normals.assign(90000, 1.0f);
  EXPECT_LE(storeOf(cloud).memoryBytes(), 48u * 30000u);
}

TEST(PointStore, PadsItsLastBlockFarAway) {
  const PointStore store = storeOf(surveyCloud(20));
  ASSERT_EQ(store.numBlocks(), 2u);
  for (std::size_t i = 20; i < 32; ++i) EXPECT_EQ(store.x()[i], PointStore::kFarAway);
}

TEST(PointStore, ScalesHugeAndTinyClouds) {
  for (const double size : {1e-120, 1e-30, 1e30, 1e120, 1e200}) {
    Cloud cloud;
    std::mt19937_64 random(6);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    for (int i = 0; i < 200; ++i) cloud.add(size * u(random), size * u(random), size * u(random));
    const auto store = PointStore::build(cloud.view(), 1);
    ASSERT_TRUE(store);
    EXPECT_EQ(store->size(), 200u) << size;
    EXPECT_LT(largestOffset(cloud, *store), 1e-7) << size;
  }
}

/** The scale of such clouds has no finite inverse. */
TEST(PointStore, RefusesCloudsWhoseDifferencesAreDenormal) {
  for (const double size : {1e-303, 1e-310, 1e-320}) {
    Cloud cloud;
    std::mt19937_64 random(6);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    for (int i = 0; i < 200; ++i) cloud.add(size * u(random), size * u(random), size * u(random));
    const auto store = PointStore::build(cloud.view(), 1);
    ASSERT_FALSE(store) << size;
    EXPECT_EQ(store.error().code, ErrorCode::kBadInput);
    EXPECT_NE(store.error().message.find("1e-301"), std::string::npos) << store.error().message;
  }
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/point_store.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "support/clouds.h"

namespace pcl_slim {
namespace {

using pcl_slim_test::Cloud;
using pcl_slim_test::storeOf;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/** Points in a box of a land survey's coordinates: metres, millions of them from the origin. */
Cloud
surveyCloud(std::size_t count)
{
  Cloud cloud;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (std::size_t i = 0; i < count; ++i) {
    cloud.add(432100.5 + 800 * u(random), 5412345.25 + 600 * u(random), 310 + 50 * u(random));
  }
  return cloud;
}

/** Largest distance between a stored point, brought back, and what was given [local]. */
double
largestOffset(const Cloud& cloud, const PointStore& store)
{
  double worst = 0;
  for (std::size_t i = 0; i < store.size(); ++i) {
    const auto p = store.position(i);
    for (std::size_t a = 0; a < 3; ++a) {
      const double given = cloud.points[3 * store.orderOfStore()[i] + a];
      const double offset = std::abs((given - store.origin()[a]) / store.scale() - p[a]);
      if (!std::isfinite(offset)) return offset;
      worst = std::max(worst, offset);
    }
  }
  return worst;
}

/** Coordinate of a Morton code's cell: every third bit from the one given on. */
double
cellOf(std::uint64_t key, int axis)
{
  std::uint64_t cell = 0;
  for (int bit = 0; bit < 21; ++bit) cell |= (key >> (3 * bit + 2 - axis) & 1u) << bit;
  return static_cast<double>(cell);
}

TEST(PointStore, KeepsSurveyCoordinatesToABillionthOfTheDiagonal)
{
  const Cloud cloud = surveyCloud(20000);
  const PointStore store = storeOf(cloud);
  ASSERT_EQ(store.size(), 20000u);
  // Blocks that span two halves of the box hold offsets as long as the half.
  EXPECT_LT(largestOffset(cloud, store), 0x1p-25);
  double sum = 0;
  for (std::size_t i = 0; i < store.size(); ++i) {
    const auto p = store.position(i);
    const double x = cloud.points[3 * store.orderOfStore()[i]];
    sum += std::pow((x - store.origin()[0]) / store.scale() - p[0], 2);
  }
  EXPECT_LT(std::sqrt(sum / 20000), 1e-9);
}

TEST(PointStore, ScaleIsAPowerOfTwoAndTheBoxFits)
{
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

TEST(PointStore, StandsInMortonOrder)
{
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

TEST(PointStore, SkipsAndCountsWhatIsNotFinite)
{
  Cloud cloud = surveyCloud(100);
  cloud.points[3 * 10] = kNan;
  cloud.points[3 * 20 + 1] = kInf;
  cloud.points[3 * 99 + 2] = -kInf;
  const PointStore store = storeOf(cloud);
  EXPECT_EQ(store.size(), 97u);
  EXPECT_EQ(store.statistics().input_points, 100u);
  EXPECT_EQ(store.statistics().non_finite, 3u);
  const auto stored = store.storeOfInput();
  ASSERT_EQ(stored.size(), 100u);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(stored[i] == PointStore::kSkipped, i == 10 || i == 20 || i == 99) << i;
  }
  EXPECT_LT(largestOffset(cloud, store), 1e-7);
}

TEST(PointStore, DropsAndCountsPointsWhoseNormalIsMissing)
{
  Cloud cloud = surveyCloud(100);
  cloud.normals.assign(300, 0.6f);
  for (const std::size_t i : {5u, 50u}) cloud.normals[3 * i] = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t a = 0; a < 3; ++a) cloud.normals[3 * 70 + a] = 0.0f;
  cloud.points[3 * 71] = kNan;
  const PointStore store = storeOf(cloud);
  EXPECT_EQ(store.size(), 96u);
  EXPECT_EQ(store.statistics().without_normal, 3u);
  EXPECT_EQ(store.statistics().non_finite, 1u);
  ASSERT_TRUE(store.hasNormals());
  for (std::size_t i = 0; i < store.size(); ++i) {
    const auto n = store.normal(i);
    EXPECT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1.0, 1e-6);
  }
}

TEST(PointStore, NormalsThatAreAllMissingCountAsNone)
{
  Cloud cloud = surveyCloud(50);
  cloud.normals.assign(150, 0.0f);
  const PointStore store = storeOf(cloud);
  EXPECT_FALSE(store.hasNormals());
  EXPECT_EQ(store.size(), 50u);
  EXPECT_EQ(store.statistics().without_normal, 0u);
}

TEST(PointStore, SmallestNormalsAreMadeUnit)
{
  Cloud cloud = surveyCloud(20);
  for (std::size_t i = 0; i < 20; ++i) cloud.normals.insert(cloud.normals.end(), {0.0f, 3e-11f, 4e-11f});
  const PointStore store = storeOf(cloud);
  ASSERT_TRUE(store.hasNormals());
  const auto n = store.normal(7);
  EXPECT_NEAR(n[1], 0.6f, 1e-6);
  EXPECT_NEAR(n[2], 0.8f, 1e-6);
}

TEST(PointStore, MergesCopies)
{
  Cloud cloud = surveyCloud(500);
  const auto once = cloud.points;
  for (int copy = 0; copy < 3; ++copy) {
    cloud.points.insert(cloud.points.end(), once.begin(), once.end());
  }
  const PointStore store = storeOf(cloud);
  EXPECT_EQ(store.size(), 500u);
  EXPECT_EQ(store.statistics().duplicates, 1500u);
  const auto stored = store.storeOfInput();
  ASSERT_EQ(stored.size(), 2000u);
  for (std::size_t i = 0; i < 2000; ++i) {
    ASSERT_LT(stored[i], 500u);
    ASSERT_EQ(stored[i], stored[i % 500]);
  }
  EXPECT_LT(largestOffset(cloud, store), 1e-7);
}

TEST(PointStore, MergedPointsHaveTheirMeanNormal)
{
  Cloud cloud = surveyCloud(20);
  for (int i = 0; i < 20; ++i) cloud.normals.insert(cloud.normals.end(), {0.0f, 0.0f, 1.0f});
  const std::array<double, 3> again = {cloud.points[0], cloud.points[1], cloud.points[2]};
  cloud.add(again, {1.0, 0.0, 0.0});
  const PointStore store = storeOf(cloud);
  ASSERT_EQ(store.size(), 20u);
  const auto n = store.normal(store.storeOfInput()[0]);
  EXPECT_NEAR(n[0], std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(n[1], 0.0, 1e-6);
  EXPECT_NEAR(n[2], std::sqrt(0.5), 1e-6);
}

TEST(PointStore, AThousandEqualPointsAmongOthersAreOne)
{
  Cloud cloud = surveyCloud(300);
  for (int i = 0; i < 1000; ++i) cloud.add(432500.125, 5412500.25, 333.5);
  const PointStore store = storeOf(cloud);
  EXPECT_EQ(store.size(), 301u);
  EXPECT_EQ(store.statistics().duplicates, 999u);
}

TEST(PointStore, HoldsOnePlace)
{
  for (const int copies : {1, 1000}) {
    Cloud cloud;
    for (int i = 0; i < copies; ++i) cloud.add(432500.125, -5412500.25, 0.0);
    const PointStore store = storeOf(cloud);
    ASSERT_EQ(store.size(), 1u);
    EXPECT_EQ(store.diagonal(), 0.0);
    EXPECT_EQ(store.statistics().duplicates, static_cast<std::uint64_t>(copies - 1));
    EXPECT_NEAR(store.origin()[0] + store.scale() * store.position(0)[0], 432500.125, 1e-6);
    EXPECT_NEAR(store.origin()[1] + store.scale() * store.position(0)[1], -5412500.25, 1e-6);
    EXPECT_NEAR(store.origin()[2] + store.scale() * store.position(0)[2], 0.0, 1e-6);
  }
}

TEST(PointStore, MapsBothWays)
{
  Cloud cloud = surveyCloud(5000);
  for (std::size_t i = 0; i < 5000; i += 7) cloud.points[3 * i] = kNan;
  for (std::size_t i = 1; i < 5000; i += 11) {
    for (std::size_t a = 0; a < 3; ++a) cloud.points[3 * i + a] = cloud.points[3 * 2 + a];
  }
  const PointStore store = storeOf(cloud);
  const auto stored = store.storeOfInput();
  ASSERT_EQ(stored.size(), 5000u);
  for (std::size_t i = 0; i < store.size(); ++i) ASSERT_EQ(stored[store.orderOfStore()[i]], i);
  const auto& s = store.statistics();
  EXPECT_EQ(s.input_points, s.non_finite + s.duplicates + store.size());
  for (std::size_t i = 0; i < 5000; ++i) {
    if (std::isnan(cloud.points[3 * i])) {
      ASSERT_EQ(stored[i], PointStore::kSkipped);
    } else {
      ASSERT_NEAR(store.origin()[2] + store.scale() * store.position(stored[i])[2],
                  cloud.points[3 * i + 2], 1e-5);
    }
  }
}

TEST(PointStore, TakesOnlyThePointsAskedFor)
{
  const Cloud cloud = surveyCloud(1000);
  std::vector<std::int32_t> indices;
  for (std::int32_t i = 999; i >= 0; i -= 3) indices.push_back(i);
  indices.push_back(999);
  CloudView view = cloud.view();
  view.indices = indices.data();
  view.num_indices = indices.size();
  const auto store = PointStore::build(view, 1);
  ASSERT_TRUE(store);
  EXPECT_EQ(store->size(), indices.size() - 1);
  EXPECT_EQ(store->statistics().input_points, indices.size());
  EXPECT_EQ(store->statistics().duplicates, 1u);
  for (std::size_t i = 0; i < store->size(); ++i) {
    const auto input = static_cast<std::size_t>(indices[store->orderOfStore()[i]]);
    const double x = store->origin()[0] + store->scale() * store->position(i)[0];
    ASSERT_NEAR(x, cloud.points[3 * input], 1e-4);
  }
}

TEST(PointStore, RefusesIndicesOutsideTheCloud)
{
  const Cloud cloud = surveyCloud(10);
  for (const std::int32_t wrong : {-1, 10, 2000000000}) {
    const std::int32_t indices[] = {0, wrong, 3};
    CloudView view = cloud.view();
    view.indices = indices;
    view.num_indices = 3;
    const auto store = PointStore::build(view, 1);
    ASSERT_FALSE(store);
    EXPECT_EQ(store.error().code, ErrorCode::kBadArgument);
    EXPECT_NE(store.error().message.find(std::to_string(wrong)), std::string::npos);
  }
}

TEST(PointStore, RefusesNothing)
{
  EXPECT_FALSE(PointStore::build(CloudView(), 1));
  EXPECT_FALSE(PointStore::build(Cloud().view(), 1));
  Cloud cloud;
  for (int i = 0; i < 5; ++i) cloud.add(kNan, 1.0, kInf);
  const auto store = PointStore::build(cloud.view(), 1);
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::kBadInput);
  EXPECT_FALSE(store.error().message.empty());
  const Cloud some = surveyCloud(5);
  const std::int32_t index = 0;
  CloudView view = some.view();
  view.indices = &index;
  view.num_indices = 0;
  EXPECT_FALSE(PointStore::build(view, 1));
}

TEST(PointStore, AFarOutlierCostsTheClusterNothing)
{
  Cloud cloud;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int i = 0; i < 5000; ++i) cloud.add(u(random), u(random), u(random));
  cloud.add(1e6, 2e6, -3e6);
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

TEST(PointStore, FloatAndDoubleInputAgree)
{
  Cloud cloud = surveyCloud(3000);
  for (double& value : cloud.points) value = static_cast<float>(value);
  struct Record {
    float x, y, z, pad;
  };
  std::vector<Record> records;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    records.push_back({static_cast<float>(cloud.points[3 * i]), static_cast<float>(cloud.points[3 * i + 1]),
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

TEST(PointStore, IsTheSameForAnyNumberOfThreads)
{
  Cloud cloud = surveyCloud(80000);
  for (std::size_t i = 0; i < 80000; i += 13) cloud.points[3 * i + 1] = kNan;
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
    const auto same = [&](const float* a, const float* b, std::size_t n) { return std::equal(a, a + n, b); };
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

TEST(PointStore, StaysWithin48BytesAPoint)
{
  Cloud cloud = surveyCloud(30000);
  EXPECT_LE(storeOf(cloud).memoryBytes(), 36u * 30000u);
  cloud.normals.assign(90000, 1.0f);
  EXPECT_LE(storeOf(cloud).memoryBytes(), 48u * 30000u);
}

TEST(PointStore, PadsItsLastBlockFarAway)
{
  const PointStore store = storeOf(surveyCloud(20));
  ASSERT_EQ(store.numBlocks(), 2u);
  for (std::size_t i = 20; i < 32; ++i) EXPECT_EQ(store.x()[i], PointStore::kFarAway);
}

TEST(PointStore, ScalesHugeAndTinyClouds)
{
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

TEST(PointStore, RefusesCoordinatesThatNoBoxCanHold)
{
  Cloud cloud = surveyCloud(10);
  cloud.add(1.7e308, 0.0, 0.0);
  cloud.add(-1.7e308, 0.0, 0.0);
  const auto store = PointStore::build(cloud.view(), 1);
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// What a store takes in, skips, merges and refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "pcl_slim/cloud/point_store.h"
#include "support/survey_cloud.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(PointStore, SkipsAndCountsWhatIsNotFinite) {
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

TEST(PointStore, DropsAndCountsPointsWhoseNormalIsMissing) {
  Cloud cloud = surveyCloud(100);
  cloud.normals.assign(300, 0.6f);
  for (const std::size_t i : {5u, 50u})
    cloud.normals[3 * i] = std::numeric_limits<float>::quiet_NaN();
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

TEST(PointStore, OneFarPointLeavesTheOthersTheirUnits) {
  const Cloud near = surveyCloud(500);
  const PointStore expected = storeOf(near);
  for (const double distance : {1e7, 1e9, 1e20, 1e38}) {
    Cloud cloud = near;
    cloud.points.insert(cloud.points.end(), {cloud.points[0] + distance, cloud.points[1], 0.0});
    const PointStore store = storeOf(cloud);
    EXPECT_EQ(store.statistics().far_away, 1u) << distance;
    EXPECT_EQ(store.size(), expected.size());
    EXPECT_EQ(store.scale(), expected.scale());
    EXPECT_EQ(store.origin(), expected.origin());
    EXPECT_EQ(store.storeOfInput()[500], PointStore::kSkipped);
  }
}

TEST(PointStore, PointsAcrossAWideSurveyAreNoStrays) {
  // Half of the points on an object a metre wide, the others along ten kilometres.
  Cloud cloud = surveyCloud(0);
  for (int i = 0; i < 2000; ++i) {
    const double t = i / 2000.0;
    const double reach = i % 2 == 0 ? 1.0 : 10000.0;
    cloud.points.insert(cloud.points.end(), {reach * t, std::sin(40 * t), std::cos(70 * t)});
  }
  const PointStore store = storeOf(cloud);
  EXPECT_EQ(store.statistics().far_away, 0u);
  EXPECT_EQ(store.size(), 2000u);
}

TEST(PointStore, NormalsThatAreAllMissingCountAsNone) {
  Cloud cloud = surveyCloud(50);
  cloud.normals.assign(150, 0.0f);
  const PointStore store = storeOf(cloud);
  EXPECT_FALSE(store.hasNormals());
  EXPECT_EQ(store.size(), 50u);
  EXPECT_EQ(store.statistics().without_normal, 0u);
}

TEST(PointStore, SmallestNormalsAreMadeUnit) {
  Cloud cloud = surveyCloud(20);
  for (std::size_t i = 0; i < 20; ++i)
    cloud.normals.insert(cloud.normals.end(), {0.0f, 3e-11f, 4e-11f});
  const PointStore store = storeOf(cloud);
  ASSERT_TRUE(store.hasNormals());
  const auto n = store.normal(7);
  EXPECT_NEAR(n[1], 0.6f, 1e-6);
  EXPECT_NEAR(n[2], 0.8f, 1e-6);
}

TEST(PointStore, MergesCopies) {
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

TEST(PointStore, MergedPointsHaveTheirMeanNormal) {
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

TEST(PointStore, AThousandEqualPointsAmongOthersAreOne) {
  Cloud cloud = surveyCloud(300);
  for (int i = 0; i < 1000; ++i) cloud.add(432500.125, 5412500.25, 333.5);
  const PointStore store = storeOf(cloud);
  EXPECT_EQ(store.size(), 301u);
  EXPECT_EQ(store.statistics().duplicates, 999u);
}

TEST(PointStore, HoldsOnePlace) {
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

TEST(PointStore, MapsBothWays) {
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

TEST(PointStore, TakesOnlyThePointsAskedFor) {
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

TEST(PointStore, RefusesIndicesOutsideTheCloud) {
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

TEST(PointStore, RefusesNothing) {
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

/** Repeated points leave the others' normals as they are, to the last bit, and their own. */
TEST(PointStore, PointsGivenAgainChangeNoNormal) {
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal;
  Cloud once;
  for (int i = 0; i < 300; ++i) {
    once.add({normal(random), normal(random), normal(random)},
             {normal(random), normal(random), normal(random)});
  }
  const auto expected = PointStore::build(once.view(), 1);
  ASSERT_TRUE(expected);
  Cloud again = once;
  for (std::size_t times = 2; times < 5; ++times) {
    again.points.insert(again.points.end(), once.points.begin(), once.points.end());
    again.normals.insert(again.normals.end(), once.normals.begin(), once.normals.end());
    const auto store = PointStore::build(again.view(), 1);
    ASSERT_TRUE(store);
    ASSERT_EQ(store->size(), expected->size());
    for (std::size_t i = 0; i < store->size(); ++i) {
      ASSERT_EQ(store->position(i), expected->position(i));
      ASSERT_EQ(store->normal(i), expected->normal(i)) << times << " times";
    }
  }
}

TEST(PointStore, RefusesCoordinatesThatNoBoxCanHold) {
  Cloud cloud;  // half of the points at either end: neither are strays
  for (int i = 0; i < 10; ++i) cloud.add(i % 2 == 0 ? 1.7e308 : -1.7e308, 0.1 * i, 0.0);
  const auto store = PointStore::build(cloud.view(), 1);
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <pcl/common/io.h>
#include <pcl/point_cloud.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"

namespace pcl_slim_test {

/** A bumpy sphere of radius 1 with a little noise; normals where the point type has them. */
template <typename PointT>
typename pcl::PointCloud<PointT>::Ptr bumpySphere(std::size_t count, unsigned int seed = 1) {
  auto cloud = std::make_shared<pcl::PointCloud<PointT>>();
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < count; ++i) {
    double n[3] = {normal(random), normal(random), normal(random)};
    const double length = std::hypot(n[0], n[1], n[2]);
    for (double& value : n) value /= length;
    const double r = 1.0 + 0.05 * std::sin(4.0 * n[0]) + 0.001 * normal(random);
    PointT p;
    p.x = static_cast<float>(r * n[0]);
    p.y = static_cast<float>(r * n[1]);
    p.z = static_cast<float>(r * n[2]);
    if constexpr (pcl::traits::has_normal<PointT>::value) {
      p.normal_x = static_cast<float>(n[0]);
      p.normal_y = static_cast<float>(n[1]);
      p.normal_z = static_cast<float>(n[2]);
    }
    cloud->push_back(p);
  }
  return cloud;
}

/** What every class that takes a PCL cloud must survive and keep.
 *
 * Traits adapts one class: Point; Door; static bool run(Door&, std::vector<unsigned char>& output)
 * runs it and gives its output as bytes, whatever they mean, after putting something into the
 * class's own output so that forgetting to clear it shows; static constexpr bool kPrints: whether
 * what is run is a verb of PCL's base class, which prints its errors as PCL's own do.
 */
template <typename Traits>
class DoorSuite : public testing::Test {
 protected:
  using Point = typename Traits::Point;
  using Door = typename Traits::Door;
  using Cloud = pcl::PointCloud<Point>;

  static std::vector<unsigned char> runWell(Door& door) {
    std::vector<unsigned char> output;
    EXPECT_TRUE(Traits::run(door, output)) << door.getError().message;
    EXPECT_FALSE(door.getError());
    EXPECT_FALSE(output.empty());
    return output;
  }

  static void expectFailure(Door& door) {
    std::vector<unsigned char> output;
    testing::internal::CaptureStderr();
    EXPECT_FALSE(Traits::run(door, output));
    const std::string printed = testing::internal::GetCapturedStderr();
    EXPECT_TRUE(output.empty()) << "the output was not cleared";
    EXPECT_TRUE(door.getError());
    const std::string& message = door.getError().message;
    EXPECT_FALSE(message.empty());
    EXPECT_EQ(message.find('\n'), std::string::npos);
    const bool prints = Traits::kPrints && door.getError().code != pcl_slim::ErrorCode::kCancelled;
    EXPECT_EQ(std::count(printed.begin(), printed.end(), '\n'), prints ? 1 : 0) << printed;
    EXPECT_EQ(printed.find(message) != std::string::npos, prints) << printed;
  }

  static Door doorTo(const typename Cloud::ConstPtr& cloud) {
    Door door;
    door.setInputCloud(cloud);
    return door;
  }
};

TYPED_TEST_SUITE_P(DoorSuite);

TYPED_TEST_P(DoorSuite, NoInputIsAnError) {
  typename TestFixture::Door door;
  this->expectFailure(door);
}

TYPED_TEST_P(DoorSuite, NothingToWorkOnIsAnError) {
  auto door = this->doorTo(std::make_shared<typename TestFixture::Cloud>());
  this->expectFailure(door);

  auto cloud = bumpySphere<typename TestFixture::Point>(50);
  for (auto& p : *cloud) p.y = std::numeric_limits<float>::quiet_NaN();
  door.setInputCloud(cloud);
  this->expectFailure(door);

  door.setInputCloud(bumpySphere<typename TestFixture::Point>(50));
  door.setIndices(std::make_shared<pcl::Indices>());
  this->expectFailure(door);
}

TYPED_TEST_P(DoorSuite, BadIndicesAreAnError) {
  auto door = this->doorTo(bumpySphere<typename TestFixture::Point>(100));
  for (const pcl::index_t bad : {-1, 100, std::numeric_limits<pcl::index_t>::max()}) {
    auto indices = std::make_shared<pcl::Indices>(pcl::Indices{0, 1, bad});
    door.setIndices(indices);
    this->expectFailure(door);
  }
}

TYPED_TEST_P(DoorSuite, FewOrEqualPointsDoNotCrash) {
  for (const std::size_t count : {1u, 2u, 3u, 5u}) {
    std::vector<unsigned char> output;
    auto cloud = bumpySphere<typename TestFixture::Point>(count);
    auto door = this->doorTo(cloud);
    TypeParam::run(door, output);
    for (auto& p : *cloud) p = (*cloud)[0];
    TypeParam::run(door, output);
  }
}

TYPED_TEST_P(DoorSuite, IndicesSelectWhatCopyingSelects) {
  const auto cloud = bumpySphere<typename TestFixture::Point>(3000);
  auto indices = std::make_shared<pcl::Indices>();
  for (pcl::index_t i = 0; i < 2500; i += 2) indices->push_back(i);
  auto door = this->doorTo(cloud);
  const auto whole = this->runWell(door);
  door.setIndices(indices);
  const auto selected = this->runWell(door);
  auto copy = std::make_shared<typename TestFixture::Cloud>();
  pcl::copyPointCloud(*cloud, *indices, *copy);
  auto second = this->doorTo(copy);
  EXPECT_EQ(selected, this->runWell(second));
  EXPECT_NE(selected, whole);
}

TYPED_TEST_P(DoorSuite, NonFinitePointsAreLeftOut) {
  const auto clean = bumpySphere<typename TestFixture::Point>(2000);
  auto cloud = std::make_shared<typename TestFixture::Cloud>();
  for (std::size_t i = 0; i < clean->size(); ++i) {
    if (i % 100 == 0) {
      auto p = (*clean)[i];
      (i % 200 == 0 ? p.x : p.z) = i % 300 == 0 ? std::numeric_limits<float>::infinity()
                                                : std::numeric_limits<float>::quiet_NaN();
      cloud->push_back(p);
    }
    cloud->push_back((*clean)[i]);
  }
  cloud->is_dense = true;  // as many writers claim
  auto door = this->doorTo(cloud);
  auto clean_door = this->doorTo(clean);
  EXPECT_EQ(this->runWell(door), this->runWell(clean_door));
}

TYPED_TEST_P(DoorSuite, ThreadsAndRepetitionChangeNothing) {
  auto door = this->doorTo(bumpySphere<typename TestFixture::Point>(4000));
  door.setNumberOfThreads(1);
  const auto first = this->runWell(door);
  EXPECT_EQ(first, this->runWell(door));
  for (const unsigned int threads : {2u, 8u, 0u}) {
    door.setNumberOfThreads(threads);
    EXPECT_EQ(first, this->runWell(door)) << threads << " threads";
  }
}

TYPED_TEST_P(DoorSuite, CopiesStandAlone) {
  auto original = std::make_unique<typename TestFixture::Door>();
  original->setInputCloud(bumpySphere<typename TestFixture::Point>(1000));
  int calls = 0;
  original->setProgressCallback([&calls](float, const char*) { ++calls; });
  const auto expected = this->runWell(*original);
  typename TestFixture::Door copy(*original), assigned;
  assigned = *original;
  original.reset();
  calls = 0;
  EXPECT_EQ(expected, this->runWell(copy));
  EXPECT_GT(calls, 0);
  EXPECT_EQ(expected, this->runWell(assigned));
}

TYPED_TEST_P(DoorSuite, CancelStopsAndTheNextRunWorks) {
  auto door = this->doorTo(bumpySphere<typename TestFixture::Point>(4000));
  door.setProgressCallback([&door](float, const char*) { door.cancel(); });
  this->expectFailure(door);
  EXPECT_EQ(door.getError().code, pcl_slim::ErrorCode::kCancelled);
  door.setProgressCallback({});
  this->runWell(door);
}

TYPED_TEST_P(DoorSuite, CancelBeforeTheRunHoldsOnce) {
  auto door = this->doorTo(bumpySphere<typename TestFixture::Point>(4000));
  door.cancel();
  this->expectFailure(door);
  EXPECT_EQ(door.getError().code, pcl_slim::ErrorCode::kCancelled);
  this->runWell(door);
}

TYPED_TEST_P(DoorSuite, CancelAfterARunIsNotKeptForTheNext) {
  auto door = this->doorTo(bumpySphere<typename TestFixture::Point>(1000));
  const auto expected = this->runWell(door);
  door.cancel();
  EXPECT_EQ(this->runWell(door), expected);
  door.expectRun();
  door.cancel();
  this->expectFailure(door);
  EXPECT_EQ(door.getError().code, pcl_slim::ErrorCode::kCancelled);
  EXPECT_EQ(this->runWell(door), expected);
}

TYPED_TEST_P(DoorSuite, ASensorThatIsNowhereIsNoViewpoint) {
  auto cloud = bumpySphere<typename TestFixture::Point>(1000);
  auto door = this->doorTo(cloud);
  const auto expected = this->runWell(door);
  cloud->sensor_origin_[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(this->runWell(door), expected);
}

TYPED_TEST_P(DoorSuite, AnErrorDoesNotOutliveItsRun) {
  auto door = this->doorTo(std::make_shared<typename TestFixture::Cloud>());
  this->expectFailure(door);
  door.setInputCloud(bumpySphere<typename TestFixture::Point>(500));
  this->runWell(door);
}

REGISTER_TYPED_TEST_SUITE_P(DoorSuite, NoInputIsAnError, NothingToWorkOnIsAnError,
                            BadIndicesAreAnError, FewOrEqualPointsDoNotCrash,
                            IndicesSelectWhatCopyingSelects, NonFinitePointsAreLeftOut,
                            ThreadsAndRepetitionChangeNothing, CopiesStandAlone,
                            CancelStopsAndTheNextRunWorks, CancelBeforeTheRunHoldsOnce,
                            CancelAfterARunIsNotKeptForTheNext, ASensorThatIsNowhereIsNoViewpoint,
                            AnErrorDoesNotOutliveItsRun);

}  // namespace pcl_slim_test

// SPDX-License-Identifier: BSD-3-Clause
// SLIMProjectionSmoother's upsampling methods: how many points come out, where, and whose they are.
#include <gtest/gtest.h>
#include <pcl/surface/impl/mls.hpp>  // from PCL 1.15 on, its library has few pairs of types

#include <algorithm>
#include <cmath>
#include <random>

#include "exact_clouds.h"
#include "pcl_slim/filters/slim_projection_smoother.h"

namespace pcl_slim {
namespace {

using NumberedCloud = pcl::PointCloud<pcl::PointXYZI>;
using NumberedNormals = pcl::PointCloud<pcl::PointXYZINormal>;
using NumberedMls = pcl::MovingLeastSquares<pcl::PointXYZI, pcl::PointXYZINormal>;
using NumberedSlim = SLIMProjectionSmoother<pcl::PointXYZI, pcl::PointXYZINormal>;

/** The unit sphere with noise of .002, without what is above z = top; intensity is the index. */
NumberedCloud::Ptr sphere(std::size_t count, double top = 2.0) {
  const auto cloud = pcl_slim_test::noisySphere<pcl::PointXYZI>(count, 1.0, 0.002, top);
  for (std::size_t i = 0; i < cloud->size(); ++i) (*cloud)[i].intensity = static_cast<float>(i);
  return cloud;
}

/** Points are on the sphere, normals are unit and radial, fields are those of the points named. */
void expectOnSphere(const NumberedSlim& slim, const NumberedNormals& made, double tolerance) {
  const pcl::Indices& source = slim.getCorrespondingIndices()->indices;
  ASSERT_EQ(source.size(), made.size());
  EXPECT_EQ(made.height, 1u);
  EXPECT_TRUE(made.is_dense);
  for (std::size_t i = 0; i < made.size(); ++i) {
    const auto& p = made[i];
    ASSERT_NEAR(std::hypot(p.x, p.y, p.z), 1, tolerance) << i;
    ASSERT_GT(std::abs(p.normal_x * p.x + p.normal_y * p.y + p.normal_z * p.z), 0.99) << i;
    ASSERT_EQ(p.intensity, static_cast<float>(source[i]));
  }
}

double distance(const pcl::PointXYZINormal& a, const pcl::PointXYZI& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

TEST(Upsampling, NoneGivesTheIndicesAskedFor) {
  NumberedSlim slim;
  slim.setInputCloud(sphere(2000));
  slim.setIndices(std::make_shared<pcl::Indices>([] {
    pcl::Indices odd;
    for (int i = 1; i < 2000; i += 2) odd.push_back(i);
    return odd;
  }()));
  NumberedNormals made;
  slim.process(made);
  ASSERT_EQ(slim.getCorrespondingIndices()->indices.size(), 1000u);
  EXPECT_EQ(slim.getCorrespondingIndices()->indices[7], 15);
}

TEST(Upsampling, LocalPlanesAreSampledAsMlsSamplesThem) {
  const auto cloud = sphere(1500);
  const auto run = [&](auto& smoother) {
    smoother.setInputCloud(cloud);
    smoother.setComputeNormals(true);
    smoother.setSearchRadius(0.2);
    smoother.setUpsamplingMethod(std::decay_t<decltype(smoother)>::SAMPLE_LOCAL_PLANE);
    smoother.setUpsamplingRadius(0.06);
    smoother.setUpsamplingStepSize(0.025);
    NumberedNormals made;
    smoother.process(made);
    return made;
  };
  NumberedMls mls;
  NumberedSlim slim;
  const NumberedNormals theirs = run(mls), ours = run(slim);
  EXPECT_EQ(ours.size(), theirs.size());
  expectOnSphere(slim, ours, 0.004);
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const auto from = static_cast<std::size_t>(slim.getCorrespondingIndices()->indices[i]);
    ASSERT_LT(distance(ours[i], (*cloud)[from]), 0.06 + 0.01);
  }
}

TEST(Upsampling, RandomSamplesMeetTheDensityAndRepeat) {
  const auto cloud = sphere(1500);
  const auto run = [&](auto& smoother) {
    smoother.setInputCloud(cloud);
    smoother.setComputeNormals(true);
    smoother.setSearchRadius(0.2);
    smoother.setUpsamplingMethod(std::decay_t<decltype(smoother)>::RANDOM_UNIFORM_DENSITY);
    smoother.setPointDensity(150);
    NumberedNormals made;
    smoother.process(made);
    return made;
  };
  NumberedMls mls;
  NumberedSlim slim;
  const NumberedNormals theirs = run(mls), ours = run(slim);
  EXPECT_EQ(ours.size(), theirs.size());
  EXPECT_GT(ours.size(), 3 * cloud->size());
  expectOnSphere(slim, ours, 0.004);
  NumberedSlim again;
  again.setNumberOfThreads(1);
  const NumberedNormals repeated = run(again);
  ASSERT_EQ(repeated.size(), ours.size());
  for (std::size_t i = 0; i < ours.size(); ++i) ASSERT_EQ(repeated[i].x, ours[i].x);
}

TEST(Upsampling, VoxelsAreThoseOfMlsAndFillAHole) {
  const auto cloud = sphere(6000, 0.97);
  const auto run = [&](auto& smoother, int dilations) {
    smoother.setInputCloud(cloud);
    smoother.setComputeNormals(true);
    smoother.setSearchRadius(0.25);
    smoother.setUpsamplingMethod(std::decay_t<decltype(smoother)>::VOXEL_GRID_DILATION);
    smoother.setDilationVoxelSize(0.05f);
    smoother.setDilationIterations(dilations);
    NumberedNormals made;
    smoother.process(made);
    return made;
  };
  NumberedMls mls;
  NumberedSlim slim;
  const NumberedNormals theirs = run(mls, 0), ours = run(slim, 0);
  // Voxels at the edge of one are counted by rounding.
  EXPECT_NEAR(static_cast<double>(ours.size()), static_cast<double>(theirs.size()), 20);
  expectOnSphere(slim, ours, 0.01);
  const auto inHole = [](const NumberedNormals& points) {
    return std::count_if(points.begin(), points.end(), [](const auto& p) { return p.z > 0.98f; });
  };
  EXPECT_LT(inHole(ours), 5);
  const NumberedNormals wide = run(slim, 2);
  EXPECT_GT(wide.size(), ours.size());
  EXPECT_GT(inHole(wide), 20);
}

TEST(Upsampling, ADistinctCloudTakesTheNearestPointsFields) {
  const auto cloud = sphere(4000);
  auto distinct = std::make_shared<NumberedCloud>();
  for (int i = 0; i < 500; ++i) {
    pcl::PointXYZI p = (*cloud)[static_cast<std::size_t>(8 * i)];
    for (float& c : {std::ref(p.x), std::ref(p.y), std::ref(p.z)}) c *= 1.01f;
    p.intensity = -1.0f;
    distinct->push_back(p);
  }
  (*distinct)[3].x = std::numeric_limits<float>::quiet_NaN();
  (*distinct)[4].x = 50.0f;  // nothing of the surface is there
  NumberedSlim slim;
  slim.setInputCloud(cloud);
  slim.setUpsamplingMethod(NumberedSlim::DISTINCT_CLOUD);
  NumberedNormals made;
  testing::internal::CaptureStderr();
  slim.process(made);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("setDistinctCloud"), std::string::npos);
  EXPECT_TRUE(made.empty());
  slim.setDistinctCloud(distinct);
  slim.process(made);
  ASSERT_EQ(made.size(), 498u);
  expectOnSphere(slim, made, 0.004);
  for (std::size_t i = 0; i < made.size(); i += 50) {
    const auto from = static_cast<std::size_t>(slim.getCorrespondingIndices()->indices[i]);
    for (const auto& p : *cloud)
      ASSERT_GE(distance(made[i], p) + 0.012, distance(made[i], (*cloud)[from]));
  }
}

TEST(Upsampling, ParametersOutOfRangeAreNamed) {
  NumberedSlim slim;
  slim.setInputCloud(sphere(200));
  const auto expect = [&](const char* words) {
    NumberedNormals made(3, 1);
    testing::internal::CaptureStderr();
    slim.process(made);
    testing::internal::GetCapturedStderr();
    EXPECT_TRUE(made.empty());
    EXPECT_NE(slim.getError().message.find(words), std::string::npos) << slim.getError().message;
  };
  slim.setUpsamplingMethod(NumberedSlim::SAMPLE_LOCAL_PLANE);
  expect("upsampling radius");
  slim.setUpsamplingRadius(1.0);
  expect("upsampling step");
  slim.setUpsamplingStepSize(1e-9);
  expect("too small");
  slim.setUpsamplingMethod(NumberedSlim::RANDOM_UNIFORM_DENSITY);
  expect("search radius");
  slim.setSearchRadius(0.1);
  expect("density");
  slim.setUpsamplingMethod(NumberedSlim::VOXEL_GRID_DILATION);
  slim.setDilationVoxelSize(1e-9f);
  expect("two million voxels");
  slim.setDilationVoxelSize(-1.0f);
  expect("voxel size");
  slim.setDilationVoxelSize(0.1f);
  slim.setDilationIterations(-1);
  expect("iterations");
  slim.setSearchRadius(-1.0);
  expect("search radius");
}

}  // namespace
}  // namespace pcl_slim

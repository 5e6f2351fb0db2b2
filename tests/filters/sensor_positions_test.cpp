// SPDX-License-Identifier: BSD-3-Clause
// Where each point was seen from and which frame it is from, in the classes that take PCL clouds.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pcl_slim/filters/impl/color_octree_splat_sampler.hpp"
#include "pcl_slim/filters/slim_curvature_estimation.h"
#include "pcl_slim/filters/slim_fit.h"
#include "pcl_slim/filters/slim_projection_smoother.h"
#include "pcl_slim/filters/slim_reconstruction.h"

namespace {

using namespace pcl_slim;

/** A sphere of radius 1 seen from inside, each point from half way to the middle. */
template <typename PointT>
typename pcl::PointCloud<PointT>::Ptr hollowSphere(int count,
                                                   std::vector<Eigen::Vector3d>& sensors) {
  auto cloud = std::make_shared<pcl::PointCloud<PointT>>();
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, turn = 2.399963229728653 * i,
                 r = std::sqrt(1 - z * z);
    PointT point;
    point.x = static_cast<float>(r * std::cos(turn));
    point.y = static_cast<float>(r * std::sin(turn));
    point.z = static_cast<float>(z);
    cloud->push_back(point);
    sensors.emplace_back(0.5 * point.x, 0.5 * point.y, 0.5 * point.z);
  }
  return cloud;
}

template <typename PointT>
std::size_t numOutward(const pcl::PointCloud<PointT>& cloud) {
  std::size_t outward = 0;
  for (const PointT& p : cloud)
    outward += p.x * p.normal_x + p.y * p.normal_y + p.z * p.normal_z > 0;
  return outward;
}

TEST(SensorPositions, DecideTheSidesInEveryClassThatFits) {
  std::vector<Eigen::Vector3d> sensors;
  const auto cloud = hollowSphere<pcl::PointXYZ>(4000, sensors);

  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(cloud);
  SLIMSurface surface;
  ASSERT_TRUE(fit.fit(surface));
  EXPECT_EQ(fit.getStatistics().sides.source, SideSource::kOutward);
  fit.setSensorPositions(sensors);
  pcl::PointCloud<PointSLIM> surfels;
  ASSERT_TRUE(fit.fit(surfels)) << fit.getError().message;
  EXPECT_EQ(fit.getStatistics().sides.source, SideSource::kSensors);
  EXPECT_GT(fit.getStatistics().sides.overlap_edges, 0u);
  EXPECT_EQ(numOutward(surfels), 0u);

  SLIMProjectionSmoother<pcl::PointXYZ, pcl::PointNormal> smoother;
  smoother.setInputCloud(cloud);
  smoother.setComputeNormals(true);
  pcl::PointCloud<pcl::PointNormal> smooth;
  smoother.process(smooth);
  EXPECT_EQ(numOutward(smooth), 4000u);
  smoother.setSensorPositions(sensors);
  smoother.process(smooth);
  EXPECT_EQ(numOutward(smooth), 0u);
  smoother.clearSensorPositions();
  smoother.process(smooth);
  EXPECT_EQ(numOutward(smooth), 4000u);

  SLIMCurvatureEstimation<pcl::PointXYZ, PointCurvature> curvature;
  curvature.setInputCloud(cloud);
  curvature.setSensorPositions(sensors);
  pcl::PointCloud<PointCurvature> bent;
  curvature.compute(bent);
  ASSERT_EQ(bent.size(), 4000u) << curvature.getError().message;
  // Hollow from where it was seen.
  for (const auto& p : bent) ASSERT_NEAR(p.mean_curvature, -1, 0.1);

  SLIMReconstruction<pcl::PointXYZ> mesh;
  mesh.setInputCloud(cloud);
  mesh.setSensorPositions(sensors);
  pcl::PolygonMesh made;
  mesh.reconstruct(made);
  EXPECT_FALSE(made.polygons.empty()) << mesh.getError().message;
  EXPECT_EQ(mesh.getStatistics().sides.source, SideSource::kSensors);
}

TEST(SensorPositions, TurnEstimatedNormals) {
  std::vector<Eigen::Vector3d> sensors;
  const auto cloud = hollowSphere<pcl::PointXYZ>(3000, sensors);
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(cloud);
  fit.setNormalEstimationNeighbors(12);
  fit.setSensorPositions(sensors);
  pcl::PointCloud<PointSLIM> surfels;
  ASSERT_TRUE(fit.fit(surfels)) << fit.getError().message;
  EXPECT_EQ(fit.getStatistics().sides.source, SideSource::kNormals);
  EXPECT_EQ(numOutward(surfels), 0u);
}

TEST(SensorPositions, BelongToPointsNotToIndices) {
  std::vector<Eigen::Vector3d> sensors;
  const auto cloud = hollowSphere<pcl::PointXYZ>(6000, sensors);
  // The other half of the points is seen from outside: those of the indices are not.
  auto indices = std::make_shared<pcl::Indices>();
  for (int i = 5999; i >= 0; --i) {
    if (i % 2 == 0)
      indices->push_back(i);
    else
      sensors[static_cast<std::size_t>(i)] *= 6;
  }
  for (const int i : {1, 7, 4000}) (*cloud)[static_cast<std::size_t>(i)].x = std::nanf("");
  for (const int i : {100, 4002}) {
    (*cloud)[static_cast<std::size_t>(i)].x = std::nanf("");
    sensors[static_cast<std::size_t>(i)].setConstant(std::nan(""));
  }
  cloud->is_dense = false;
  SLIMProjectionSmoother<pcl::PointXYZ, pcl::PointNormal> smoother;
  smoother.setInputCloud(cloud);
  smoother.setIndices(indices);
  smoother.setComputeNormals(true);
  smoother.setSensorPositions(sensors);
  pcl::PointCloud<pcl::PointNormal> smooth;
  smoother.process(smooth);
  ASSERT_EQ(smooth.size(), 3000u) << smoother.getError().message;
  EXPECT_EQ(numOutward(smooth), 0u);
}

TEST(SensorPositions, OfAnOrganizedCloudComeBeforeItsOnlySensor) {
  // Two cameras look at a sheet from both sides; their frames stand side by side in one cloud.
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>(120, 60);
  std::vector<Eigen::Vector3d> sensors;
  for (int row = 0; row < 60; ++row) {
    for (int column = 0; column < 120; ++column) {
      const bool second = column >= 60;
      auto& p = cloud->at(column, row);
      p.x = 0.01f * static_cast<float>(column % 60) + (second ? 1.0f : 0.0f);
      p.y = 0.01f * static_cast<float>(row);
      p.z = 1 + 0.02f * std::sin(12 * p.x);
      if ((row + column) % 17 == 0) p.z = std::nanf("");
      sensors.emplace_back(p.x, p.y, second ? 3.0 : 0.0);
    }
  }
  cloud->is_dense = false;
  SLIMProjectionSmoother<pcl::PointXYZ, pcl::PointNormal> smoother;
  smoother.setInputCloud(cloud);
  smoother.setComputeNormals(true);
  pcl::PointCloud<pcl::PointNormal> smooth;
  const auto check = [&](bool own) {
    smoother.process(smooth);
    ASSERT_EQ(smooth.width, 120u) << smoother.getError().message;
    for (std::uint32_t column = 0; column < 120; ++column) {
      const auto& p = smooth.at(column, 30);
      if (!std::isfinite(p.z)) continue;
      const bool up = own && column >= 60;
      ASSERT_EQ(p.normal_z > 0, up) << column;
    }
  };
  check(false);
  smoother.setSensorPositions(sensors);
  check(true);
}

TEST(SensorPositions, ComeFromFieldsOfThePointType) {
  std::vector<Eigen::Vector3d> sensors;
  const auto cloud = hollowSphere<pcl::PointWithViewpoint>(3000, sensors);
  SLIMFit<pcl::PointWithViewpoint> fit;
  fit.setInputCloud(cloud);
  SLIMSurface surface;
  ASSERT_TRUE(fit.fit(surface));
  EXPECT_EQ(fit.getStatistics().sides.source, SideSource::kOutward) << "all zero: unknown";
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    (*cloud)[i].vp_x = static_cast<float>(sensors[i][0]);
    (*cloud)[i].vp_y = static_cast<float>(sensors[i][1]);
    (*cloud)[i].vp_z = static_cast<float>(sensors[i][2]);
  }
  pcl::PointCloud<PointSLIM> surfels;
  ASSERT_TRUE(fit.fit(surfels));
  EXPECT_EQ(fit.getStatistics().sides.source, SideSource::kSensors);
  EXPECT_EQ(numOutward(surfels), 0u);
  fit.setSensorPosition(0, 0, 0.1);
  ASSERT_TRUE(fit.fit(surface));
  EXPECT_EQ(fit.getStatistics().sides.source, SideSource::kViewpoint);

  ColorOctreeSplatSampler<pcl::PointWithViewpoint> sampler;
  sampler.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointSurfel> splats;
  ASSERT_TRUE(sampler.sample(splats)) << sampler.getError().message;
  EXPECT_EQ(numOutward(splats), 0u);
}

/** A number of frames of a wavy sheet, with errors that 5 x 5 points of a frame share. */
pcl::PointCloud<pcl::PointXYZ>::Ptr wavyFrames(std::uint32_t count,
                                               std::vector<std::uint32_t>& numbers) {
  constexpr int kSide = 120, kShared = 5, kWide = kSide + kShared;
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, 0.004 / kShared);
  for (std::uint32_t frame = 0; frame < count; ++frame) {
    std::vector<double> errors(kWide * kWide);
    for (double& e : errors) e = normal(random);
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        double error = 0;
        for (int k = 0; k < kShared * kShared; ++k)
          error += errors[static_cast<std::size_t>((y + k / kShared) * kWide + x + k % kShared)];
        const double z = 0.05 * std::sin(0.06 * x) * std::cos(0.05 * y) + error;
        cloud->push_back(
            {0.01f * static_cast<float>(x), 0.01f * static_cast<float>(y), static_cast<float>(z)});
        numbers.push_back(frame);
      }
    }
  }
  return cloud;
}

TEST(FrameNumbers, SeparateTheNoiseOfFramesInEveryClassThatFits) {
  std::vector<std::uint32_t> numbers;
  const auto cloud = wavyFrames(2, numbers);
  const auto check = [&](auto& object, const auto& run) {
    object.setInputCloud(cloud);
    run();
    EXPECT_EQ(object.getStatistics().noise.frames, 0U);
    object.setFrameNumbers(numbers);
    run();
    EXPECT_EQ(object.getStatistics().noise.frames, 2U);
    EXPECT_NEAR(object.getStatistics().noise.correlation, 20, 4);
    object.clearFrameNumbers();
    run();
    EXPECT_EQ(object.getStatistics().noise.frames, 0U);
  };
  SLIMFit<pcl::PointXYZ> fit;
  SLIMSurface surface;
  check(fit, [&] { ASSERT_TRUE(fit.fit(surface)) << fit.getError().message; });
  SLIMProjectionSmoother<pcl::PointXYZ, pcl::PointNormal> smoother;
  pcl::PointCloud<pcl::PointNormal> smooth;
  check(smoother, [&] { smoother.process(smooth); });
  SLIMCurvatureEstimation<pcl::PointXYZ, PointCurvature> curvature;
  pcl::PointCloud<PointCurvature> bent;
  check(curvature, [&] { curvature.compute(bent); });
  SLIMReconstruction<pcl::PointXYZ> mesh;
  pcl::PolygonMesh made;
  check(mesh, [&] { mesh.reconstruct(made); });
}

TEST(FrameNumbers, BelongToPointsNotToIndices) {
  std::vector<std::uint32_t> numbers;
  const auto cloud = wavyFrames(2, numbers);
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(cloud);
  fit.setFrameNumbers(numbers);
  auto indices = std::make_shared<pcl::Indices>();
  for (int i = static_cast<int>(cloud->size()) - 1; i >= 0; --i) {
    if (numbers[static_cast<std::size_t>(i)] == 1) indices->push_back(i);
  }
  fit.setIndices(indices);
  SLIMSurface surface;
  ASSERT_TRUE(fit.fit(surface)) << fit.getError().message;
  EXPECT_EQ(fit.getStatistics().noise.frames, 0U) << "all of one frame";
}

TEST(FrameNumbers, AreRefusedWhereTheyDoNotFit) {
  std::vector<std::uint32_t> numbers;
  const auto cloud = wavyFrames(1, numbers);
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(cloud);
  SLIMSurface surface;
  fit.setFrameNumbers({1, 2, 3});
  EXPECT_FALSE(fit.fit(surface));
  EXPECT_NE(fit.getError().message.find("3 frame numbers for 14400 points"), std::string::npos)
      << fit.getError().message;
  fit.setFrameNumbers({});
  EXPECT_TRUE(fit.fit(surface)) << "an empty vector is none";
}

TEST(SensorPositions, AreRefusedWhereTheyDoNotFit) {
  std::vector<Eigen::Vector3d> sensors;
  const auto cloud = hollowSphere<pcl::PointXYZ>(500, sensors);
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(cloud);
  SLIMSurface surface;
  const auto refused = [&](const char* why) {
    EXPECT_FALSE(fit.fit(surface));
    EXPECT_TRUE(surface.empty());
    EXPECT_NE(fit.getError().message.find(why), std::string::npos) << fit.getError().message;
  };
  fit.setSensorPositions({sensors.begin(), sensors.end() - 1});
  refused("499 sensor positions for 500 points");
  fit.setSensorPositions(sensors);
  fit.params().viewpoint = {0, 0, 5};
  refused("clear one of them");
  fit.clearViewPoint();
  EXPECT_TRUE(fit.fit(surface)) << fit.getError().message;
  sensors[3][1] = HUGE_VAL;
  fit.setSensorPositions(sensors);
  refused("point 3");
  fit.setSensorPositions({});
  EXPECT_TRUE(fit.fit(surface)) << "an empty vector is none";
}

}  // namespace

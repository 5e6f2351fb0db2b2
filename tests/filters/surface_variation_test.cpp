// SPDX-License-Identifier: BSD-3-Clause
// PCL's field curvature: the surface variation that pcl::NormalEstimation finds in the output; and
// normals of points that no surface supports.
#include <gtest/gtest.h>
#include <pcl/features/normal_3d.h>

#include <cmath>
#include <random>

#include "exact_clouds.h"
#include "pcl_slim/filters/color_octree_splat_sampler.h"
#include "pcl_slim/filters/slim_curvature_estimation.h"
#include "pcl_slim/filters/slim_projection_smoother.h"
#include "pcl_slim/filters/slim_reconstruction.h"

namespace pcl_slim_test {

/** A point with a field for every curvature. */
struct EIGEN_ALIGN16 BentNormal {
  PCL_ADD_POINT4D
  PCL_ADD_NORMAL4D
  float curvature = 0, mean_curvature = 0, gaussian_curvature = 0, k1 = 0, k2 = 0;
  PCL_MAKE_ALIGNED_OPERATOR_NEW
};

}  // namespace pcl_slim_test

// clang-format off
POINT_CLOUD_REGISTER_POINT_STRUCT(
    pcl_slim_test::BentNormal,
    (float, x, x)(float, y, y)(float, z, z)
    (float, normal_x, normal_x)(float, normal_y, normal_y)(float, normal_z, normal_z)
    (float, curvature, curvature)(float, mean_curvature, mean_curvature)
    (float, gaussian_curvature, gaussian_curvature)(float, k1, k1)(float, k2, k2))
// clang-format on

#include "pcl_slim/filters/impl/slim_projection_smoother.hpp"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using Normals = pcl::PointCloud<pcl::PointNormal>;
using Slim = SLIMProjectionSmoother<pcl::PointXYZ, pcl::PointNormal>;

/** The means over a cloud of its field curvature and of what pcl::NormalEstimation finds in it. */
template <typename PointT>
void expectThatOfPcl(const pcl::PointCloud<PointT>& cloud, double tolerance) {
  pcl::NormalEstimation<PointT, pcl::Normal> estimation;
  estimation.setInputCloud(cloud.makeShared());
  estimation.setKSearch(30);
  pcl::PointCloud<pcl::Normal> estimated;
  estimation.compute(estimated);
  double ours = 0, theirs = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    ASSERT_GE(cloud[i].curvature, 0.0f);
    ASSERT_LE(cloud[i].curvature, 0.3334f);
    ours += cloud[i].curvature;
    theirs += estimated[i].curvature;
  }
  EXPECT_GT(theirs, 0);
  EXPECT_NEAR(ours, theirs, tolerance * theirs);
}

Normals smoothed(const pcl::PointCloud<pcl::PointXYZ>::ConstPtr& cloud) {
  Slim smoother;
  smoother.setInputCloud(cloud);
  Normals out;
  smoother.process(out);
  EXPECT_FALSE(smoother.getError()) << smoother.getError().message;
  return out;
}

// Balls with about 30 points in them have 30 within sqrt(30 / 30) = 18 %, each; their mean is
// within 3 %, which is what the radius that follows the density costs.
constexpr double kOfPcl = 0.04;

TEST(SurfaceVariation, IsThatOfNormalEstimationOnTheOutput) {
  const Normals sphere = smoothed(sphereCloud<pcl::PointXYZ>(20000, 1.0, 0.002));
  expectThatOfPcl(sphere, kOfPcl);
  expectThatOfPcl(smoothed(torusCloud<pcl::PointXYZ>(20000, 0.002)), kOfPcl);
  // 30 of 20000 points fill a disc of radius r of the unit sphere: r^2 = 4 * 30 / 20000.
  double mean = 0;
  for (const auto& p : sphere) mean += p.curvature / 20000;
  EXPECT_NEAR(mean, 0.006 / 24, kOfPcl * 0.006 / 24);
}

TEST(SurfaceVariation, RisesAtEdges) {
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  std::mt19937 random(3);
  std::uniform_real_distribution<float> share;
  for (int i = 0; i < 20000; ++i) {
    const float a = share(random), b = share(random);
    cloud->push_back(i % 2 ? pcl::PointXYZ(a, b, 0) : pcl::PointXYZ(0, b, a));
  }
  const float r = std::sqrt(30.0f / (3.14f * 10000));  // of a disc with 30 points
  double edge = 0, face = 0, at_edge = 0, on_face = 0;
  for (const auto& p : smoothed(cloud)) {
    if (p.x + p.z > 3 * r && p.x + p.z < 0.9f) face += p.curvature, on_face += 1;
    if (p.x + p.z < 0.2f * r && p.y > 0.1f && p.y < 0.9f) edge += p.curvature, at_edge += 1;
  }
  EXPECT_LT(face / on_face, 1e-3);
  EXPECT_GT(edge / at_edge, 0.04);
}

TEST(SurfaceVariation, OursAreInFieldsOfTheirOwn) {
  SLIMProjectionSmoother<pcl::PointXYZ, BentNormal> smoother;
  smoother.setInputCloud(sphereCloud<pcl::PointXYZ>(8000, 2.0, 0.0));
  pcl::PointCloud<BentNormal> out;
  smoother.process(out);
  ASSERT_EQ(out.size(), 8000u);
  for (const BentNormal& p : out) {
    ASSERT_NEAR(p.mean_curvature, 0.5, 0.02);
    ASSERT_NEAR(p.gaussian_curvature, 0.25, 0.02);
    ASSERT_NEAR(p.k1, 0.5, 0.05);
    ASSERT_NEAR(p.k2, 0.5, 0.05);
    ASSERT_LT(p.curvature, 0.002f);
  }
}

TEST(SurfaceVariation, IsWrittenByEveryClassThatFillsTheField) {
  const auto cloud = sphereCloud<pcl::PointXYZ>(8000, 1.0, 0.001);
  Slim smoother;
  smoother.setInputCloud(cloud);
  smoother.setUpsamplingMethod(Slim::VOXEL_GRID_DILATION);
  smoother.setDilationVoxelSize(0.03f);
  smoother.setDilationIterations(1);
  Normals dense;
  smoother.process(dense);
  ASSERT_GT(dense.size(), 8000u);
  expectThatOfPcl(dense, kOfPcl);

  SLIMCurvatureEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setInputCloud(cloud);
  pcl::PointCloud<pcl::Normal> curvature;
  ASSERT_TRUE(estimation.compute(curvature));
  const Normals moved = smoothed(cloud);
  for (std::size_t i = 0; i < moved.size(); ++i)
    ASSERT_EQ(curvature[i].curvature, moved[i].curvature);

  SLIMReconstruction<pcl::PointNormal> reconstruction;
  reconstruction.setInputCloud(sphereCloud<pcl::PointNormal>(8000, 1.0, 0.001));
  Normals vertices;
  std::vector<pcl::Vertices> polygons;
  reconstruction.reconstruct(vertices, polygons);
  ASSERT_GT(vertices.size(), 100u);
  expectThatOfPcl(vertices, 0.1);  // vertices are on a grid, so that few have 30 within a ball

  ColorOctreeSplatSampler<pcl::PointXYZ> sampler;
  sampler.setInputCloud(sphereCloud<pcl::PointXYZ>(60000, 1.0, 0.001));
  pcl::PointCloud<pcl::PointSurfel> splats;
  ASSERT_TRUE(sampler.sample(splats));
  ASSERT_GT(splats.size(), 500u);
  expectThatOfPcl(splats, 0.1);
}

TEST(UnsupportedPoints, HaveTheNormalsOfTheirNeighbours) {
  // A plane seen from above, and single points over it that are no surface.
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  std::mt19937 random(5);
  std::uniform_real_distribution<float> share(-1, 1);
  std::normal_distribution<float> noise(0, 0.002f);
  for (int i = 0; i < 6000; ++i) cloud->push_back({share(random), share(random), noise(random)});
  const std::size_t plane = cloud->size();
  for (int i = 0; i < 4; ++i) cloud->push_back({0.7f * static_cast<float>(i), 0.5f, 2.5f});
  cloud->push_back({std::nanf(""), 0, 0});
  cloud->is_dense = false;
  Slim smoother;
  smoother.setInputCloud(cloud);
  smoother.setViewPoint(0, 0, 5);
  Normals out;
  smoother.process(out);
  ASSERT_EQ(out.size(), plane + 5);
  ASSERT_GE(smoother.getUnsupported().size(), 4u);
  for (const pcl::index_t i : smoother.getUnsupported()) {
    const auto& p = out[static_cast<std::size_t>(i)];
    ASSERT_NEAR(p.getNormalVector3fMap().norm(), 1.0f, 1e-5f);
    const Eigen::Vector3f ray = Eigen::Vector3f(0, 0, 5) - p.getVector3fMap();
    EXPECT_GE(p.getNormalVector3fMap().dot(ray), 0.0f) << "faces the viewpoint";
    EXPECT_TRUE(p.curvature >= 0.0f && p.curvature <= 0.3334f);
  }
  EXPECT_TRUE(std::isnan(out.back().normal_x) && std::isnan(out.back().curvature));
  EXPECT_FALSE(out.is_dense);

  auto normals = std::make_shared<pcl::PointCloud<pcl::Normal>>();
  normals->resize(cloud->size());
  for (auto& n : *normals) n.getNormalVector3fMap() = Eigen::Vector3f(0.6f, 0, -0.8f);
  smoother.clearViewPoint();
  smoother.setInputNormals(normals);
  smoother.process(out);
  for (const pcl::index_t i : smoother.getUnsupported())
    EXPECT_NEAR(out[static_cast<std::size_t>(i)].normal_z, -0.8f, 1e-6f) << "the input's own";
}

}  // namespace
}  // namespace pcl_slim

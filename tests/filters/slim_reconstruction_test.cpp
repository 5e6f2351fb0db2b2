// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/slim_reconstruction.h"

#include <gtest/gtest.h>
#include <pcl/conversions.h>

#include <cmath>
#include <cstring>
#include <memory>

#include "door_suite.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/filters/slim_fit.h"

namespace {

using namespace pcl_slim;
using pcl_slim_test::bumpySphere;

template <typename PointT>
struct ReconstructionTraits {
  using Point = PointT;
  using Door = SLIMReconstruction<PointT>;
  static constexpr bool kPrints = true;

  static bool run(Door& door, std::vector<unsigned char>& output) {
    pcl::PolygonMesh mesh;
    mesh.cloud.width = 3;
    mesh.polygons.resize(2);
    door.reconstruct(mesh);
    output.assign(mesh.cloud.data.begin(), mesh.cloud.data.end());
    for (const auto& polygon : mesh.polygons) {
      for (const auto v : polygon.vertices) {
        const auto* bytes = reinterpret_cast<const unsigned char*>(&v);
        output.insert(output.end(), bytes, bytes + sizeof(v));
      }
    }
    EXPECT_EQ(static_cast<bool>(door.getError()), mesh.polygons.empty());
    return !door.getError();
  }
};

TEST(SLIMReconstruction, SharpFeaturesGiveACubeItsCorners) {
  pcl::PointCloud<pcl::PointNormal>::Ptr cloud(new pcl::PointCloud<pcl::PointNormal>);
  for (int i = 0; i < 6000; ++i) {
    float p[3], n[3] = {};
    const int face = i % 3, side = i % 2 == 0 ? 1 : -1;
    p[face] = n[face] = static_cast<float>(side);
    p[(face + 1) % 3] = static_cast<float>(2 * std::fmod(i * 0.7548776662, 1.0) - 1);
    p[(face + 2) % 3] = static_cast<float>(2 * std::fmod(i * 0.5698402909, 1.0) - 1);
    cloud->emplace_back(p[0], p[1], p[2], n[0], n[1], n[2]);
  }
  SLIMReconstruction<pcl::PointNormal> reconstruction;
  reconstruction.setInputCloud(cloud);
  reconstruction.setSharpFeatures(true);
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  EXPECT_EQ(reconstruction.getMeshStatistics().census.euler, 2);
  EXPECT_GE(reconstruction.getMeshStatistics().corner_vertices, 8u);
  double nearest = 1e9;
  for (const Vector3& p : reconstruction.getMesh().vertices)
    nearest = std::min(nearest, length(subtract(p, {1, 1, 1})));
  EXPECT_LT(nearest, 0.01);
}

TEST(SLIMReconstruction, StandsWherePoissonStands) {
  const auto cloud = bumpySphere<pcl::PointNormal>(5000);
  cloud->header.frame_id = "scanner";
  // As a caller of pcl::Poisson would have it, through the base class.
  const pcl::SurfaceReconstruction<pcl::PointNormal>::Ptr reconstruction(
      new SLIMReconstruction<pcl::PointNormal>);
  reconstruction->setInputCloud(cloud);
  pcl::PolygonMesh mesh;
  reconstruction->reconstruct(mesh);
  EXPECT_GT(mesh.polygons.size(), 1000u);
  EXPECT_EQ(mesh.header.frame_id, "scanner");
  EXPECT_EQ(mesh.cloud.header.frame_id, "scanner");
  pcl::PointCloud<pcl::PointNormal> points;
  pcl::fromPCLPointCloud2(mesh.cloud, points);
  for (const auto& p : points) {
    EXPECT_NEAR(p.getVector3fMap().norm(), 1, 0.07);
    EXPECT_GT(p.getVector3fMap().dot(p.getNormalVector3fMap()), 0);
  }

  pcl::PointCloud<pcl::PointNormal> again;
  std::vector<pcl::Vertices> polygons;
  reconstruction->reconstruct(again, polygons);
  ASSERT_EQ(polygons.size(), mesh.polygons.size());
  ASSERT_EQ(again.size(), points.size());
  EXPECT_EQ(again.width, again.size());
  EXPECT_EQ(again.height, 1u);
  EXPECT_EQ(polygons.back().vertices, mesh.polygons.back().vertices);
  EXPECT_EQ(again.back().x, points.back().x);
}

TEST(SLIMReconstruction, IsClosedAndFollowsItsSetters) {
  SLIMReconstruction<pcl::PointXYZ> reconstruction;
  reconstruction.setInputCloud(bumpySphere<pcl::PointXYZ>(5000));
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  ASSERT_FALSE(reconstruction.getError());
  EXPECT_EQ(reconstruction.getMeshStatistics().census.euler, 2);
  EXPECT_EQ(reconstruction.getMeshStatistics().census.border_edges, 0u);
  EXPECT_GT(reconstruction.getStatistics().leaves, 0u);
  EXPECT_EQ(findField(mesh.cloud, "k1"), -1);
  const std::size_t by_default = mesh.polygons.size();

  // From the surface fitted before, coarser and with curvatures.
  SLIMReconstruction<pcl::PointXYZ> coarse;
  coarse.setInputCloud(reconstruction.getInputCloud());
  coarse.setSurface(reconstruction.getFittedSurface());
  coarse.setTolerance(0.02);
  coarse.setComputeCurvature(true);
  coarse.reconstruct(mesh);
  ASSERT_FALSE(coarse.getError());
  EXPECT_LT(mesh.polygons.size(), by_default);
  EXPECT_GE(findField(mesh.cloud, "k1"), 0);
  EXPECT_EQ(coarse.getFittedSurface(), nullptr);
  EXPECT_EQ(coarse.getMesh().triangles.size(), mesh.polygons.size());

  coarse.setTolerance(-1);
  coarse.reconstruct(mesh);
  EXPECT_EQ(coarse.getError().code, ErrorCode::kBadArgument);
  EXPECT_TRUE(mesh.polygons.empty());
  EXPECT_TRUE(mesh.cloud.data.empty());
}

TEST(SLIMReconstruction, ClosesEveryBorderOnRequest) {
  const auto whole = bumpySphere<pcl::PointXYZ>(5000);
  const auto half = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (const auto& p : *whole)
    if (p.z < 0) half->push_back(p);
  SLIMReconstruction<pcl::PointXYZ> reconstruction;
  reconstruction.setInputCloud(half);
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  EXPECT_EQ(reconstruction.getMeshStatistics().border_loops, 1u);
  reconstruction.setWatertight(true);
  EXPECT_TRUE(reconstruction.getWatertight());
  reconstruction.reconstruct(mesh);
  EXPECT_EQ(reconstruction.getMeshStatistics().border_loops, 0u);
  EXPECT_EQ(reconstruction.getMeshStatistics().census.euler, 2);
  EXPECT_GT(reconstruction.getMeshStatistics().closed_area, 0);
}

TEST(SLIMReconstruction, ColoursComeFromThePoints) {
  auto cloud = bumpySphere<pcl::PointXYZRGB>(5000);
  for (auto& p : *cloud) {
    p.r = p.x > 0 ? 250 : 10;
    p.g = 77;
    p.b = p.x > 0 ? 10 : 250;
  }
  SLIMReconstruction<pcl::PointXYZRGB> reconstruction;
  reconstruction.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointXYZRGB> points;
  std::vector<pcl::Vertices> polygons;
  reconstruction.reconstruct(points, polygons);
  ASSERT_GT(points.size(), 100u);
  for (const auto& p : points) {
    EXPECT_EQ(p.g, 77);
    if (std::abs(p.x) > 0.2) {
      EXPECT_EQ(p.r, p.x > 0 ? 250 : 10);
      EXPECT_EQ(p.b, p.x > 0 ? 10 : 250);
    }
  }
  pcl::PolygonMesh mesh;
  reconstruction.reconstruct(mesh);
  EXPECT_GE(findField(mesh.cloud, "rgb"), 0);
  reconstruction.setColors(false);
  reconstruction.reconstruct(mesh);
  EXPECT_EQ(findField(mesh.cloud, "rgb"), -1);
}

}  // namespace

namespace pcl_slim_test {

using ReconstructionDoors = testing::Types<ReconstructionTraits<pcl::PointXYZ>,
                                           ReconstructionTraits<pcl::PointXYZRGBNormal>>;
INSTANTIATE_TYPED_TEST_SUITE_P(SLIMReconstruction, DoorSuite, ReconstructionDoors);

}  // namespace pcl_slim_test

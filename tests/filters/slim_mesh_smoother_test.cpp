// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/slim_mesh_smoother.h"

#include <gtest/gtest.h>
#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cmath>

#include "support/meshes.h"

namespace {

using namespace pcl_slim;

template <typename PointT>
pcl::PolygonMesh::Ptr noisySphere(int n = 16) {
  pcl_slim_test::TestMesh sphere = pcl_slim_test::sphereMesh(n);
  pcl_slim_test::addNoise(0.01, sphere);
  pcl::PointCloud<PointT> cloud;
  for (std::size_t i = 0; i < sphere.vertices.size(); ++i) {
    PointT p;
    p.x = static_cast<float>(sphere.vertices[i][0]);
    p.y = static_cast<float>(sphere.vertices[i][1]);
    p.z = static_cast<float>(sphere.vertices[i][2]);
    p.intensity = static_cast<float>(i);
    cloud.push_back(p);
  }
  auto mesh = std::make_shared<pcl::PolygonMesh>();
  pcl::toPCLPointCloud2(cloud, mesh->cloud);
  mesh->header.frame_id = mesh->cloud.header.frame_id = "bench";
  for (std::size_t f = 0; f < sphere.faces.size(); ++f) {
    mesh->polygons.emplace_back();
    for (const std::uint32_t v : sphere.faces[f]) {
      mesh->polygons.back().vertices.push_back(static_cast<pcl::index_t>(v));
    }
  }
  return mesh;
}

template <typename PointT>
double errorOf(const pcl::PolygonMesh& mesh) {
  pcl::PointCloud<PointT> cloud;
  pcl::fromPCLPointCloud2(mesh.cloud, cloud);
  double sum = 0;
  for (const auto& p : cloud) sum += std::pow(std::hypot(p.x, p.y, p.z) - 1, 2);
  return std::sqrt(sum / static_cast<double>(cloud.size()));
}

TEST(SLIMMeshSmoother, KeepsOrderFieldsAndFaces) {
  const auto mesh = noisySphere<pcl::PointXYZINormal>();
  SLIMMeshSmoother smoother;
  smoother.setInputMesh(mesh);
  pcl::PolygonMesh smooth;
  ASSERT_TRUE(smoother.process(smooth)) << smoother.getError().message;
  EXPECT_EQ(smooth.header.frame_id, "bench");
  ASSERT_EQ(smooth.polygons.size(), mesh->polygons.size());
  EXPECT_EQ(smooth.polygons[77].vertices, mesh->polygons[77].vertices);
  pcl::PointCloud<pcl::PointXYZINormal> cloud;
  pcl::fromPCLPointCloud2(smooth.cloud, cloud);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto& p = cloud[i];
    EXPECT_EQ(p.intensity, static_cast<float>(i));
    EXPECT_GT(p.normal_x * p.x + p.normal_y * p.y + p.normal_z * p.z, 0.95);
  }
  EXPECT_LT(errorOf<pcl::PointXYZI>(smooth), 0.5 * errorOf<pcl::PointXYZI>(*mesh));
  EXPECT_EQ(smoother.getMeshStatistics().moved, cloud.size());
  EXPECT_GT(smoother.getStatistics().leaves, 0u);
  ASSERT_NE(smoother.getFittedSurface(), nullptr);

  // Into itself, with the surface found before; normals as they were where not wanted.
  auto again = std::make_shared<pcl::PolygonMesh>(*mesh);
  smoother.setSurface(smoother.getFittedSurface());
  smoother.setInputMesh(again);
  smoother.setComputeNormals(false);
  ASSERT_TRUE(smoother.process(*again));
  EXPECT_EQ(smoother.getFittedSurface(), nullptr);
  pcl::fromPCLPointCloud2(again->cloud, cloud);
  EXPECT_EQ(cloud[5].normal_x, 0.0f);
  EXPECT_LT(errorOf<pcl::PointXYZI>(*again), 0.5 * errorOf<pcl::PointXYZI>(*mesh));
}

TEST(SLIMMeshSmoother, SetterOfSharpFeaturesDecides) {
  SLIMMeshSmoother smoother;
  EXPECT_EQ(smoother.getEdges(), MeshEdges::kMeasured);
  smoother.setInputMesh(noisySphere<pcl::PointXYZI>());
  smoother.setSharpFeatures(true);
  pcl::PolygonMesh smooth;
  ASSERT_TRUE(smoother.process(smooth));
  EXPECT_TRUE(smoother.getMeshStatistics().sharp);
  smoother.setSharpFeatures(false);
  ASSERT_TRUE(smoother.process(smooth));
  EXPECT_FALSE(smoother.getMeshStatistics().sharp);
  EXPECT_EQ(smoother.getMeshStatistics().sharp_share, 0);
}

TEST(SLIMMeshSmoother, ErrorsAreToldAndLeaveNothing) {
  SLIMMeshSmoother smoother;
  const auto expect = [&](const std::string& word) {
    pcl::PolygonMesh out = *noisySphere<pcl::PointXYZI>(4);
    EXPECT_FALSE(smoother.process(out));
    EXPECT_TRUE(out.polygons.empty());
    EXPECT_TRUE(out.cloud.data.empty());
    EXPECT_NE(smoother.getError().message.find(word), std::string::npos)
        << smoother.getError().message;
  };
  expect("setInputMesh");
  smoother.setInputMesh(std::make_shared<pcl::PolygonMesh>());
  expect("no vertices");
  auto mesh = noisySphere<pcl::PointXYZI>(4);
  mesh->cloud.fields[0].name = "u";
  smoother.setInputMesh(mesh);
  expect("x y z");
  mesh = noisySphere<pcl::PointXYZI>(4);
  mesh->polygons[3].vertices[1] = -1;
  smoother.setInputMesh(mesh);
  expect("face 3 names vertex");
  mesh = noisySphere<pcl::PointXYZI>(4);
  mesh->polygons.clear();
  smoother.setInputMesh(mesh);
  expect("no faces");
  smoother.setInputMesh(noisySphere<pcl::PointXYZI>(4));
  smoother.setPolynomialOrder(7);
  expect("degree");
  smoother.setPolynomialOrder(0);
  smoother.expectRun();
  smoother.cancel();
  expect("cancelled");
  pcl::PolygonMesh out;
  EXPECT_TRUE(smoother.process(out));
  EXPECT_FALSE(smoother.getError());
}

}  // namespace

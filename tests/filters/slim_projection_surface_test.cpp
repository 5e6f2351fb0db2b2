// SPDX-License-Identifier: BSD-3-Clause
// Which surface points are brought onto, and to which side its normals point.
#include <gtest/gtest.h>
#include <pcl/common/io.h>
#include <pcl/search/kdtree.h>

#include "cloud_bytes.h"
#include "exact_clouds.h"
#include "pcl_slim/filters/slim_fit.h"
#include "pcl_slim/filters/slim_projection_smoother.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

TEST(SLIMProjectionSmoother, NormalsTakeTheSideAskedFor) {
  const auto outward = sphereCloud<pcl::PointNormal>(3000, 1.0, 0.001);
  auto inward = std::make_shared<pcl::PointCloud<pcl::PointNormal>>(*outward);
  auto normals = std::make_shared<pcl::PointCloud<pcl::Normal>>();
  auto plain = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  pcl::copyPointCloud(*outward, *plain);
  for (auto& p : *inward) p.getNormalVector3fMap() *= -1.0f;
  pcl::copyPointCloud(*inward, *normals);
  const auto sides = [](const pcl::PointCloud<pcl::PointNormal>& cloud, float sign) {
    for (const auto& p : cloud) {
      ASSERT_GT(sign * p.getNormalVector3fMap().dot(p.getVector3fMap()), 0.9f);
      ASSERT_GT(sign * p.curvature, 0.0f) << "mean curvature has the sign of the side";
    }
  };
  pcl::PointCloud<pcl::PointNormal> out;
  SLIMProjectionSmoother<pcl::PointNormal> from_fields;
  from_fields.setCurvature(from_fields.kMean);
  from_fields.setInputCloud(inward);
  from_fields.process(out);
  sides(out, -1.0f);

  SLIMProjectionSmoother<pcl::PointXYZ, pcl::PointNormal> smoother;
  smoother.setCurvature(smoother.kMean);
  smoother.setInputCloud(plain);
  smoother.setInputNormals(normals);
  smoother.process(out);
  sides(out, -1.0f);
  smoother.setInputNormals(nullptr);
  smoother.setViewPoint(0, 0, 0);
  smoother.process(out);
  sides(out, -1.0f);
  smoother.clearViewPoint();
  smoother.setNormalEstimationNeighbors(12);
  smoother.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
  smoother.process(out);
  sides(out, 1.0f);  // no sensor is known: PCL's are turned outward
  smoother.setNormalEstimationNeighbors(0);
  smoother.process(out);
  sides(out, 1.0f);

  smoother.setComputeNormals(false);
  smoother.process(out);
  for (const auto& p : out) ASSERT_EQ(p.getNormalVector3fMap(), Eigen::Vector3f::Zero());
}

TEST(SLIMProjectionSmoother, AGivenSurfaceIsUsed) {
  const auto cloud = torusCloud<pcl::PointXYZ>(12000, 0.002);
  SLIMProjectionSmoother<pcl::PointXYZ> smoother;
  smoother.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointXYZ> fitted, reused, part;
  smoother.process(fitted);
  const auto surface = smoother.getFittedSurface();
  ASSERT_TRUE(surface);
  smoother.setSurface(surface);
  smoother.process(reused);
  EXPECT_FALSE(smoother.getFittedSurface());
  EXPECT_EQ(smoother.getStatistics().fits, 0u);
  EXPECT_EQ(bytesOf(fitted), bytesOf(reused));

  auto indices = std::make_shared<pcl::Indices>();
  for (pcl::index_t i = 0; i < 12000; ++i) {
    if ((*cloud)[static_cast<std::size_t>(i)].x > 1.0f) indices->push_back(i);
  }
  smoother.setIndices(indices);  // another box
  smoother.process(part);
  ASSERT_EQ(part.size(), indices->size());
  for (std::size_t i = 0; i < part.size(); ++i) {
    const auto& whole = fitted[static_cast<std::size_t>((*indices)[i])];
    ASSERT_LT((part[i].getVector3fMap() - whole.getVector3fMap()).norm(), 2e-6f);
  }
}

TEST(SLIMProjectionSmoother, ASurfaceOfSomethingElseIsAnError) {
  SLIMProjectionSmoother<pcl::PointXYZ> smoother;
  smoother.setInputCloud(torusCloud<pcl::PointXYZ>(5000, 0.0));
  pcl::PointCloud<pcl::PointXYZ> out;
  smoother.process(out);
  ASSERT_TRUE(smoother.getFittedSurface());
  smoother.setSurface(smoother.getFittedSurface());
  auto elsewhere = sphereCloud<pcl::PointXYZ>(500, 30.0, 0.0);
  smoother.setInputCloud(elsewhere);
  smoother.process(out);
  EXPECT_EQ(smoother.getError().code, ErrorCode::kBadInput);
  EXPECT_TRUE(out.empty());
  smoother.setSurface(std::make_shared<SLIMSurface>());
  smoother.process(out);
  EXPECT_TRUE(smoother.getError());
  auto broken = std::make_shared<SLIMSurface>();
  broken->resize(3);
  broken->cy.pop_back();
  smoother.setSurface(broken);
  smoother.process(out);
  EXPECT_TRUE(smoother.getError());
  smoother.setSurface(nullptr);
  smoother.process(out);
  EXPECT_EQ(out.size(), 500u) << smoother.getError().message;
}

}  // namespace
}  // namespace pcl_slim

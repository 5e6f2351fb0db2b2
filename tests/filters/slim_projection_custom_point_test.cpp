// SPDX-License-Identifier: BSD-3-Clause
// Smoothing and curvature with point types of the user's own: one include each.
#include <gtest/gtest.h>

#include "door_suite.h"
#include "pcl_slim/filters/impl/slim_curvature_estimation.hpp"
#include "pcl_slim/filters/impl/slim_projection_smoother.hpp"

namespace pcl_slim_test {

struct EIGEN_ALIGN16 GradedPoint {
  float grade = 0.0f;  // before the coordinates, so that nothing may count on their place
  PCL_ADD_POINT4D
  std::uint16_t tag = 0;
  PCL_MAKE_ALIGNED_OPERATOR_NEW
};

struct EIGEN_ALIGN16 BentPoint {
  PCL_ADD_POINT4D
  PCL_ADD_NORMAL4D
  std::uint16_t tag = 0;
  float gaussian_curvature = 7.0f;
  PCL_MAKE_ALIGNED_OPERATOR_NEW
};

}  // namespace pcl_slim_test

// clang-format off
POINT_CLOUD_REGISTER_POINT_STRUCT(
    pcl_slim_test::GradedPoint,
    (float, grade, grade)(float, x, x)(float, y, y)(float, z, z)(std::uint16_t, tag, tag))
POINT_CLOUD_REGISTER_POINT_STRUCT(
    pcl_slim_test::BentPoint,
    (float, x, x)(float, y, y)(float, z, z)
    (float, normal_x, normal_x)(float, normal_y, normal_y)(float, normal_z, normal_z)
    (std::uint16_t, tag, tag)(float, gaussian_curvature, gaussian_curvature))
// clang-format on

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

pcl::PointCloud<GradedPoint>::Ptr gradedCloud() {
  auto cloud = pcl_slim_test::bumpySphere<GradedPoint>(3000);
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    (*cloud)[i].tag = static_cast<std::uint16_t>(i);
    (*cloud)[i].grade = 0.5f * static_cast<float>(i);
  }
  return cloud;
}

TEST(CustomPoint, IsSmoothedWithItsFields) {
  SLIMProjectionSmoother<GradedPoint, BentPoint> smoother;
  smoother.setInputCloud(gradedCloud());
  smoother.setNormalEstimationNeighbors(12);
  pcl::PointCloud<BentPoint> out;
  smoother.process(out);
  ASSERT_EQ(out.size(), 3000u) << smoother.getError().message;
  for (std::size_t i = 0; i < out.size(); ++i) {
    ASSERT_EQ(out[i].tag, i);
    ASSERT_NEAR(out[i].gaussian_curvature, 1.0f, 1.5f) << "a field of the surface's";
    ASSERT_NEAR(out[i].getNormalVector3fMap().norm(), 1.0f, 1e-5f);
  }
  SLIMProjectionSmoother<GradedPoint> same;
  same.setInputCloud(gradedCloud());
  pcl::PointCloud<GradedPoint> moved;
  same.process(moved);
  ASSERT_EQ(moved.size(), 3000u);
  EXPECT_EQ(moved[2999].grade, 1499.5f);
}

TEST(CustomPoint, TakesTheCurvaturesItHasFieldsFor) {
  SLIMCurvatureEstimation<pcl::PointXYZ, BentPoint> estimation;
  estimation.setInputCloud(pcl_slim_test::bumpySphere<pcl::PointXYZ>(3000));
  pcl::PointCloud<BentPoint> out;
  ASSERT_TRUE(estimation.compute(out)) << estimation.getError().message;
  ASSERT_EQ(out.size(), 3000u);
  for (const BentPoint& p : out) {
    ASSERT_NEAR(p.gaussian_curvature, 1.0f, 1.5f);
    ASSERT_NEAR(p.getVector3fMap().norm(), 1.0f, 0.06f) << "its place on the surface";
    ASSERT_EQ(p.tag, 0u);
  }
}

}  // namespace
}  // namespace pcl_slim

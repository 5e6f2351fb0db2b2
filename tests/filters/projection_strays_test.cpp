// SPDX-License-Identifier: BSD-3-Clause
// Points that a fit leaves out, as strays or for want of a normal, have no say in what becomes of
// the others.
#include <gtest/gtest.h>
#include <pcl/point_types.h>

#include "exact_clouds.h"
#include "pcl_slim/filters/slim_projection_smoother.h"

namespace pcl_slim {
namespace {

using NormalCloud = pcl::PointCloud<pcl::PointNormal>;

/** A sphere's points smoothed beside others that have no normal. */
void expectSmoothed(const std::vector<Eigen::Vector3f>& others,
                    const std::vector<Eigen::Vector3f>& strays) {
  auto cloud = pcl_slim_test::sphereCloud<pcl::PointNormal>(5000, 1.0, 0.002);
  for (const auto& list : {others, strays}) {
    for (const Eigen::Vector3f& p : list) {
      cloud->push_back(pcl::PointNormal(p.x(), p.y(), p.z()));
      cloud->back().normal_x = &list == &strays ? 1.0f : 0.0f;
    }
  }
  SLIMProjectionSmoother<pcl::PointNormal> smoother;
  smoother.setInputCloud(cloud);
  NormalCloud out;
  smoother.process(out);
  ASSERT_FALSE(smoother.getError()) << smoother.getError().message;
  ASSERT_EQ(out.size(), cloud->size());
  for (std::size_t i = 0; i < 5000; ++i) {
    ASSERT_LT(std::abs(pcl_slim_test::sphereDistance(out[i], 1.0)), 0.002);
  }
  for (std::size_t i = 5000; i < out.size(); ++i) {
    ASSERT_EQ(out[i].getVector3fMap(), (*cloud)[i].getVector3fMap()) << i;
  }
  EXPECT_EQ(smoother.getUnsupported().size(), others.size() + strays.size());
  EXPECT_EQ(smoother.getProjectionStatistics().non_finite, 0u);
}

TEST(ProjectionStrays, OneAtTheOriginWithoutNormal) {
  expectSmoothed({{0, 0, 0}}, {});
  expectSmoothed({{0, 0, 0}, {0, 0, 0}, {1e-33f, 0, 0}}, {});
}

TEST(ProjectionStrays, AsFarAwayAsFloatsReach) {
  for (const float distance : {1e6f, 1e12f, 1e30f, 1e38f, 3e38f}) {
    expectSmoothed({}, {{distance, 0, 0}});
    expectSmoothed({}, {{distance, 0, 0}, {0, -distance, 0}, {-distance, distance, distance}});
    expectSmoothed({{0, 0, 0}, {3, 3, 3}}, {{distance, 0, 0}, {0, -distance, 0}});
  }
}

TEST(ProjectionStrays, PointsWithoutNormalAreSmoothedAsWellBesideThem) {
  auto cloud = pcl_slim_test::sphereCloud<pcl::PointNormal>(5000, 1.0, 0.002);
  for (std::size_t i = 0; i < 3; ++i) (*cloud)[i].getNormalVector3fMap().setZero();
  NormalCloud expected, out;
  SLIMProjectionSmoother<pcl::PointNormal> smoother;
  smoother.setInputCloud(cloud);
  smoother.process(expected);
  cloud->push_back(pcl::PointNormal(1e9f, 0, 0, 1, 0, 0));
  smoother.setInputCloud(cloud);
  smoother.process(out);
  ASSERT_EQ(out.size(), 5001u);
  for (std::size_t i = 0; i < 5000; ++i) {
    ASSERT_EQ(out[i].getVector3fMap(), expected[i].getVector3fMap()) << i;
  }
}

TEST(ProjectionStrays, StraysOfStrays) {
  std::vector<Eigen::Vector3f> strays;
  for (int i = 0; i < 12; ++i)
    strays.push_back({1e10f * (1.0f + 0.1f * static_cast<float>(i)), 0, 0});
  for (int i = 0; i < 3; ++i) strays.push_back({0, 1e30f * static_cast<float>(1 + i), 0});
  expectSmoothed({{0, 0, 0}, {0, 3, 0}}, strays);
}

}  // namespace
}  // namespace pcl_slim

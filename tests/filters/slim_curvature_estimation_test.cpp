// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/slim_curvature_estimation.h"

#include <gtest/gtest.h>
#include <pcl/search/kdtree.h>

#include <cstring>

#include "door_suite.h"
#include "exact_clouds.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using Curvatures = pcl::PointCloud<PointCurvature>;
using Cloud = pcl::PointCloud<pcl::PointXYZ>;

template <typename PointInT, typename PointOutT>
struct CurvatureDoor {
  using Point = PointInT;
  using Door = SLIMCurvatureEstimation<PointInT, PointOutT>;
  static constexpr bool kPrints = true;

  static bool run(Door& door, std::vector<unsigned char>& output) {
    pcl::PointCloud<PointOutT> cloud(3, 1);
    const bool done = door.compute(cloud);
    std::vector<float> values;
    for (const PointOutT& p : cloud) {
      // Values first, padding after: direction pc1 pc2, or normal k1 ... direction2_z.
      constexpr bool kPcl = pcl::traits::has_field<PointOutT, pcl::fields::pc1>::value;
      float own[kPcl ? 5 : 14];
      std::memcpy(own, &p, sizeof(own));
      if (std::isfinite(own[4])) values.insert(values.end(), std::begin(own), std::end(own));
    }
    output.resize(values.size() * sizeof(float));
    if (!output.empty()) std::memcpy(output.data(), values.data(), output.size());
    return done;
  }
};

Eigen::Vector3f direction1(const PointCurvature& c) {
  return {c.direction1_x, c.direction1_y, c.direction1_z};
}

Eigen::Vector3f direction2(const PointCurvature& c) {
  return {c.direction2_x, c.direction2_y, c.direction2_z};
}

/** What is true of every curvature. */
void expectSound(const Curvatures& curvatures) {
  for (const PointCurvature& c : curvatures) {
    ASSERT_GE(c.k1, c.k2);
    const float size = 1e-4f * (1.0f + std::abs(c.k1) + std::abs(c.k2));
    ASSERT_NEAR(c.mean_curvature, 0.5f * (c.k1 + c.k2), size);
    ASSERT_NEAR(direction1(c).norm(), 1.0f, 1e-5f);
    ASSERT_NEAR(direction2(c).norm(), 1.0f, 1e-5f);
    ASSERT_NEAR(direction1(c).dot(direction2(c)), 0.0f, 1e-5f);
    ASSERT_NEAR(direction1(c).dot(c.getNormalVector3fMap()), 0.0f, 1e-5f);
    ASSERT_NEAR(direction2(c).dot(c.getNormalVector3fMap()), 0.0f, 1e-5f);
  }
}

Curvatures curvaturesOf(const Cloud::ConstPtr& cloud, const Eigen::Vector3d* viewpoint = nullptr) {
  SLIMCurvatureEstimation<pcl::PointXYZ> estimation;
  estimation.setInputCloud(cloud);
  if (viewpoint) estimation.setViewPoint(viewpoint->x(), viewpoint->y(), viewpoint->z());
  Curvatures curvatures;
  EXPECT_TRUE(estimation.compute(curvatures)) << estimation.getError().message;
  EXPECT_EQ(curvatures.size(), cloud->size());
  expectSound(curvatures);
  return curvatures;
}

TEST(SLIMCurvatureEstimation, OfASphereIsOneOverItsRadius) {
  for (const double radius : {0.05, 20.0}) {
    const Curvatures outside = curvaturesOf(sphereCloud<pcl::PointXYZ>(6000, radius, 0.0));
    const Eigen::Vector3d middle(0, 0, 0);
    const Curvatures inside = curvaturesOf(sphereCloud<pcl::PointXYZ>(6000, radius, 0.0), &middle);
    for (std::size_t i = 0; i < outside.size(); ++i) {
      ASSERT_NEAR(outside[i].k1 * radius, 1.0, 0.01);
      ASSERT_NEAR(outside[i].k2 * radius, 1.0, 0.01);
      ASSERT_NEAR(outside[i].gaussian_curvature * radius * radius, 1.0, 0.02);
      ASSERT_NEAR(inside[i].mean_curvature * radius, -1.0, 0.01);
      ASSERT_NEAR(inside[i].gaussian_curvature * radius * radius, 1.0, 0.02);
    }
  }
}

TEST(SLIMCurvatureEstimation, OfACylinderLiesAcrossItsAxis) {
  auto cloud = std::make_shared<Cloud>();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 12000; ++i) {
    const double a = M_PI * uniform(random), z = 4.0 * uniform(random);
    cloud->push_back(pcl::PointXYZ(static_cast<float>(2.0 * std::cos(a)),
                                   static_cast<float>(2.0 * std::sin(a)), static_cast<float>(z)));
  }
  const Curvatures curvatures = curvaturesOf(cloud);
  const bool outward =
      curvatures[0].normal_x * (*cloud)[0].x + curvatures[0].normal_y * (*cloud)[0].y > 0;
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    if (std::abs((*cloud)[i].z) > 3.5f) continue;  // away from the rims
    const PointCurvature& c = curvatures[i];
    const float bent = outward ? c.k1 : c.k2, straight = outward ? c.k2 : c.k1;
    ASSERT_NEAR(bent, outward ? 0.5 : -0.5, 0.01);
    ASSERT_NEAR(straight, 0.0, 0.01);
    ASSERT_NEAR(c.gaussian_curvature, 0.0, 0.01);
    ASSERT_GT(std::abs((outward ? direction2(c) : direction1(c)).z()), 0.99f);
  }
}

TEST(SLIMCurvatureEstimation, OfASaddleHasBothSigns) {
  auto cloud = std::make_shared<Cloud>();
  std::mt19937 random(4);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  for (int i = 0; i < 8000; ++i) {
    const float x = uniform(random), y = uniform(random);
    cloud->push_back(pcl::PointXYZ(x, y, (x * x - 3.0f * y * y) / 4.0f));
  }
  const Eigen::Vector3d above(0, 0, 40), below(0, 0, -40);
  const Curvatures up = curvaturesOf(cloud, &above), down = curvaturesOf(cloud, &below);
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    if (std::hypot((*cloud)[i].x, (*cloud)[i].y) > 0.02f) continue;
    EXPECT_NEAR(up[i].k1, 1.5, 0.02);  // along y it falls away from the normal +z
    EXPECT_NEAR(up[i].k2, -0.5, 0.02);
    EXPECT_NEAR(up[i].gaussian_curvature, -0.75, 0.03);
    EXPECT_GT(std::abs(up[i].direction1_y), 0.999f);
    EXPECT_NEAR(down[i].k1, 0.5, 0.02);
    EXPECT_NEAR(down[i].k2, -1.5, 0.02);
    EXPECT_GT(std::abs(down[i].direction1_x), 0.999f);
  }
}

TEST(SLIMCurvatureEstimation, OfATorusFollowsTheFormula) {
  const auto cloud = torusCloud<pcl::PointNormal>(20000, 0.0);
  SLIMCurvatureEstimation<pcl::PointNormal> estimation;
  estimation.setInputCloud(cloud);
  Curvatures curvatures;
  ASSERT_TRUE(estimation.compute(curvatures));
  expectSound(curvatures);
  double off1 = 0, off2 = 0, across = 0;
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    const auto& p = (*cloud)[i];
    const double rho = std::hypot(static_cast<double>(p.x), p.y);
    off1 += std::pow(curvatures[i].k1 - 1.0 / kMinor, 2);
    off2 += std::pow(curvatures[i].k2 - (rho - kMajor) / (kMinor * rho), 2);
    const Eigen::Vector3f around(static_cast<float>(-p.y / rho), static_cast<float>(p.x / rho), 0);
    across = std::max<double>(across, std::abs(direction1(curvatures[i]).dot(around)));
  }
  const auto n = static_cast<double>(cloud->size());
  EXPECT_LT(std::sqrt(off1 / n), 0.02 / kMinor);
  EXPECT_LT(std::sqrt(off2 / n), 0.02 / kMinor);
  EXPECT_LT(across, 0.1) << "k1 lies along the tube's circle";
}

TEST(SLIMCurvatureEstimation, FillsPclsPrincipalCurvatures) {
  const auto cloud = torusCloud<pcl::PointXYZ>(5000, 0.0);
  SLIMCurvatureEstimation<pcl::PointXYZ, pcl::PrincipalCurvatures> estimation;
  estimation.setInputCloud(cloud);
  estimation.setKSearch(10);        // as code for PCL's own estimation
  estimation.setRadiusSearch(0.1);  // would, and even both
  estimation.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
  pcl::PointCloud<pcl::PrincipalCurvatures> principal;
  pcl::Feature<pcl::PointXYZ, pcl::PrincipalCurvatures>& base = estimation;
  base.compute(principal);
  const Curvatures own = curvaturesOf(cloud);
  ASSERT_EQ(principal.size(), own.size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    ASSERT_EQ(principal[i].pc1, own[i].k1);
    ASSERT_EQ(principal[i].pc2, own[i].k2);
    ASSERT_EQ(principal[i].principal_curvature_y, own[i].direction1_y);
  }
}

TEST(SLIMCurvatureEstimation, UnknownIsNanAndTheShapeStays) {
  auto cloud = sphereCloud<pcl::PointXYZ>(6000, 1.0, 0.0);
  cloud->width = 60;
  cloud->height = 100;
  cloud->header.frame_id = "laser";
  (*cloud)[70].y = std::nanf("");
  (*cloud)[80] = pcl::PointXYZ(0, 0, 5);
  SLIMCurvatureEstimation<pcl::PointXYZ> estimation;
  estimation.setInputCloud(cloud);
  Curvatures curvatures;
  ASSERT_TRUE(estimation.compute(curvatures));
  EXPECT_EQ(curvatures.width, 60u);
  EXPECT_EQ(curvatures.height, 100u);
  EXPECT_EQ(curvatures.header.frame_id, "laser");
  EXPECT_FALSE(curvatures.is_dense);
  for (const std::size_t i : {70u, 80u}) {
    EXPECT_TRUE(std::isnan(curvatures[i].k1) && std::isnan(curvatures[i].gaussian_curvature) &&
                std::isnan(curvatures[i].direction2_x) && std::isnan(curvatures[i].mean_curvature));
  }
  EXPECT_TRUE(std::isnan(curvatures[70].normal_z));
  EXPECT_NEAR(curvatures[80].getNormalVector3fMap().norm(), 1.0f, 1e-5f) << "of its neighbours";
  EXPECT_EQ(estimation.getProjectionStatistics().non_finite, 1u);
  const auto& lone = estimation.getUnsupported();
  EXPECT_EQ(std::count(lone.begin(), lone.end(), 80), 1);
  // A cloud in rows faces its sensor, here the sphere's centre, from which it is hollow.
  EXPECT_NEAR(curvatures[90].k1, -1.0, 0.02);
}

TEST(SLIMCurvatureEstimation, FitsToTheSearchSurface) {
  const auto surface = sphereCloud<pcl::PointXYZ>(8000, 1.0, 0.0);
  auto few = std::make_shared<Cloud>();
  for (std::size_t i = 0; i < 40; ++i) {
    const auto& p = (*surface)[200 * i];  // between the surface's points, on one side of it
    if (p.x > 0) few->push_back(pcl::PointXYZ(p.x, -p.y, p.z));
  }
  SLIMCurvatureEstimation<pcl::PointXYZ> estimation;
  estimation.setInputCloud(few);
  estimation.setSearchSurface(surface);
  Curvatures curvatures;
  ASSERT_TRUE(estimation.compute(curvatures)) << estimation.getError().message;
  ASSERT_EQ(curvatures.size(), few->size());
  EXPECT_TRUE(curvatures.is_dense);
  for (const PointCurvature& c : curvatures) EXPECT_NEAR(c.mean_curvature, 1.0, 0.02);
  estimation.setSearchSurface(std::make_shared<Cloud>());
  EXPECT_FALSE(estimation.compute(curvatures));
  EXPECT_TRUE(curvatures.empty());
}

TEST(SLIMCurvatureEstimation, AGivenSurfaceIsUsed) {
  const auto cloud = torusCloud<pcl::PointXYZ>(6000, 0.001);
  SLIMCurvatureEstimation<pcl::PointXYZ> estimation;
  estimation.setInputCloud(cloud);
  Curvatures first, again;
  ASSERT_TRUE(estimation.compute(first));
  estimation.setSurface(estimation.getFittedSurface());
  ASSERT_TRUE(estimation.compute(again));
  for (std::size_t i = 0; i < first.size(); ++i) ASSERT_EQ(first[i].k1, again[i].k1);
}

}  // namespace
}  // namespace pcl_slim

namespace pcl_slim_test {

using CurvatureDoors =
    testing::Types<pcl_slim::CurvatureDoor<pcl::PointXYZ, pcl_slim::PointCurvature>,
                   pcl_slim::CurvatureDoor<pcl::PointXYZRGBNormal, pcl::PrincipalCurvatures>>;
INSTANTIATE_TYPED_TEST_SUITE_P(SLIMCurvatureEstimation, DoorSuite, CurvatureDoors);

}  // namespace pcl_slim_test

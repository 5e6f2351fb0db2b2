// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/slim_fit.h"

#include <gtest/gtest.h>
#include <pcl/features/normal_3d.h>
#include <pcl/search/kdtree.h>
#include <pcl/search/octree.h>
#include <pcl/search/organized.h>

#include "door_suite.h"
#include "pcl_slim/surface/surface_io.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

template <typename PointT>
struct FitDoor {
  using Point = PointT;
  using Door = SLIMFit<PointT>;
  static constexpr bool kPrints = false;

  static bool run(Door& door, std::vector<unsigned char>& output) {
    SLIMSurface surface;
    surface.info.degree = 2;
    surface.resize(3);
    const bool done = door.fit(surface);
    output = surface.empty() ? std::vector<unsigned char>() : encodeSlim(surface);
    return done;
  }
};

/** Largest distance of leaf centres from the bumpy sphere, as a check that a fit is one. */
double largestCentreError(const SLIMSurface& surface) {
  double largest = 0.0;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    double p[3] = {surface.cx[i], surface.cy[i], surface.cz[i]};
    for (int a = 0; a < 3; ++a) {
      p[a] = surface.info.origin[static_cast<std::size_t>(a)] + surface.info.scale * p[a];
    }
    const double r = std::hypot(p[0], p[1], p[2]);
    largest = std::max(largest, std::abs(r - 1.0 - 0.05 * std::sin(4.0 * p[0] / r)));
  }
  return largest;
}

/** An organized cloud as a camera at the origin sees it: a wavy wall, holes as NaN. */
pcl::PointCloud<pcl::PointXYZ>::Ptr cameraCloud() {
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>(160, 120);
  for (int row = 0; row < 120; ++row) {
    for (int column = 0; column < 160; ++column) {
      const float a = (static_cast<float>(column) - 79.5f) / 130.0f;
      const float b = (static_cast<float>(row) - 59.5f) / 130.0f;
      const float z = 2.0f + 0.1f * std::sin(6.0f * a) * std::cos(5.0f * b);
      auto& p = (*cloud)(static_cast<unsigned>(column), static_cast<unsigned>(row));
      p.getVector3fMap() = Eigen::Vector3f(a * z, b * z, z);
      if ((row / 10 + column / 10) % 9 == 0) p.x = p.y = p.z = std::nanf("");
    }
  }
  cloud->is_dense = false;
  return cloud;
}

TEST(SLIMFit, NoiseAndTargetInTheCloudsUnit) {
  SLIMFit<pcl::PointXYZ> fit;
  fit.setNoise(0.005);
  fit.setTargetDistance(0.02);
  EXPECT_EQ(fit.getNoise(), 0.005);
  EXPECT_EQ(fit.getParams().noise, 0.005);
  EXPECT_EQ(fit.getTargetDistance(), 0.02);
  EXPECT_EQ(fit.getTargetError(), 0.0);
  fit.setNoise(0);
  fit.setTargetDistance(0);
  EXPECT_EQ(fit.getNoise(), 0.0);
  EXPECT_EQ(fit.getTargetDistance(), 0.0);
  EXPECT_TRUE(std::holds_alternative<PenaltyWeight>(fit.getParams().size));
  fit.params().noise = 0.005;
  fit.params().lambda = 1e-6;
  fit.setInputCloud(bumpySphere<pcl::PointXYZ>(2000));
  SLIMSurface surface;
  EXPECT_FALSE(fit.fit(surface));
  EXPECT_EQ(fit.getError().message, "noise and lambda are one quantity in two units: give one");
}

TEST(SLIMFit, FitsEveryCompiledPointType) {
  const auto fits = [](auto point) {
    using Point = decltype(point);
    SLIMFit<Point> fit;
    fit.setInputCloud(bumpySphere<Point>(5000));
    fit.setPolynomialOrder(3);
    SLIMSurface surface;
    EXPECT_TRUE(fit.fit(surface)) << fit.getError().message;
    EXPECT_LT(largestCentreError(surface), 0.02);
    EXPECT_EQ(surface.info.degree, 3);
    EXPECT_EQ(fit.getStatistics().points, 5000u);
  };
  fits(pcl::PointXYZ());
  fits(pcl::PointXYZI());
  fits(pcl::PointXYZRGB());
  fits(pcl::PointXYZRGBA());
  fits(pcl::PointNormal());
  fits(pcl::PointXYZINormal());
  fits(pcl::PointXYZRGBNormal());
}

TEST(SLIMFit, NormalsComeFromTheBestSource) {
  const auto with_normals = bumpySphere<pcl::PointNormal>(3000);
  auto plain = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  auto normals = std::make_shared<pcl::PointCloud<pcl::Normal>>();
  pcl::copyPointCloud(*with_normals, *plain);
  pcl::copyPointCloud(*with_normals, *normals);

  SLIMSurface from_fields, from_cloud, from_nothing;
  SLIMFit<pcl::PointNormal> fields_fit;
  fields_fit.setInputCloud(with_normals);
  ASSERT_TRUE(fields_fit.fit(from_fields));
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(plain);
  ASSERT_TRUE(fit.fit(from_nothing));
  fit.setInputNormals(normals);
  ASSERT_TRUE(fit.fit(from_cloud));
  EXPECT_EQ(encodeSlim(from_fields), encodeSlim(from_cloud));
  EXPECT_NE(encodeSlim(from_nothing), encodeSlim(from_cloud));
  EXPECT_TRUE(from_cloud.info.oriented);

  normals->resize(10);
  EXPECT_FALSE(fit.fit(from_cloud));
  EXPECT_TRUE(from_cloud.empty());
  EXPECT_EQ(fit.getError().code, ErrorCode::kBadInput);
}

TEST(SLIMFit, PointsWithoutNormalAmongOthersAreLeftOut) {
  auto cloud = bumpySphere<pcl::PointNormal>(3000);
  for (std::size_t i = 0; i < 100; ++i) (*cloud)[i].normal_x = std::nanf("");
  for (std::size_t i = 100; i < 150; ++i) (*cloud)[i].getNormalVector3fMap().setZero();
  SLIMFit<pcl::PointNormal> fit;
  fit.setInputCloud(cloud);
  SLIMSurface surface;
  ASSERT_TRUE(fit.fit(surface));
  EXPECT_EQ(fit.getInputStatistics().without_normal, 150u);
  EXPECT_EQ(fit.getStatistics().points, 2850u);
}

TEST(SLIMFit, AnySearchObjectServesNormals) {
  const auto cloud = cameraCloud();
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(cloud);
  fit.setNormalEstimationNeighbors(12);
  SLIMSurface automatic, tree, octree, organized;
  ASSERT_TRUE(fit.fit(automatic)) << fit.getError().message;
  fit.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
  ASSERT_TRUE(fit.fit(tree)) << fit.getError().message;
  fit.setSearchMethod(std::make_shared<pcl::search::Octree<pcl::PointXYZ>>(0.05));
  ASSERT_TRUE(fit.fit(octree)) << fit.getError().message;
  fit.setSearchMethod(std::make_shared<pcl::search::OrganizedNeighbor<pcl::PointXYZ>>());
  ASSERT_TRUE(fit.fit(organized)) << fit.getError().message;
  EXPECT_EQ(encodeSlim(automatic), encodeSlim(organized));
  for (const SLIMSurface* surface : {&tree, &octree, &organized}) {
    EXPECT_TRUE(surface->info.oriented);
    std::size_t facing = 0;
    for (std::size_t i = 0; i < surface->size(); ++i) facing += surface->nz[i] < 0.0f ? 1 : 0;
    EXPECT_EQ(facing, surface->size()) << "normals face the camera";
  }
}

TEST(SLIMFit, UnsuitableSearchAndNeighbourhoodAreErrors) {
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(bumpySphere<pcl::PointXYZ>(500));
  fit.setNormalEstimationNeighbors(10);
  fit.setSearchMethod(std::make_shared<pcl::search::OrganizedNeighbor<pcl::PointXYZ>>());
  SLIMSurface surface;
  EXPECT_FALSE(fit.fit(surface));
  EXPECT_NE(fit.getError().message.find("organized"), std::string::npos);
  fit.setSearchMethod(nullptr);
  fit.setNormalEstimationNeighbors(2);
  EXPECT_FALSE(fit.fit(surface));
  fit.setNormalEstimationNeighbors(-5);
  EXPECT_FALSE(fit.fit(surface));
  fit.setNormalEstimationNeighbors(10);
  EXPECT_TRUE(fit.fit(surface)) << fit.getError().message;
}

TEST(SLIMFit, NeighboursBeyondThePointsAndCoordinatesBeyondSquaresAreErrors) {
  SLIMFit<pcl::PointXYZ> fit;
  auto cloud = bumpySphere<pcl::PointXYZ>(500);
  fit.setInputCloud(cloud);
  fit.setNormalEstimationNeighbors(501);
  SLIMSurface surface;
  EXPECT_FALSE(fit.fit(surface));
  EXPECT_NE(fit.getError().message.find("501 neighbours of 500"), std::string::npos);
  fit.setNormalEstimationNeighbors(10);
  for (const float factor : {2.5e38f, 1e-20f}) {
    auto scaled = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>(*cloud);
    for (auto& p : *scaled) p.getVector3fMap() *= factor / 2.0f;
    fit.setInputCloud(scaled);
    EXPECT_FALSE(fit.fit(surface)) << factor;
    EXPECT_NE(fit.getError().message.find("scale"), std::string::npos) << fit.getError().message;
  }
}

TEST(SLIMFit, TooManyThreadsAreAnError) {
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(bumpySphere<pcl::PointXYZ>(500));
  SLIMSurface surface;
  for (const int neighbours : {0, 10}) {
    fit.setNormalEstimationNeighbors(neighbours);
    for (const unsigned int threads : {4097u, 100000u, 4000000000u}) {
      fit.setNumberOfThreads(threads);
      EXPECT_FALSE(fit.fit(surface)) << threads;
      EXPECT_EQ(fit.getError().code, ErrorCode::kBadArgument);
    }
    fit.setNumberOfThreads(2);
    EXPECT_TRUE(fit.fit(surface)) << fit.getError().message;
  }
}

TEST(SLIMFit, PointsThatAreNoSurfaceAreAnError) {
  auto line = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  for (int i = 0; i < 500; ++i) {
    const auto t = static_cast<float>(i);
    line->push_back(pcl::PointXYZ(0.1f * t, 0.2f * t, 0.3f * t));
  }
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(line);
  SLIMSurface surface;
  EXPECT_FALSE(fit.fit(surface));
  EXPECT_EQ(fit.getError().code, ErrorCode::kNoSurface);
  EXPECT_TRUE(surface.empty());
  EXPECT_EQ(fit.getStatistics().points, 500u);
}

TEST(SLIMFit, EstimatedNormalsSurviveNanAndIndices) {
  auto cloud = bumpySphere<pcl::PointXYZ>(2000);
  for (std::size_t i = 0; i < 2000; i += 50) (*cloud)[i].x = std::nanf("");
  cloud->is_dense = true;  // untrue
  auto indices = std::make_shared<pcl::Indices>();
  for (pcl::index_t i = 0; i < 1500; ++i) indices->push_back(i);
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(cloud);
  fit.setIndices(indices);
  fit.setNormalEstimationNeighbors(15);
  SLIMSurface surface;
  ASSERT_TRUE(fit.fit(surface)) << fit.getError().message;
  EXPECT_EQ(fit.getInputStatistics().non_finite, 30u);
  EXPECT_FALSE(surface.validate());
}

TEST(SLIMFit, ViewPointDecidesTheSide) {
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(cameraCloud());
  SLIMSurface surface;
  for (const double z : {-10.0, 30.0}) {
    fit.setViewPoint(0.0, 0.0, z);
    ASSERT_TRUE(fit.fit(surface)) << fit.getError().message;
    for (std::size_t i = 0; i < surface.size(); ++i) EXPECT_GT(surface.nz[i] * z, 0.0) << i;
  }
}

TEST(SLIMFit, NamesOutliersByTheirIndices) {
  const auto cloud = cameraCloud();
  const std::vector<std::int32_t> raised = {0, 5000, 11110};
  for (const std::int32_t i : raised) {
    cloud->points[static_cast<std::size_t>(i)] =
        pcl::PointXYZ(0.1f * static_cast<float>(i % 7), 0.3f, 1.0f);
  }
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(cloud);
  SLIMSurface surface;
  ASSERT_TRUE(fit.fit(surface)) << fit.getError().message;
  EXPECT_EQ(fit.getOutliers(), raised);
  EXPECT_EQ(fit.getStatistics().outliers, raised.size());
  fit.setKeepOutliers(true);
  ASSERT_TRUE(fit.fit(surface)) << fit.getError().message;
  EXPECT_TRUE(fit.getOutliers().empty());
}

TEST(SLIMFit, BadParametersAreErrors) {
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(bumpySphere<pcl::PointXYZ>(200));
  SLIMSurface surface;
  for (const int order : {5, -1}) {
    fit.setPolynomialOrder(order);
    EXPECT_FALSE(fit.fit(surface));
    EXPECT_EQ(fit.getError().code, ErrorCode::kBadArgument);
  }
  fit.setPolynomialOrder(2);
  fit.setPenalty(-1.0);
  EXPECT_FALSE(fit.fit(surface));
  fit.setPenalty(std::nan(""));
  EXPECT_FALSE(fit.fit(surface));
  fit.setPenalty(2.0);
  EXPECT_TRUE(fit.fit(surface)) << fit.getError().message;
}

TEST(SLIMFit, GivesPointsThatMakeTheSameSurface) {
  auto cloud = bumpySphere<pcl::PointXYZ>(3000);
  cloud->header.frame_id = "scanner";
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(cloud);
  SLIMSurface surface;
  ASSERT_TRUE(fit.fit(surface));
  pcl::PointCloud<PointSLIM> surfels;
  SurfaceMetadata metadata;
  ASSERT_TRUE(fit.fit(surfels, &metadata));
  EXPECT_EQ(surfels.header.frame_id, "scanner");
  auto again = fromPCL(surfels, &metadata);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->hasTrimMaps(), surface.hasTrimMaps());  // of 8 x 8 bits there
  again->dropTrimMaps();
  surface.dropTrimMaps();
  EXPECT_EQ(encodeSlim(surface), encodeSlim(*again));

  fit.setInputCloud(std::make_shared<pcl::PointCloud<pcl::PointXYZ>>());
  EXPECT_FALSE(fit.fit(surfels, &metadata));
  EXPECT_TRUE(surfels.empty());
}

TEST(SLIMFit, FittedFilesAreInWorldCoordinates) {
  auto cloud = bumpySphere<pcl::PointXYZ>(3000);
  for (auto& p : *cloud) p.x += 40.0f;
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(cloud);
  pcl::PointCloud<PointSLIM> surfels;
  SurfaceMetadata metadata;
  ASSERT_TRUE(fit.fit(surfels, &metadata));
  EXPECT_EQ(metadata.shift, (std::array<double, 3>{}));
  for (const PointSLIM& p : surfels) EXPECT_NEAR(p.x, 40.0, 1.1);
}

}  // namespace
}  // namespace pcl_slim

namespace pcl_slim_test {

using FitDoors =
    testing::Types<pcl_slim::FitDoor<pcl::PointXYZ>, pcl_slim::FitDoor<pcl::PointXYZRGBNormal>>;
INSTANTIATE_TYPED_TEST_SUITE_P(SLIMFit, DoorSuite, FitDoors);

}  // namespace pcl_slim_test

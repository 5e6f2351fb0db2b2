// SPDX-License-Identifier: BSD-3-Clause
// What classes that fit report of the sides that they chose.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <random>
#include <string>

#include "exact_clouds.h"
#include "pcl_slim/filters/color_octree_splat_sampler.h"
#include "pcl_slim/filters/slim_fit.h"
#include "pcl_slim/filters/slim_projection_smoother.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

const std::string kOutwardNote =
    "sides: outward (no sensor known; setViewPoint(x, y, z) if it was scanned from inside)";
const std::string kOriginNote =
    "sides: towards the origin, as the points' spacing shows a scanner there (setViewPoint(x, y, "
    "z) "
    "if it was elsewhere)";

/** A room of 8 x 6 x 3 m as a scanner in its middle sees it, equal angles apart. */
pcl::PointCloud<pcl::PointXYZ>::Ptr roomFromInside() {
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 0.003);
  constexpr int kRings = 80, kSteps = 300;
  const double half[3] = {4, 3, 1.5};
  for (int ring = 0; ring < kRings; ++ring) {
    for (int step = 0; step < kSteps; ++step) {
      const double up = (ring / (kRings - 1.0) - 0.5) * 2.1, turn = 2 * M_PI * step / kSteps;
      const double d[3] = {std::cos(up) * std::cos(turn), std::cos(up) * std::sin(turn),
                           std::sin(up)};
      double range = 1e9;
      for (int a = 0; a < 3; ++a) range = std::min(range, half[a] / std::max(1e-9, std::abs(d[a])));
      range += noise(random);
      cloud->push_back({static_cast<float>(range * d[0]), static_cast<float>(range * d[1]),
                        static_cast<float>(range * d[2])});
    }
  }
  return cloud;
}

TEST(SideWarnings, OfAScanWithoutASensorNameTheSide) {
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(sphereCloud<pcl::PointXYZ>(4000, 1.0, 0.001));
  SLIMSurface surface;
  ASSERT_TRUE(fit.fit(surface)) << fit.getError().message;
  EXPECT_EQ(fit.getWarning(), kOutwardNote);
  EXPECT_EQ(fit.getStatistics().sides.source, SideSource::kOutward);
  fit.setViewPoint(0, 0, 9);
  ASSERT_TRUE(fit.fit(surface));
  EXPECT_EQ(fit.getWarning(), "");
  fit.clearViewPoint();
  ASSERT_TRUE(fit.fit(surface));
  EXPECT_EQ(fit.getWarning(), kOutwardNote);
  fit.setInputCloud(std::make_shared<pcl::PointCloud<pcl::PointXYZ>>());
  EXPECT_FALSE(fit.fit(surface));
  EXPECT_EQ(fit.getWarning(), "") << "of the last run";
}

TEST(SideWarnings, OfAScannerAtTheOriginNameIt) {
  const auto room = roomFromInside();
  SLIMFit<pcl::PointXYZ> fit;
  fit.setInputCloud(room);
  pcl::PointCloud<PointSLIM> surfels;
  ASSERT_TRUE(fit.fit(surfels)) << fit.getError().message;
  EXPECT_EQ(fit.getWarning(), kOriginNote);
  std::size_t away = 0;
  for (const PointSLIM& p : surfels)
    away += p.x * p.normal_x + p.y * p.normal_y + p.z * p.normal_z > 0;
  EXPECT_EQ(away, 0u) << "of " << surfels.size();
  // A cloud that knows its sensor needs no note.
  room->sensor_origin_ = Eigen::Vector4f(0.1f, 0, 0, 1);
  ASSERT_TRUE(fit.fit(surfels));
  EXPECT_EQ(fit.getWarning(), "");
  EXPECT_EQ(fit.getStatistics().sides.source, SideSource::kViewpoint);
}

TEST(SideWarnings, OfOpposedNormalsNameTheirShare) {
  const auto right = sphereCloud<pcl::PointNormal>(6000, 1.0, 0.0);
  auto flipped = std::make_shared<pcl::PointCloud<pcl::PointNormal>>(*right);
  for (std::size_t i = 0; i < flipped->size(); i += 20)
    (*flipped)[i].getNormalVector3fMap() *= -1.0f;
  SLIMFit<pcl::PointNormal> fit;
  SLIMSurface surface, expected;
  fit.setInputCloud(right);
  ASSERT_TRUE(fit.fit(expected));
  EXPECT_EQ(fit.getWarning(), "");
  fit.setInputCloud(flipped);
  ASSERT_TRUE(fit.fit(surface));
  double share = 0;
  char rest[100] = "";
  ASSERT_EQ(std::sscanf(fit.getWarning().c_str(), "normals of %lf %%%99[^\n]", &share, rest), 2)
      << fit.getWarning();
  EXPECT_NEAR(share, 100 * 2 * 0.05 * 0.95, 3);  // pairs one of which is flipped
  EXPECT_STREQ(rest, " of the neighbours are opposed: used without their signs");
  EXPECT_EQ(surface.nz, expected.nz);
  EXPECT_EQ(surface.coefficients, expected.coefficients);
}

TEST(SideWarnings, OfNormalsWithoutAxesSayThatTheyAreNotUsed) {
  auto cloud = sphereCloud<pcl::PointNormal>(6000, 1.0, 0.0);
  std::mt19937_64 random(3);
  std::normal_distribution<float> gauss;
  for (auto& p : *cloud)
    p.getNormalVector3fMap() =
        Eigen::Vector3f(gauss(random), gauss(random), gauss(random)).normalized();
  SLIMFit<pcl::PointNormal> fit;
  fit.setInputCloud(cloud);
  SLIMSurface surface;
  ASSERT_TRUE(fit.fit(surface));
  const std::string& warning = fit.getWarning();
  EXPECT_NE(warning.find("not used, as they have no axes in common either; " + kOutwardNote),
            std::string::npos)
      << warning;
}

TEST(SideWarnings, OfASmoothingAreThoseOfItsFit) {
  SLIMProjectionSmoother<pcl::PointXYZ, pcl::PointNormal> smoother;
  smoother.setInputCloud(roomFromInside());
  smoother.setComputeNormals(true);
  pcl::PointCloud<pcl::PointNormal> smooth;
  smoother.process(smooth);
  EXPECT_EQ(smoother.getWarning(), kOriginNote);
  std::size_t away = 0;
  for (const auto& p : smooth) away += p.getVector3fMap().dot(p.getNormalVector3fMap()) > 0;
  EXPECT_EQ(away, 0u);
}

TEST(SideWarnings, SplatsOfTheSameScanHaveTheSameSide) {
  const auto room = roomFromInside();
  ColorOctreeSplatSampler<pcl::PointXYZ> sampler;
  sampler.setInputCloud(room);
  pcl::PointCloud<pcl::PointSurfel> splats;
  const auto numAway = [&] {
    std::size_t away = 0;
    for (const auto& p : splats) away += p.getVector3fMap().dot(p.getNormalVector3fMap()) > 0;
    return away;
  };
  ASSERT_TRUE(sampler.sample(splats)) << sampler.getError().message;
  EXPECT_EQ(sampler.getStatistics().sides, SideSource::kOrigin);
  EXPECT_EQ(sampler.getWarning(), kOriginNote);
  EXPECT_EQ(numAway(), 0u);
  for (auto& p : *room) p.x += 20;
  ASSERT_TRUE(sampler.sample(splats));
  EXPECT_EQ(sampler.getStatistics().sides, SideSource::kOutward);
  EXPECT_EQ(sampler.getWarning(), kOutwardNote);
  for (auto& p : splats) p.x -= 20;
  EXPECT_EQ(numAway(), splats.size());
  double x, y, z;
  EXPECT_FALSE(sampler.getViewPoint(x, y, z));
  sampler.setViewPoint(20, 0, 0);
  ASSERT_TRUE(sampler.sample(splats));
  EXPECT_EQ(sampler.getStatistics().sides, SideSource::kViewpoint);
  EXPECT_TRUE(sampler.getWarning().empty()) << sampler.getWarning();
  for (auto& p : splats) p.x -= 20;
  EXPECT_EQ(numAway(), 0u);
}

}  // namespace
}  // namespace pcl_slim

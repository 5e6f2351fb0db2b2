// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/slim_colorizer.h"

#include <gtest/gtest.h>
#include <pcl/common/point_tests.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <random>

#include "door_suite.h"
#include "exact_clouds.h"
#include "pcl_slim/filters/slim_fit.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using Plain = pcl::PointXYZ;
using Painted = pcl::PointXYZRGB;
using RgbCloud = pcl::PointCloud<Painted>;

/** A smooth colour of space. */
template <typename PointT>
std::array<double, 3> waves(const PointT& p) {
  return {128 + 100 * std::sin(2 * p.x), 128 + 100 * std::cos(2 * p.y), 128.0 + 60 * p.z};
}

/** Gives points colours with noise. */
template <typename PointT>
void paintWaves(double noise, pcl::PointCloud<PointT>& cloud) {
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  for (PointT& p : cloud) {
    const auto color = waves(p);
    std::uint8_t* const channels[3] = {&p.r, &p.g, &p.b};
    for (std::size_t c = 0; c < 3; ++c) {
      const double value = color[c] + noise * normal(random);
      *channels[c] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
    }
  }
}

/** RMS difference of the colours of some points from the truth. */
double waveError(const RgbCloud& cloud) {
  double sum = 0;
  for (const Painted& p : cloud) {
    const auto truth = waves(p);
    sum += std::pow(p.r - truth[0], 2) + std::pow(p.g - truth[1], 2) + std::pow(p.b - truth[2], 2);
  }
  return std::sqrt(sum / (3.0 * static_cast<double>(cloud.size())));
}

/** A surface with the colours of waves. */
std::shared_ptr<const SLIMSurface> paintedSphere() {
  static const auto made = [] {
    const auto scan = bumpySphere<Painted>(8000, 3);
    paintWaves(0, *scan);
    SLIMFit<Painted> fit;
    fit.setInputCloud(scan);
    auto surface = std::make_shared<SLIMSurface>();
    EXPECT_TRUE(fit.fit(*surface)) << fit.getError().message;
    return surface;
  }();
  return made;
}

/** Colours from a given surface, or without one from the input's own. */
template <typename PointInT, bool kGiven>
struct ColorizerDoor {
  using Point = PointInT;
  using Door = SLIMColorizer<PointInT>;
  static constexpr bool kPrints = false;

  static bool run(Door& door, std::vector<unsigned char>& output) {
    if (kGiven) door.setSurface(paintedSphere());
    RgbCloud cloud(3, 1);
    const bool done = door.colorize(cloud);
    output.clear();
    for (const Painted& p : cloud) {
      if (!pcl::isFinite(p)) continue;
      const auto* bytes = reinterpret_cast<const unsigned char*>(p.data);
      output.insert(output.end(), bytes, bytes + 12);
      output.insert(output.end(), {p.r, p.g, p.b});
    }
    return done;
  }
};

using ColorizerDoors =
    testing::Types<ColorizerDoor<pcl::PointXYZ, true>, ColorizerDoor<pcl::PointNormal, true>,
                   ColorizerDoor<pcl::PointXYZRGB, false>>;
INSTANTIATE_TYPED_TEST_SUITE_P(SLIMColorizer, DoorSuite, ColorizerDoors);

TEST(SLIMColorizer, GivesThePointsTheColoursOfTheSurface) {
  const auto cloud = bumpySphere<Plain>(5000, 8);
  SLIMColorizer<Plain> colorizer;
  colorizer.setInputCloud(cloud);
  colorizer.setSurface(paintedSphere());
  RgbCloud colored;
  ASSERT_TRUE(colorizer.colorize(colored)) << colorizer.getError().message;
  ASSERT_EQ(colored.size(), cloud->size());
  for (std::size_t i = 0; i < cloud->size(); ++i)
    ASSERT_EQ((*cloud)[i].getVector3fMap(), colored[i].getVector3fMap()) << i;
  EXPECT_TRUE(colorizer.getUnsupported().empty());
  EXPECT_LT(waveError(colored), 3.0);  // FitColors.FollowASmoothColour has the bound
}

TEST(SLIMColorizer, AveragesTheNoiseOfTheInputsOwnColours) {
  const auto cloud = bumpySphere<Painted>(8000, 4);
  paintWaves(20, *cloud);
  SLIMColorizer<Painted> colorizer;
  colorizer.setInputCloud(cloud);
  RgbCloud colored;
  ASSERT_TRUE(colorizer.colorize(colored)) << colorizer.getError().message;
  EXPECT_GT(waveError(*cloud), 15.0);
  EXPECT_LT(waveError(colored), 8.0);
  ASSERT_TRUE(colorizer.getFittedSurface());
  EXPECT_TRUE(colorizer.getFittedSurface()->hasColors());
  const auto shared = std::make_shared<RgbCloud>(*cloud);
  colorizer.setInputCloud(shared);
  ASSERT_TRUE(colorizer.colorize(*shared));
  EXPECT_EQ(waveError(*shared), waveError(colored)) << "the output is the input";
}

TEST(SLIMColorizer, PointsFarFromTheSurfaceKeepTheirColourOrAreWhite) {
  auto cloud = bumpySphere<Painted>(1000, 6);
  cloud->header.frame_id = "map";
  cloud->sensor_origin_ = {1, 2, 3, 0};
  Painted far, nowhere;
  far.r = 1, far.g = 2, far.b = 3;
  nowhere.r = 4, nowhere.g = 5, nowhere.b = 6;
  far.x = 9;
  nowhere.y = std::nanf("");
  cloud->insert(cloud->begin() + 10, far);
  cloud->push_back(nowhere);
  cloud->width = 2;
  cloud->height = 501;
  SLIMColorizer<Painted> colorizer;
  colorizer.setInputCloud(cloud);
  colorizer.setSurface(paintedSphere());
  RgbCloud colored;
  ASSERT_TRUE(colorizer.colorize(colored)) << colorizer.getError().message;
  EXPECT_EQ(colored.width, 2u);
  EXPECT_EQ(colored.height, 501u);
  EXPECT_EQ(colored.header.frame_id, "map");
  EXPECT_EQ(colored.sensor_origin_, cloud->sensor_origin_);
  EXPECT_FALSE(colored.is_dense);
  EXPECT_EQ(colorizer.getUnsupported(), pcl::Indices{10});
  const auto rgbOf = [](const Painted& p) { return std::array<int, 3>{p.r, p.g, p.b}; };
  EXPECT_EQ(rgbOf(colored[10]), (std::array<int, 3>{1, 2, 3}));
  EXPECT_TRUE(std::isnan(colored[1001].y));
  EXPECT_EQ(rgbOf(colored[1001]), (std::array<int, 3>{4, 5, 6}));

  auto plain = std::make_shared<pcl::PointCloud<Plain>>();
  pcl::copyPointCloud(*cloud, *plain);
  SLIMColorizer<Plain> whitener;
  whitener.setInputCloud(plain);
  whitener.setSurface(paintedSphere());
  auto indices = std::make_shared<pcl::Indices>(pcl::Indices{1001, 5, 10, 5});
  whitener.setIndices(indices);
  RgbCloud chosen;
  ASSERT_TRUE(whitener.colorize(chosen)) << whitener.getError().message;
  ASSERT_EQ(chosen.size(), 4u);
  EXPECT_EQ(rgbOf(chosen[0]), (std::array<int, 3>{255, 255, 255}));
  EXPECT_EQ(rgbOf(chosen[2]), (std::array<int, 3>{255, 255, 255}));
  EXPECT_EQ(rgbOf(chosen[1]), rgbOf(colored[5]));
  EXPECT_EQ(rgbOf(chosen[3]), rgbOf(colored[5]));
}

TEST(SLIMColorizer, NormalsChooseTheSideOfAThinPlate) {
  // Red above, blue below, .006 apart: half a spacing.
  auto scan = std::make_shared<pcl::PointCloud<pcl::PointXYZRGBNormal>>();
  for (int i = 0; i < 80; ++i) {
    for (int j = 0; j < 80; ++j) {
      for (const float side : {1.0f, -1.0f}) {
        pcl::PointXYZRGBNormal p;
        p.x = static_cast<float>(i) / 79;
        p.y = static_cast<float>(j) / 79;
        p.z = 0.003f * side;
        p.normal_z = side;
        p.r = side > 0 ? 200 : 0;
        p.b = side > 0 ? 0 : 200;
        scan->push_back(p);
      }
    }
  }
  SLIMFit<pcl::PointXYZRGBNormal> fit;
  fit.setInputCloud(scan);
  const auto surface = std::make_shared<SLIMSurface>();
  ASSERT_TRUE(fit.fit(*surface)) << fit.getError().message;
  // Points on the plate's middle have no nearer side; their normals give one.
  RgbCloud colored;
  for (const float side : {1.0f, -1.0f}) {
    auto middle = std::make_shared<pcl::PointCloud<pcl::PointNormal>>();
    for (int i = 0; i < 400; ++i) {
      pcl::PointNormal p;
      p.x = 0.1f + 0.04f * static_cast<float>(i % 20);
      p.y = 0.1f + 0.04f * static_cast<float>(i / 20);
      p.normal_z = side;
      middle->push_back(p);
    }
    SLIMColorizer<pcl::PointNormal> colorizer;
    colorizer.setInputCloud(middle);
    colorizer.setSurface(surface);
    ASSERT_TRUE(colorizer.colorize(colored)) << colorizer.getError().message;
    for (const Painted& p : colored) EXPECT_GT(side > 0 ? p.r : p.b, 150) << side;
  }
  // Points on the lower side, without normals: its colour, wherever they are seen from.
  auto below = std::make_shared<pcl::PointCloud<Plain>>();
  for (const auto& p : *scan)
    if (p.z < 0) below->push_back({p.x, p.y, p.z});
  SLIMColorizer<Plain> plain;
  plain.setInputCloud(below);
  plain.setSurface(surface);
  plain.setViewPoint(0, 0, 9);
  ASSERT_TRUE(plain.colorize(colored)) << plain.getError().message;
  for (const Painted& p : colored) EXPECT_GT(p.b, 150);
}

TEST(SLIMColorizer, NeedsColours) {
  SLIMColorizer<Plain> colorizer;
  colorizer.setInputCloud(bumpySphere<Plain>(500));
  RgbCloud colored(3, 1);
  EXPECT_FALSE(colorizer.colorize(colored));
  EXPECT_TRUE(colored.empty());
  EXPECT_NE(colorizer.getError().message.find("call setSurface()"), std::string::npos);
  SLIMSurface bare = *paintedSphere();
  bare.colors.clear();
  bare.dropTextures();
  colorizer.setSurface(bare);
  EXPECT_FALSE(colorizer.colorize(colored));
  EXPECT_NE(colorizer.getError().message.find("has no colours"), std::string::npos);
  const auto elsewhere = bumpySphere<Plain>(500);
  for (Plain& p : *elsewhere) p.x += 50;
  colorizer.setInputCloud(elsewhere);
  colorizer.setSurface(paintedSphere());
  EXPECT_FALSE(colorizer.colorize(colored)) << "another object's surface";
}

}  // namespace
}  // namespace pcl_slim

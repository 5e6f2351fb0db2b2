// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/color_octree_splat_sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <set>
#include <string>

#include "door_suite.h"
#include "pcl_slim/filters/io/splat_files.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

template <typename PointT>
struct SamplerDoor {
  using Point = PointT;
  using Door = ColorOctreeSplatSampler<PointT>;
  static constexpr bool kPrints = false;

  static bool run(Door& door, std::vector<unsigned char>& output) {
    pcl::PointCloud<pcl::PointSurfel> splats;
    splats.resize(3);
    const bool done = door.sample(splats);
    output.clear();
    for (const pcl::PointSurfel& p : splats) {
      const auto* bytes = reinterpret_cast<const unsigned char*>(p.data);
      output.insert(output.end(), bytes, bytes + 3 * sizeof(float));
      for (const float value : {p.normal_x, p.normal_y, p.normal_z, p.radius, p.confidence}) {
        unsigned char raw[sizeof(float)];
        std::memcpy(raw, &value, sizeof(value));
        output.insert(output.end(), raw, raw + sizeof(raw));
      }
      output.insert(output.end(), {p.r, p.g, p.b, p.a});
    }
    return done;
  }
};

/** A sphere, red above and blue below. */
pcl::PointCloud<pcl::PointXYZRGBNormal>::Ptr twoColours(std::size_t count) {
  auto cloud = bumpySphere<pcl::PointXYZRGBNormal>(count);
  for (auto& p : *cloud) {
    p.r = p.x + 0.3f * p.y + 0.2f * p.z > 0 ? 230 : 30;
    p.g = 40;
    p.b = p.x + 0.3f * p.y + 0.2f * p.z > 0 ? 20 : 210;
  }
  return cloud;
}

TEST(ColorOctreeSplatSampler, SamplesEveryCompiledPointType) {
  const auto samples = [](auto point) {
    using Point = decltype(point);
    ColorOctreeSplatSampler<Point> sampler;
    const auto cloud = bumpySphere<Point>(5000);
    sampler.setInputCloud(cloud);
    pcl::PointCloud<pcl::PointSurfel> splats;
    EXPECT_TRUE(sampler.sample(splats)) << sampler.getError().message;
    EXPECT_GT(splats.size(), 50u);
    EXPECT_LT(splats.size(), 2500u);
    EXPECT_EQ(splats.width, splats.size());
    for (const auto& p : splats) {
      EXPECT_NEAR(p.getNormalVector3fMap().norm(), 1.0f, 1e-5f);
      EXPECT_GT(p.radius, 0.0f);
      EXPECT_NEAR(p.getVector3fMap().norm(), 1.0f, 0.12f);
    }
    EXPECT_EQ(sampler.getStatistics().points, 5000u);
    EXPECT_EQ(sampler.getStatistics().normals_estimated, !pcl::traits::has_normal<Point>::value);
  };
  samples(pcl::PointXYZ());
  samples(pcl::PointXYZI());
  samples(pcl::PointXYZRGB());
  samples(pcl::PointXYZRGBA());
  samples(pcl::PointNormal());
  samples(pcl::PointXYZINormal());
  samples(pcl::PointXYZRGBNormal());
}

TEST(ColorOctreeSplatSampler, ColoursDivideAndComeOut) {
  ColorOctreeSplatSampler<pcl::PointXYZRGBNormal> sampler;
  sampler.setInputCloud(twoColours(20000));
  pcl::PointCloud<pcl::PointSurfel> splats;
  ASSERT_TRUE(sampler.sample(splats));
  const std::size_t with_colour = splats.size();
  std::size_t pure = 0;
  for (const auto& p : splats) {
    EXPECT_EQ(p.a, 255);
    pure += (p.r == 230 && p.g == 40 && p.b == 20) || (p.r == 30 && p.g == 40 && p.b == 210);
  }
  EXPECT_GT(pure, splats.size() * 85 / 100);
  sampler.setColorErrorDeltaE(100.0);
  ASSERT_TRUE(sampler.sample(splats));
  EXPECT_LT(splats.size(), with_colour);
}

TEST(ColorOctreeSplatSampler, NormalsComeFromTheBestSource) {
  const auto full = twoColours(8000);
  auto plain = std::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>();
  auto normals = std::make_shared<pcl::PointCloud<pcl::Normal>>();
  pcl::copyPointCloud(*full, *plain);
  pcl::copyPointCloud(*full, *normals);
  ColorOctreeSplatSampler<pcl::PointXYZRGBNormal> fields;
  ColorOctreeSplatSampler<pcl::PointXYZRGB> given;
  fields.setInputCloud(full);
  given.setInputCloud(plain);
  given.setInputNormals(normals);
  pcl::Indices from_fields, from_cloud;
  ASSERT_TRUE(fields.filter(from_fields));
  ASSERT_TRUE(given.filter(from_cloud));
  EXPECT_EQ(from_fields, from_cloud);
  normals->resize(5);
  EXPECT_FALSE(given.filter(from_cloud));
  EXPECT_TRUE(from_cloud.empty());
}

TEST(ColorOctreeSplatSampler, FiltersLikePclsFilters) {
  const auto cloud = twoColours(6000);
  (*cloud)[17].z = std::nanf("");
  cloud->is_dense = false;
  cloud->header.frame_id = "scanner";
  ColorOctreeSplatSampler<pcl::PointXYZRGBNormal> sampler(true);
  sampler.setInputCloud(cloud);
  pcl::Indices kept, again, rest;
  ASSERT_TRUE(sampler.filter(kept));
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  EXPECT_EQ(kept.size(), sampler.getStatistics().splats);
  EXPECT_EQ(kept.size() + sampler.getRemovedIndices()->size(), cloud->size());
  ASSERT_TRUE(sampler.filter(again));
  ASSERT_TRUE(sampler.filter(again)) << "a second run appends nothing";
  EXPECT_EQ(kept, again);
  EXPECT_EQ(sampler.getRemovedIndices()->size(), cloud->size() - kept.size());

  sampler.setNegative(true);
  ASSERT_TRUE(sampler.filter(rest));
  std::set<int> all(kept.begin(), kept.end());
  all.insert(rest.begin(), rest.end());
  EXPECT_EQ(all.size(), kept.size() + rest.size());
  EXPECT_EQ(all.size(), cloud->size() - 1) << "the point that is not finite is on neither side";
  sampler.setNegative(false);

  pcl::PointCloud<pcl::PointXYZRGBNormal> output;
  ASSERT_TRUE(sampler.filter(output));
  ASSERT_EQ(output.size(), kept.size());
  EXPECT_EQ(output.header.frame_id, "scanner");
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const auto& p = (*cloud)[static_cast<std::size_t>(kept[i])];
    EXPECT_EQ(output[i].x, p.x);
    EXPECT_EQ(output[i].rgba, p.rgba);
  }
}

TEST(ColorOctreeSplatSampler, KeepsAnOrganizedCloudsShape) {
  auto cloud = twoColours(6000);
  cloud->width = 100;
  cloud->height = 60;
  ColorOctreeSplatSampler<pcl::PointXYZRGBNormal> sampler;
  sampler.setInputCloud(cloud);
  sampler.setKeepOrganized(true);
  pcl::PointCloud<pcl::PointXYZRGBNormal> output;
  ASSERT_TRUE(sampler.filter(output));
  EXPECT_EQ(output.width, 100u);
  EXPECT_EQ(output.height, 60u);
  EXPECT_FALSE(output.is_dense);
  std::size_t finite = 0;
  for (const auto& p : output) finite += std::isfinite(p.x) ? 1 : 0;
  EXPECT_EQ(finite, sampler.getStatistics().splats);
}

TEST(ColorOctreeSplatSampler, OutputMayBeTheInput) {
  auto cloud = twoColours(4000);
  ColorOctreeSplatSampler<pcl::PointXYZRGBNormal> sampler;
  sampler.setInputCloud(cloud);
  pcl::Indices kept;
  ASSERT_TRUE(sampler.filter(kept));
  ASSERT_TRUE(sampler.filter(*cloud));
  EXPECT_EQ(cloud->size(), kept.size());
}

TEST(ColorOctreeSplatSampler, OutputsAreClearedOnFailure) {
  ColorOctreeSplatSampler<pcl::PointXYZ> sampler;
  pcl::Indices indices = {1, 2, 3};
  pcl::PointCloud<pcl::PointXYZ> cloud;
  cloud.resize(4);
  SplatSet splats;
  splats.resize(2, true);
  EXPECT_FALSE(sampler.filter(indices));
  EXPECT_TRUE(indices.empty());
  EXPECT_FALSE(sampler.filter(cloud));
  EXPECT_TRUE(cloud.empty());
  EXPECT_TRUE(sampler.getError());
  EXPECT_FALSE(sampler.sample(splats));
  EXPECT_TRUE(splats.empty());
  sampler.setInputCloud(bumpySphere<pcl::PointXYZ>(300));
  sampler.setGeometricError(-1.0);
  cloud.resize(4);
  EXPECT_FALSE(sampler.filter(cloud));
  EXPECT_TRUE(cloud.empty());
  EXPECT_EQ(sampler.getError().code, ErrorCode::kBadArgument);
}

TEST(ColorOctreeSplatSampler, PclsVerbsPrintAnErrorOnce) {
  ColorOctreeSplatSampler<pcl::PointXYZ> sampler;
  pcl::FilterIndices<pcl::PointXYZ>& base = sampler;
  pcl::Indices indices;
  pcl::PointCloud<pcl::PointXYZ> cloud;
  const auto expectOnce = [&](const char* verb, const auto& run) {
    testing::internal::CaptureStderr();
    run();
    const std::string printed = testing::internal::GetCapturedStderr();
    EXPECT_EQ(std::count(printed.begin(), printed.end(), '\n'), 1) << verb << ": " << printed;
    EXPECT_NE(printed.find(sampler.getError().message), std::string::npos) << verb;
    EXPECT_TRUE(sampler.getError()) << verb;
  };
  expectOnce("filter(indices) without input", [&] { sampler.filter(indices); });
  expectOnce("filter(cloud) without input", [&] { sampler.filter(cloud); });
  sampler.setInputCloud(bumpySphere<pcl::PointXYZ>(300));
  sampler.setGeometricError(-1.0);
  expectOnce("filter(indices)", [&] { sampler.filter(indices); });
  expectOnce("filter(cloud)", [&] { sampler.filter(cloud); });
  sampler.setKeepOrganized(true);
  expectOnce("filter(cloud), organized", [&] { sampler.filter(cloud); });
  sampler.setKeepOrganized(false);
  expectOnce("PCL's filter(indices)", [&] { base.filter(indices); });
  expectOnce("PCL's filter(cloud)", [&] { base.filter(cloud); });
}

TEST(ColorOctreeSplatSampler, SettersReachTheSampler) {
  ColorOctreeSplatSampler<pcl::PointXYZRGBNormal> sampler;
  sampler.setInputCloud(twoColours(20000));
  pcl::Indices kept;
  sampler.setMaxSplats(600);
  ASSERT_TRUE(sampler.filter(kept));
  EXPECT_LE(kept.size(), 600u);
  EXPECT_GE(kept.size(), 580u);
  sampler.setMaxSplats(0);
  sampler.setTargetError(3.0);
  ASSERT_TRUE(sampler.filter(kept));
  EXPECT_LE(sampler.getStatistics().error, 3.0);
  sampler.setTargetError(0.0);
  sampler.setInitialResolution(10);
  sampler.setMaxDepth(0);
  ASSERT_TRUE(sampler.filter(kept));
  EXPECT_EQ(sampler.getStatistics().resolution, 10);
  EXPECT_EQ(kept.size(), sampler.getStatistics().roots);
  sampler.setColorErrorDeltaE(7.0);
  EXPECT_DOUBLE_EQ(sampler.getColorError(), 0.07);
  sampler.setMaxDepth(20);
  sampler.setMinPointsPerCell(1000000);
  ASSERT_TRUE(sampler.filter(kept));
  EXPECT_EQ(kept.size(), sampler.getStatistics().roots);
}

TEST(ColorOctreeSplatSampler, EstimatedNormalsFaceSensorOrViewPoint) {
  auto cloud = bumpySphere<pcl::PointXYZ>(4000);
  cloud->sensor_origin_ = Eigen::Vector4f(0, 0, 50, 0);
  ColorOctreeSplatSampler<pcl::PointXYZ> sampler;
  sampler.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointSurfel> splats;
  for (const double z : {50.0, -50.0}) {
    if (z < 0) sampler.setViewPoint(0, 0, z);
    ASSERT_TRUE(sampler.sample(splats));
    for (const auto& p : splats) {
      if (std::abs(p.z) > 0.5f) {
        EXPECT_GT(p.normal_z * z, 0.0);
      }
    }
  }
}

TEST(SplatConversion, ShiftsOnlyWhereFloatIsTooCoarse) {
  SplatSet splats;
  splats.resize(3, true);
  for (std::size_t i = 0; i < 3; ++i) {
    splats.x[i] = 0.25f * static_cast<float>(i);
    splats.y[i] = splats.z[i] = 0.5f;
    splats.nx[i] = splats.ny[i] = 0.0f;
    splats.nz[i] = 1.0f;
    splats.radius[i] = 0.01f;
    splats.rgb[i] = 0x102030u;
    splats.confidence[i] = 5;
    splats.normal_variance[i] = 0;
    splats.gradient[i] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  }
  EXPECT_EQ(splatShift(splats), (std::array<double, 3>{}));
  EXPECT_EQ(splatShift(SplatSet()), (std::array<double, 3>{}));
  splats.origin = {637080.0, 4918340.25, 415.0};
  // Multiples of four diagonals, rounded up to a power of two.
  EXPECT_EQ(splatShift(splats), (std::array<double, 3>{637080.0, 4918340.0, 416.0}));
  const PointFile file = toPointFile(splats, splatShift(splats));
  ASSERT_EQ(numPoints(file.cloud), 3u);
  const char* names[] = {"x",    "y",      "z",          "normal_x",  "normal_y", "normal_z",
                         "rgba", "radius", "confidence", "curvature", "red_x"};
  for (int i = 0; i < 11; ++i) EXPECT_EQ(findField(file.cloud, names[i]), i);
  EXPECT_EQ(fieldValue(file.cloud, 2, file.cloud.fields[0]), 0.5);
  EXPECT_EQ(fieldValue(file.cloud, 1, file.cloud.fields[6]), 0xff102030u);
  EXPECT_EQ(fieldValue(file.cloud, 1, file.cloud.fields[18]), 9.0);
  EXPECT_EQ(file.comments[2], "pcl_slim shift 637080 4918340 416");
}

}  // namespace
}  // namespace pcl_slim

namespace pcl_slim_test {

using SamplerDoors = testing::Types<pcl_slim::SamplerDoor<pcl::PointXYZ>,
                                    pcl_slim::SamplerDoor<pcl::PointXYZRGBNormal>>;
INSTANTIATE_TYPED_TEST_SUITE_P(ColorOctreeSplatSampler, DoorSuite, SamplerDoors);

}  // namespace pcl_slim_test

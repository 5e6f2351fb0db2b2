// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/pcl_conversion.h"

#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include "pcl_slim/filters/io/splat_conversion.h"
#include "support/temporary_folder.h"

namespace pcl_slim {
namespace {

using pcl_slim_test::TemporaryFolder;

pcl::PointCloud<pcl::PointXYZRGB> organizedCloud() {
  pcl::PointCloud<pcl::PointXYZRGB> cloud(3, 2);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud[i].x = static_cast<float>(i);
    cloud[i].rgba = 0x00102030u + static_cast<std::uint32_t>(i);
  }
  cloud.sensor_origin_ = Eigen::Vector4f(1, 2, 3, 0);
  cloud.sensor_orientation_ = Eigen::Quaternionf(0.5f, -0.5f, 0.5f, 0.5f);
  return cloud;
}

TEST(PclConversion, CloudsComeBackWithRowsColoursAndPose) {
  const auto cloud = organizedCloud();
  const PointFile file = toPointFile(cloud);
  EXPECT_TRUE(file.hasSensorPose());
  EXPECT_EQ(numPoints(file.cloud), 6u);
  pcl::PointCloud<pcl::PointXYZRGB> again;
  toPCL(file, again);
  ASSERT_EQ(again.width, 3u);
  ASSERT_EQ(again.height, 2u);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(again[i].x, cloud[i].x);
    EXPECT_EQ(again[i].g, cloud[i].g);
    EXPECT_EQ(again[i].b, cloud[i].b);
  }
  EXPECT_EQ(again.sensor_origin_, cloud.sensor_origin_);
  EXPECT_EQ(again.sensor_orientation_.coeffs(), cloud.sensor_orientation_.coeffs());
}

TEST(PclConversion, FilesAreThoseThatPclReads) {
  const TemporaryFolder folder;
  const auto cloud = organizedCloud();
  ASSERT_FALSE(savePointFile(folder / "a.pcd", toPointFile(cloud)));
  pcl::PCLPointCloud2 read;
  Eigen::Vector4f origin;
  Eigen::Quaternionf orientation;
  int version = 0;
  ASSERT_EQ(pcl::PCDReader().read(folder / "a.pcd", read, origin, orientation, version), 0);
  EXPECT_EQ(origin, cloud.sensor_origin_);
  EXPECT_EQ(orientation.coeffs(), cloud.sensor_orientation_.coeffs());
  const auto file = loadPointFile(folder / "a.pcd");
  ASSERT_TRUE(file) << file.error().message;
  const pcl::PCLPointCloud2 ours = toPCL(file->cloud);
  EXPECT_EQ(ours.data, read.data);
  EXPECT_EQ(ours.row_step, read.row_step);
  ASSERT_EQ(ours.fields.size(), read.fields.size());
  for (std::size_t i = 0; i < ours.fields.size(); ++i) {
    EXPECT_EQ(ours.fields[i].name, read.fields[i].name);
    EXPECT_EQ(ours.fields[i].offset, read.fields[i].offset);
    EXPECT_EQ(ours.fields[i].datatype, read.fields[i].datatype);
    EXPECT_EQ(ours.fields[i].count, read.fields[i].count);
  }
}

TEST(PclConversion, BytesBetweenRowsAreLeftOut) {
  pcl::PCLPointCloud2 cloud;
  cloud.fields.resize(1);
  cloud.fields[0].name = "intensity";
  cloud.fields[0].datatype = kUInt8;
  cloud.fields[0].count = 1;
  cloud.width = cloud.height = 2;
  cloud.point_step = 1;
  cloud.row_step = 5;
  cloud.data = {1, 2, 0, 0, 0, 3, 4, 0, 0, 0};
  const PointTable table = toPointTable(cloud);
  EXPECT_EQ(table.data, (std::vector<std::uint8_t>{1, 2, 3, 4}));
  EXPECT_EQ(fieldValue(table, 3, table.fields[0]), 4.0);
  EXPECT_EQ(findField(cloud, "intensity"), 0) << "PCL's own type has the same look-up";
}

TEST(PclConversion, SplatsAreSurfels) {
  SplatSet splats;
  splats.resize(2, true);
  splats.origin = {100, 0, 0};
  splats.x[1] = 0.25f;
  splats.nz = {1, -1};
  splats.radius = {0.5f, 2};
  splats.rgb = {0x102030u, 0xffffffu};
  pcl::PointCloud<pcl::PointSurfel> surfels;
  toPCL(splats, {64, 0, 0}, surfels);
  ASSERT_EQ(surfels.size(), 2u);
  EXPECT_EQ(surfels[1].x, 36.25f);
  EXPECT_EQ(surfels[1].normal_z, -1.0f);
  EXPECT_EQ(surfels[1].radius, 2.0f);
  EXPECT_EQ(surfels[0].rgba, 0xff102030u);
  EXPECT_TRUE(surfels.is_dense);
}

}  // namespace
}  // namespace pcl_slim

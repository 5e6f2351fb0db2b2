// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/slim_crest_lines.h"

#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>

#include <cmath>
#include <limits>
#include <memory>

#include "pcl_slim/filters/io/crest_files.h"
#include "support/sphere_surface.h"

namespace {

using namespace pcl_slim;
using PointCloud = pcl::PointCloud<pcl::PointXYZ>;

/** An ellipsoid with axes 1, .8 and .5 about a centre; one ridge, the ellipse around it. */
PointCloud::Ptr ellipsoid(int count, const Eigen::Vector3f& center = {0, 0, 0}) {
  auto cloud = std::make_shared<PointCloud>();
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * i + 1) / count, r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
    cloud->push_back({static_cast<float>(r * std::cos(a)) + center[0],
                      static_cast<float>(0.8 * r * std::sin(a)) + center[1],
                      static_cast<float>(0.5 * z) + center[2]});
  }
  return cloud;
}

TEST(SLIMCrestLines, FindsTheRidgeOfAnEllipsoid) {
  SLIMCrestLines<pcl::PointXYZ> crest;
  crest.setInputCloud(ellipsoid(10000, {3, 0, 0}));
  CrestLines lines;
  ASSERT_TRUE(crest.compute(lines)) << crest.getError().message;
  ASSERT_GE(lines.numLines(), 1u);
  EXPECT_EQ(lines.type[0], CrestType::kRidge);
  EXPECT_NEAR(lines.length[0], 5.672, 0.02);
  for (std::uint32_t v = 0; v < lines.line_begin[1]; ++v) {
    const double x = lines.position[v][0] - 3, y = lines.position[v][1] / 0.8;
    EXPECT_NEAR(std::hypot(x, y), 1, 1e-3);
  }
  EXPECT_GT(crest.getCrestStatistics().seeds, 0u);
  EXPECT_GT(crest.getStatistics().leaves, 0u);

  // From the surface fitted before: the same lines.
  SLIMCrestLines<pcl::PointXYZ> again;
  again.setInputCloud(crest.getInputCloud());
  again.setSurface(crest.getFittedSurface());
  CrestLines same;
  ASSERT_TRUE(again.compute(same));
  EXPECT_EQ(same.position, lines.position);
  EXPECT_EQ(again.getFittedSurface(), nullptr);
}

TEST(SLIMCrestLines, GivesPointsWithTheCloudsHeader) {
  SLIMCrestLines<pcl::PointXYZ> crest;
  auto cloud = ellipsoid(5000);
  cloud->header.frame_id = "table";
  cloud->push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  crest.setInputCloud(cloud);
  pcl::PointCloud<PointCrest> points;
  ASSERT_TRUE(crest.compute(points));
  EXPECT_EQ(points.header.frame_id, "table");
  ASSERT_GT(points.size(), 50u);
  EXPECT_EQ(points[0].line, 0u);
  EXPECT_EQ(points[0].type, 0u);
  EXPECT_GT(points[0].strength, 1.0f);
  EXPECT_GT(points[0].k1, std::abs(points[0].k2));
  EXPECT_EQ(crest.getInputStatistics().non_finite, 1u);
}

TEST(SLIMCrestLines, ErrorsAreToldAndLeaveNothing) {
  SLIMCrestLines<pcl::PointXYZ> crest;
  CrestLines lines;
  lines.position.resize(3);
  EXPECT_FALSE(crest.compute(lines));
  EXPECT_EQ(lines.numVertices(), 0u);
  EXPECT_NE(crest.getError().message.find("setInputCloud"), std::string::npos);
  crest.setInputCloud(ellipsoid(2000));
  crest.setLineTypes(false, false);
  EXPECT_FALSE(crest.compute(lines));
  EXPECT_EQ(crest.getError().code, ErrorCode::kBadArgument);
  crest.setLineTypes(true, true);
  crest.setStep(3);
  EXPECT_FALSE(crest.compute(lines));
  crest.setStep(0.15);
  crest.setSurface(std::make_shared<SLIMSurface>(pcl_slim_test::sphereSurface(2, 50)));
  EXPECT_FALSE(crest.compute(lines));
  EXPECT_NE(crest.getError().message.find("another cloud"), std::string::npos);
  crest.setSurface(nullptr);
  crest.setProgressCallback([&](float, const char*) { crest.cancel(); });
  EXPECT_FALSE(crest.compute(lines));
  EXPECT_EQ(crest.getError().code, ErrorCode::kCancelled);
  crest.setProgressCallback({});
  EXPECT_TRUE(crest.compute(lines)) << crest.getError().message;
  crest.cancel();  // too late
  EXPECT_TRUE(crest.compute(lines)) << crest.getError().message;
}

/** Two lines: three vertices open, and a closed triangle behind it. */
CrestLines twoLines(double far) {
  CrestLines lines;
  for (int i = 0; i < 6; ++i) {
    const double x = i % 3 == 1 ? 1 : 0, y = i % 3 == 2 ? 1 : 0;
    lines.position.push_back({far + x, y, i < 3 ? 0.0 : -1.0});
    lines.normal.push_back({0, 0, 1});
    lines.tangent.push_back({1, 0, 0});
    for (auto* column : {&lines.k1, &lines.prominence, &lines.significance, &lines.radius}) {
      column->push_back(1.0f);
    }
    lines.k2.push_back(-1.0f);
  }
  lines.line_begin = {0, 3, 6};
  lines.type = {CrestType::kRidge, CrestType::kRavine};
  lines.closed = {0, 1};
  lines.length = {2.4, 3.4};
  lines.strength = {2.0, 1.0};
  lines.mean_significance = {5.0, 5.0};
  return lines;
}

std::string textOf(const std::string& path) {
  const auto bytes = pcl_slim_test::fileBytes(path);
  return {bytes.begin(), bytes.end()};
}

TEST(CrestFiles, EveryFormatHoldsTheLines) {
  const pcl_slim_test::TemporaryFolder folder;
  const CrestLines lines = twoLines(0);
  for (const char* name : {"a.vtp", "a.ply", "a.pcd", "a.svg"}) {
    EXPECT_FALSE(saveCrestLines(folder / name, lines)) << name;
  }
  pcl::PointCloud<PointCrest> loaded;
  ASSERT_EQ(pcl::io::loadPCDFile(folder / "a.pcd", loaded), 0);
  ASSERT_EQ(loaded.size(), 6u);
  EXPECT_EQ(loaded[5].line, 1u);
  EXPECT_EQ(loaded[5].type, 1u);
  const std::string ply = textOf(folder / "a.ply"), vtp = textOf(folder / "a.vtp");
  EXPECT_NE(ply.find("element edge 5\nproperty int vertex1\nproperty int vertex2\nend_header"),
            std::string::npos);
  // Five edges of two numbers end the file: the last one closes the triangle.
  std::int32_t last[2];
  std::memcpy(last, ply.data() + ply.size() - sizeof(last), sizeof(last));
  EXPECT_EQ(last[0], 5);
  EXPECT_EQ(last[1], 3);
  const auto file = loadPointFile(folder / "a.ply");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(numPoints(file->cloud), 6u);
  EXPECT_NE(vtp.find("NumberOfLines=\"2\""), std::string::npos);
  EXPECT_NE(vtp.find("Name=\"strength\""), std::string::npos);
  EXPECT_EQ(saveCrestLines(folder / "a.obj", lines).code, ErrorCode::kBadArgument);
  EXPECT_EQ(folder.numFiles(), 4u);
}

TEST(CrestFiles, FarCoordinatesStayDouble) {
  EXPECT_EQ(toPointFile(twoLines(0)).cloud.fields[0].datatype, kFloat32);
  EXPECT_EQ(toPointFile(twoLines(5e6)).cloud.fields[0].datatype, kFloat64);
}

TEST(CrestFiles, APictureShowsEachSideInItsColour) {
  const CrestLines lines = twoLines(0);
  const auto paths = [](const std::string& svg, const char* color) {
    const std::size_t group = svg.find(color), end = svg.find("</g>", group);
    std::size_t count = 0;
    for (std::size_t at = svg.find("<path", group); at < end; at = svg.find("<path", at + 1))
      ++count;
    return count;
  };
  const std::string front = crestSvg(lines, {});
  EXPECT_EQ(paths(front, "#1f4fb4"), 1u);
  EXPECT_EQ(paths(front, "#c0281e"), 1u);
  CrestView behind;
  behind.toward_viewer = {0, 0, -1};
  const std::string back = crestSvg(lines, behind);
  EXPECT_EQ(paths(back, "#1f4fb4"), 1u);
  CrestView bad;
  bad.up = {0, 0, 2};
  const pcl_slim_test::TemporaryFolder folder;
  EXPECT_EQ(saveCrestLines(folder / "a.svg", lines, bad).code, ErrorCode::kBadArgument);
}

TEST(CrestFiles, WhatLiesBehindTheSurfaceIsLeftOut) {
  SLIMCrestLines<pcl::PointXYZ> crest;
  crest.setInputCloud(ellipsoid(5000));
  CrestLines lines;
  ASSERT_TRUE(crest.compute(lines));
  CrestView view;
  view.toward_viewer = {0, 1, 0};
  view.up = {0, 0, 1};
  const std::string all = crestSvg(lines, view);
  view.surface = crest.getFittedSurface().get();
  const std::string seen = crestSvg(lines, view);
  // Half of the ellipse is on the far side.
  EXPECT_LT(seen.size(), 0.75 * static_cast<double>(all.size()));
  EXPECT_GT(seen.size(), 0.3 * static_cast<double>(all.size()));
}

}  // namespace

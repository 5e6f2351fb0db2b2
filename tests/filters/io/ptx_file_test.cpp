// SPDX-License-Identifier: BSD-3-Clause
// PTX files: coordinates that the scans share, rows and columns, and where the scanners were.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "filters/io/point_values.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

/** A scan's head: turned by 90 degrees about z, (x, y) to (-y, x), and moved to (10, 20, 1.5). */
std::string turnedHead(const std::string& columns, const std::string& rows) {
  return columns + "\n" + rows +
         "\n10 20 1.5\n0 1 0\n-1 0 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 1.5 1\n";
}

TEST(PtxFile, OneScanKeepsItsRowsAndItsSensor) {
  const auto file = loadText("a.PTX", turnedHead("2", "3") +
                                          "1 2 3 0.5 9 8 7\n0 0 0 0.5 0 0 0\n1 0 0 0.25 1 2 3\n"
                                          "0 1 0 1 1 2 3\n2 0 0 1 1 2 3\n0 0 1 1 1 2 3\n");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->cloud.height, 2u) << "a column of the scan is a row of the cloud";
  EXPECT_EQ(file->cloud.width, 3u);
  EXPECT_EQ(value(*file, "x", 0), 10 - 2);
  EXPECT_EQ(value(*file, "y", 0), 20 + 1);
  EXPECT_EQ(value(*file, "z", 0), 1.5 + 3);
  EXPECT_TRUE(std::isnan(value(*file, "x", 1))) << "a direction without a point";
  EXPECT_EQ(value(*file, "intensity", 2), 0.25);
  const auto& rgb = file->cloud.fields[static_cast<std::size_t>(findField(file->cloud, "rgb"))];
  EXPECT_EQ(file->cloud.data[rgb.offset + 2], 9);
  EXPECT_EQ(file->sensor_origin, (std::array<float, 3>{10, 20, 1.5f}));
  EXPECT_FLOAT_EQ(file->sensor_orientation[0], std::sqrt(0.5f));
  EXPECT_FLOAT_EQ(file->sensor_orientation[3], std::sqrt(0.5f)) << "a turn about z by 90 degrees";
}

TEST(PtxFile, SeveralScansGiveEachPointItsSensor) {
  const std::string still =
      "1\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n4 5 6 0.5\n7 8 9 1\n";
  const auto file = loadText("a.ptx", turnedHead("1", "1") + "1 2 3 0.5\n" + still);
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(numPoints(file->cloud), 3u);
  EXPECT_EQ(file->cloud.height, 1u);
  EXPECT_FALSE(file->hasSensorPose());
  EXPECT_EQ(value(*file, "vp_y", 0), 20);
  EXPECT_EQ(value(*file, "vp_y", 1), 0);
  EXPECT_EQ(value(*file, "frame", 0), 0);
  EXPECT_EQ(value(*file, "frame", 2), 1);
  EXPECT_EQ(value(*file, "x", 2), 7);
}

TEST(PtxFile, DefectsAreNamedInOneLine) {
  const std::pair<std::string, const char*> cases[] = {
      {turnedHead("1", "2") + "1 2 3 0.5\n", "ends in point 2 of 2"},
      {turnedHead("1", "2") + "1 2 3 0.5\n2\n", "another scan"},
      {turnedHead("1", "1") + "1 2 three 0.5\n", "line 11"},
      {turnedHead("1", "1") + "1 2\n", "2 numbers"},
      {turnedHead("1.5", "1"), "no number of columns"},
      {turnedHead("90000", "90000"), "2^32"},
      {"1\n1\n0 0 0\n", "truncated"},
      {"1\n1\n0 0 0 0\n", "has 4 numbers where"},
      {"\n", "no scan"},
  };
  for (const auto& [text, words] : cases) {
    const auto file = loadText("a.ptx", text);
    ASSERT_FALSE(file) << text;
    EXPECT_NE(file.error().message.find(words), std::string::npos) << file.error().message;
    EXPECT_EQ(file.error().message.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace pcl_slim

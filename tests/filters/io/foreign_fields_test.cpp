// SPDX-License-Identifier: BSD-3-Clause
// Fields as other programs write them: padding of no values, names in capitals, data that were not
// compressed, colours up to 255, Gaussian splats.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "filters/io/point_values.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/filters/io/record_layout.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

std::string floatsOf(std::initializer_list<float> values) {
  std::string bytes(sizeof(float) * values.size(), '\0');
  std::memcpy(bytes.data(), values.begin(), bytes.size());
  return bytes;
}

TEST(ForeignPcd, FieldsOfNoValuesTakeNoBytes) {
  const std::string head =
      "VERSION 0.7\nFIELDS x y z _ intensity _\nSIZE 4 4 4 1 4 1\nTYPE F F F U F U\n"
      "COUNT 1 1 1 0 1 0\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ";
  for (const std::string& data : {"binary\n" + floatsOf({1, 2, 3, 7, 4, 5, 6, 8}),
                                  std::string("ascii\n1 2 3 7\n4 5 6 8\n")}) {
    const auto file = loadText("a.pcd", head + data);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->cloud.fields.size(), 4u);
    EXPECT_EQ(value(*file, "z", 1), 6);
    EXPECT_EQ(value(*file, "intensity", 1), 8);
  }
}

TEST(ForeignPcd, CoordinatesInCapitals) {
  const std::string text =
      "VERSION 0.7\nFIELDS X Y Z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
      "DATA binary\n" +
      floatsOf({1, 2, 3});
  const auto file = loadText("a.pcd", text);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(value(*file, "y", 0), 2);
  const TemporaryFolder folder;
  writeText(folder / "a.pcd", text);
  EXPECT_TRUE(recordLayoutOf(folder / "a.pcd", false)) << "in pieces, too";
  const auto ply = loadText("a.ply",
                            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float X\n"
                            "property float Y\nproperty float Z\nend_header\n1 2 3\n");
  ASSERT_TRUE(ply) << ply.error().message;
  EXPECT_EQ(value(*ply, "z", 0), 3);
}

TEST(ForeignPcd, CompressedDataThatAreStoredAsTheyAre) {
  const std::string head =
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\n"
      "DATA binary_compressed\n";
  const std::uint32_t sizes[2] = {24, 24};
  const std::string plain(reinterpret_cast<const char*>(sizes), sizeof(sizes));
  const auto file =
      loadText("a.pcd", head + plain + floatsOf({1.1f, 4.1f, 2.1f, 5.1f, 3.1f, 6.1f}));
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_FLOAT_EQ(static_cast<float>(value(*file, "x", 1)), 4.1f);
  EXPECT_FLOAT_EQ(static_cast<float>(value(*file, "z", 0)), 3.1f);
}

TEST(ForeignObj, ColoursUpTo255) {
  for (const char* text :
       {"v 1 2 3 255 127.5 0\nv 4 5 6 0 0 51\n", "v 1 2 3 1 .5 0\nv 4 5 6 0 0 .2\n"}) {
    const auto file = loadText("a.obj", text);
    ASSERT_TRUE(file) << file.error().message;
    const auto& rgb = file->cloud.fields[static_cast<std::size_t>(findField(file->cloud, "rgb"))];
    const std::uint8_t* at = file->cloud.data.data() + rgb.offset;
    EXPECT_EQ(at[2], 255);
    EXPECT_EQ(at[1], 128);
    EXPECT_EQ(at[file->cloud.point_step], 51);
  }
}

std::string splatPly(const std::string& more, const std::string& rows) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex 3\n";
  for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0"})
    text += std::string("property float ") + name + "\n";
  return text + more + "end_header\n" + rows;
}

TEST(ForeignPly, GaussianSplatsAreColouredPoints) {
  // Opacities of 0.88, 0.047 and 0.5 before their sigmoid; colours of 1, 0.5 and below 0.
  const std::string rows = "1 2 3 1.772454 0 -9 2 -4\n4 5 6 0 0 0 -3 -4\n7 8 9 0.5 0.5 0.5 0 -4\n";
  const auto file = loadText("a.ply", splatPly("", rows));
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(numPoints(file->cloud), 2u);
  EXPECT_EQ(value(*file, "x", 1), 7);
  EXPECT_EQ(value(*file, "scale_0", 0), -4) << "fields of their own stay";
  const auto& rgb = file->cloud.fields[static_cast<std::size_t>(findField(file->cloud, "rgb"))];
  const std::uint8_t* at = file->cloud.data.data() + rgb.offset;
  EXPECT_EQ(at[2], 255);
  EXPECT_EQ(at[1], 128);
  EXPECT_EQ(at[0], 0);
  ASSERT_EQ(file->notes.size(), 1u);
  for (const char* words : {"f_dc_0", "1 of opacity below 0.1", "-min_opacity"})
    EXPECT_NE(file->notes[0].find(words), std::string::npos) << file->notes[0];

  const TemporaryFolder folder;
  writeText(folder / "a.ply", splatPly("", rows));
  PointFileOptions all;
  all.min_opacity = 0;
  const auto kept = loadPointFile(folder / "a.ply", all);
  ASSERT_TRUE(kept);
  EXPECT_EQ(numPoints(kept->cloud), 3u);
  const auto in_pieces = recordLayoutOf(folder / "a.ply", false);
  ASSERT_FALSE(in_pieces);
  EXPECT_EQ(in_pieces.error().code, ErrorCode::kBadArgument) << "splats are read as a whole";
}

TEST(ForeignPly, ColoursOfTheirOwnStay) {
  const auto file = loadText(
      "a.ply",
      splatPly("property uchar red\nproperty uchar green\nproperty uchar blue\n",
               "1 2 3 0 0 0 2 -4 9 8 7\n4 5 6 0 0 0 2 -4 9 8 7\n7 8 9 0 0 0 2 -4 9 8 7\n"));
  ASSERT_TRUE(file) << file.error().message;
  const auto& rgb = file->cloud.fields[static_cast<std::size_t>(findField(file->cloud, "rgb"))];
  EXPECT_EQ(file->cloud.data[rgb.offset + 2], 9);
  EXPECT_NE(file->notes[0].find("the file's own"), std::string::npos);
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/point_file.h"
#include "filters/io/point_values.h"

#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include <cmath>
#include <cstring>

#include "support/sphere_surface.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

pcl::PointCloud<pcl::PointXYZRGBNormal> coloredCloud() {
  pcl::PointCloud<pcl::PointXYZRGBNormal> cloud(4, 3);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    cloud[i].x = 0.1f * static_cast<float>(i);
    cloud[i].y = i == 5 ? NAN : -1.0f;
    cloud[i].z = 1e-7f;
    cloud[i].normal_z = 1.0f;
    cloud[i].rgba = 0x00102030u + static_cast<std::uint32_t>(i);
  }
  cloud.is_dense = false;
  return cloud;
}

TEST(PointFile, ReadsAllOfPclsPcdForms) {
  const TemporaryFolder folder;
  const auto cloud = coloredCloud();
  pcl::PCDWriter writer;
  ASSERT_EQ(writer.writeASCII(folder / "a.pcd", cloud, 9), 0);
  ASSERT_EQ(writer.writeBinary(folder / "b.pcd", cloud), 0);
  ASSERT_EQ(writer.writeBinaryCompressed(folder / "c.pcd", cloud), 0);
  for (const char* name : {"a.pcd", "b.pcd", "c.pcd"}) {
    const auto file = loadPointFile(folder / name);
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->cloud.width, 4u);
    EXPECT_EQ(file->cloud.height, 3u);
    EXPECT_EQ(value(*file, "x", 7), cloud[7].x) << name;
    EXPECT_TRUE(std::isnan(value(*file, "y", 5))) << name;
    EXPECT_EQ(value(*file, "z", 11), 1e-7f) << name;
    EXPECT_EQ(value(*file, "normal_z", 3), 1.0) << name;
    const auto& rgb = file->cloud.fields[static_cast<std::size_t>(findField(file->cloud, "rgb"))];
    std::uint32_t color = 0;
    std::memcpy(&color, &file->cloud.data[9 * file->cloud.point_step + rgb.offset], 4);
    EXPECT_EQ(color & 0xffffffu, 0x102039u) << name;
  }
}

TEST(PointFile, DoubleCoordinatesSurviveInBothFormats) {
  const TemporaryFolder folder;
  writeText(folder / "a.pcd",
            "VERSION 0.7\nFIELDS x y z i\nSIZE 8 8 8 2\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\n"
            "HEIGHT 1\nVIEWPOINT 1 2 3 1 0 0 0\nPOINTS 2\nDATA ascii\n"
            "515368.60225 4918340.364 2322.89625 17\n1 2 3 4\n");
  writeText(folder / "a.ply",
            "ply\nformat ascii 1.0\ncomment two points\nelement vertex 2\nproperty double x\n"
            "property double y\nproperty double z\nproperty ushort i\nend_header\n"
            "515368.60225 4918340.364 2322.89625 17\n1 2 3 4\n");
  for (const std::string extension : {".pcd", ".ply"}) {
    const auto file = loadPointFile(folder / ("a" + extension));
    ASSERT_TRUE(file) << file.error().message;
    ASSERT_FALSE(savePointFile(folder / ("b" + extension), *file));
    const auto again = loadPointFile(folder / ("b" + extension));
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(value(*again, "x", 0), 515368.60225);
    EXPECT_EQ(value(*again, "y", 0), 4918340.364);
    EXPECT_EQ(value(*again, "i", 0), 17.0);
    EXPECT_EQ(again->comments, file->comments);
    ASSERT_FALSE(savePointFile(folder / ("c" + extension), *again));
    EXPECT_EQ(fileBytes(folder / ("b" + extension)), fileBytes(folder / ("c" + extension)));
  }
}

TEST(PointFile, PlyKeepsFacesColoursAndNormals) {
  const TemporaryFolder folder;
  writeText(folder / "a.ply",
            "ply\r\nformat ascii 1.0\r\nelement vertex 4\r\nproperty float x\r\nproperty float "
            "y\r\nproperty float z\r\nproperty float nx\r\nproperty float ny\r\nproperty float "
            "nz\r\nproperty uchar red\r\nproperty uchar green\r\nproperty uchar blue\r\nelement "
            "face 2\r\nproperty uchar flag\r\nproperty list uchar int vertex_indices\r\n"
            "element edge 1\r\nproperty int a\r\nend_header\r\n"
            "0 0 0 0 0 1 255 128 1\r\n1 0 0 0 0 1 2 3 4\r\n1 1 0 0 0 1 5 6 7\r\n"
            "0 1 0 0 0 1 8 9 10\r\n7 3 0 1 2\r\n7 4 0 1 2 3\r\n5\r\n");
  const auto file = loadPointFile(folder / "a.ply");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->numFaces(), 2u);
  EXPECT_EQ(file->face_vertices, (std::vector<std::uint32_t>{0, 1, 2, 0, 1, 2, 3}));
  EXPECT_EQ(value(*file, "normal_z", 2), 1.0);
  ASSERT_FALSE(savePointFile(folder / "b.ply", *file));
  const auto again = loadPointFile(folder / "b.ply");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->face_vertices, file->face_vertices);
  EXPECT_EQ(again->cloud.data, file->cloud.data);
  ASSERT_FALSE(savePointFile(folder / "b.pcd", *file));
  pcl::PointCloud<pcl::PointXYZRGBNormal> cloud;
  ASSERT_EQ(pcl::io::loadPCDFile(folder / "b.pcd", cloud), 0);
  EXPECT_EQ(cloud[0].r, 255);
  EXPECT_EQ(cloud[0].g, 128);
  EXPECT_EQ(cloud[0].b, 1);
}

/** A PCD field of the name "_" is padding. A property of that name keeps its values all the same. */
TEST(PointFile, APropertyNamedAsPaddingKeepsItsValues) {
  const TemporaryFolder folder;
  for (const std::string name : {"_", "\x13"}) {
    writeText(folder / "a.ply",
              "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
              "property float z\nproperty float " +
                  name + "\nend_header\n1 2 3 7\n4 5 6 8\n");
    const auto file = loadPointFile(folder / "a.ply");
    ASSERT_TRUE(file) << file.error().message;
    ASSERT_FALSE(savePointFile(folder / "b.pcd", *file));
    const auto again = loadPointFile(folder / "b.pcd");
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->cloud.data, file->cloud.data);
    EXPECT_EQ(value(*again, "unnamed", 1), 8.0f);
  }
}

/** PLY has names of its own for colours and normals. */
TEST(PointFile, PlyKeepsFieldsNamedAsItsColoursAndNormals) {
  const TemporaryFolder folder;
  writeText(folder / "a.pcd",
            "VERSION 0.7\nFIELDS x y z alpha rgba rgb nx normal_x red\nSIZE 4 4 4 1 4 4 4 4 1\n"
            "TYPE F F F U U U F F U\nCOUNT 1 1 1 1 1 1 1 1 1\nWIDTH 2\nHEIGHT 1\n"
            "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n"
            "1 2 3 4 16909060 6 7 8 9\n1 2 3 14 16909061 16 17 18 19\n");
  const auto file = loadPointFile(folder / "a.pcd");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_FALSE(savePointFile(folder / "b.ply", *file));
  const auto again = loadPointFile(folder / "b.ply");
  ASSERT_TRUE(again) << again.error().message;
  const std::pair<const char*, const char*> renamed[] = {
      {"alpha", "alpha_"}, {"rgba", "rgba"}, {"rgb", "rgb_"},
      {"nx", "nx_"},       {"red", "red_"},  {"normal_x", "normal_x"}};
  EXPECT_EQ(again->cloud.fields.size(), file->cloud.fields.size());
  for (const auto& [before, after] : renamed)
    EXPECT_EQ(value(*again, after, 1), value(*file, before, 1)) << before;
}

/** Readers find fields by their names. */
TEST(PointFile, FieldsOfOneNameGetNamesOfTheirOwn) {
  const TemporaryFolder folder;
  writeText(folder / "a.ply",
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
            "property float z\nproperty float t\nproperty float t\nproperty float \x13\n"
            "property float \x14\nend_header\n1 2 3 4 5 6 7\n");
  const auto file = loadPointFile(folder / "a.ply");
  ASSERT_TRUE(file) << file.error().message;
  for (const char* extension : {".pcd", ".ply", ".vtp"}) {
    const std::string copy = folder / ("b" + std::string(extension));
    ASSERT_FALSE(savePointFile(copy, *file));
    const auto again = loadPointFile(copy);
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(value(*again, "t", 0), 4.0f) << extension;
    EXPECT_EQ(value(*again, "t_", 0), 5.0f) << extension;
    EXPECT_EQ(value(*again, "unnamed", 0), 6.0f) << extension;
    EXPECT_EQ(value(*again, "unnamed_", 0), 7.0f) << extension;
  }
}

/** Points without fields are no valid PointFile, whatever lists the vertices have. */
TEST(PointFile, PlyVerticesWithoutNumbersAreAnError) {
  const TemporaryFolder folder;
  for (const std::string property : {"", "property list uchar int vertex_indices\n"}) {
    writeText(folder / "a.ply",
              "ply\nformat ascii 1.0\nelement vertex 2\n" + property + "end_header\n1 0\n2 0 1\n");
    const auto file = loadPointFile(folder / "a.ply");
    ASSERT_FALSE(file);
    EXPECT_NE(file.error().message.find("vertices have no numbers"), std::string::npos)
        << file.error().message;
  }
}

TEST(PointFile, ReadsBigEndianPly) {
  const TemporaryFolder folder;
  std::string text =
      "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty float x\nproperty short "
      "y\nproperty float z\nend_header\n";
  text += std::string("\x3f\x80\x00\x00", 4) + std::string("\xff\xfe", 2) +
          std::string("\xc0\x00\x00\x00", 4);
  writeText(folder / "a.ply", text);
  const auto file = loadPointFile(folder / "a.ply");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(value(*file, "x", 0), 1.0);
  EXPECT_EQ(value(*file, "y", 0), -2.0);
  EXPECT_EQ(value(*file, "z", 0), -2.0);
}

TEST(PointFile, BoastfulAndBrokenHeadersAreErrors) {
  const TemporaryFolder folder;
  const std::string pcd = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";
  const std::string one = "WIDTH 1\nHEIGHT 1\nDATA binary\n";
  const auto counts = [&one](const std::string& values) {
    return "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT " + values + "\n" + one;
  };
  const std::string ply = "ply\nformat ascii 1.0\nelement vertex ";
  const std::string xyz = "\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string triangles = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::pair<std::string, std::string> files[] = {
      {"a.pcd", pcd + "WIDTH 4000000000\nHEIGHT 1\nDATA ascii\n1 2 3\n"},
      {"b.pcd", pcd + "WIDTH 4000000000\nHEIGHT 4000000000\nDATA binary\n"},
      {"c.pcd", pcd + "WIDTH 400000000\nHEIGHT 1\nDATA binary\nabc"},
      {"d.pcd", pcd + "WIDTH 400000000\nHEIGHT 1\nDATA binary_compressed\nabcdefghijklm"},
      {"e.pcd", pcd + "WIDTH 2\nHEIGHT 1\nPOINTS 3\nDATA ascii\n1 2 3\n1 2 3\n1 2 3\n"},
      {"f.pcd", pcd + "WIDTH 1\nHEIGHT 1\nDATA ascii\n1 2 three\n"},
      {"g.pcd", pcd + "WIDTH 1\nHEIGHT 1\nDATA origami\n1 2 3\n"},
      {"h.pcd", "FIELDS x y\nSIZE 4\nDATA ascii\n"},
      {"i.pcd", ""},
      {"j.pcd", counts("0 0 0") + "abcdefghijkl"},
      {"k.pcd", counts("1 1 0") + "abcdefgh"},
      {"l.pcd", "FIELDS x y z _\nSIZE 4 4 4 0\nTYPE F F F U\n" + one},
      {"m.pcd", "FIELDS x y z\nSIZE 4 4 3\nTYPE F F F\n" + one},
      {"o.pcd", pcd + "HEIGHT 1\nDATA ascii\n1 2 3\n"},
      {"p.pcd", pcd + "WIDTH -1\nHEIGHT 1\nDATA ascii\n1 2 3\n"},
      {"q.pcd", "WIDTH 1\nHEIGHT 1\nDATA ascii\n1 2 3\n"},
      {"n.pcd", counts("65536 65536 65536") + "abc"},
      {"a.ply", ply + "4000000000" + xyz + "end_header\n1 2 3\n"},
      {"b.ply", ply + "1" + xyz + "end_header\n1 2\n"},
      {"c.ply", ply + "1" + xyz + "end_header\n1 2 x\n"},
      {"d.ply", ply + "1" + xyz},
      {"e.ply", ply + "1" + xyz +
                    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                    "1 2 3\n3 0 0 1\n"},
      {"f.ply", ply + "1" + xyz +
                    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                    "1 2 3\n3 0 0 -1\n"},
      {"g.ply", ply + "-1" + xyz + "end_header\n"},
      {"h.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quaternion x\nend_header\n1\n"},
      {"i.ply", ply + "1" + xyz + "element vertex 1" + xyz + "end_header\n1 2 3\n4 5 6\n"},
      {"j.ply", ply + "1" + xyz + triangles + triangles + "end_header\n1 2 3\n3 0 0 0\n3 0 0 0\n"},
      {"k.ply", ply + "1" + xyz + triangles +
                    "property list uchar int vertex_index\nend_header\n1 2 3\n3 0 0 0 3 0 0 0\n"},
      {"l.ply", ply + "2" + xyz +
                    "element face 1\nproperty list uchar float vertex_indices\nend_header\n"
                    "1 2 3\n4 5 6\n3 0 0.5 1\n"},
  };
  for (const auto& [name, text] : files) {
    writeText(folder / name, text);
    const auto file = loadPointFile(folder / name);
    ASSERT_FALSE(file) << name;
    EXPECT_NE(file.error().message.find(name), std::string::npos);
    EXPECT_EQ(file.error().message.find('\n'), std::string::npos) << file.error().message;
    // "'file': defect: remedy" or "'file': defect; remedy"
    const std::string said = file.error().message.substr(file.error().message.find(name));
    EXPECT_NE(said.find_first_of(":;", name.size() + 2), std::string::npos) << said;
  }
}

/** Names are looked up, not compared with one another. */
TEST(PointFile, AHundredThousandElementsAreReadOnce) {
  std::string text = "ply\nformat ascii 1.0\n";
  for (int i = 0; i < 100000; ++i) text += "element e" + std::to_string(i) + " 0\n";
  const std::string points = "element vertex 1\nproperty float x\nend_header\n1\n";
  const TemporaryFolder folder;
  writeText(folder / "many.ply", text + points);
  const auto file = loadPointFile(folder / "many.ply");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(numPoints(file->cloud), 1u);
  writeText(folder / "twice.ply", text + "element e7 0\n" + points);
  const auto twice = loadPointFile(folder / "twice.ply");
  ASSERT_FALSE(twice);
  EXPECT_NE(twice.error().message.find("two elements 'e7'"), std::string::npos);
}

TEST(PointFile, NamesWhatItLeavesOut) {
  const TemporaryFolder folder;
  writeText(
      folder / "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
      "z\nproperty list uchar int tags\nelement face 1\nproperty uchar flag\n"
      "property list uchar int vertex_indices\nelement edge 1\nproperty int a\n"
      "element nothing 0\nproperty int a\nend_header\n1 2 3 2 7 8\n9 3 0 0 0\n5\n");
  const auto file = loadPointFile(folder / "a.ply");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->left_out,
            (std::vector<std::string>{"'tags' of element 'vertex'", "'flag' of element 'face'",
                                      "element 'edge'"}));
  ASSERT_FALSE(savePointFile(folder / "b.ply", *file));
  EXPECT_TRUE(loadPointFile(folder / "b.ply")->left_out.empty());
}

std::vector<unsigned char> damagedBytes(std::vector<unsigned char> bytes, std::mt19937& random,
                                        bool cut) {
  for (int k = 0; k < 3; ++k) {
    bytes[random() % bytes.size()] = static_cast<unsigned char>(random());
  }
  if (cut) bytes.resize(random() % bytes.size());
  return bytes;
}

TEST(PointFile, DamagedFilesNeverCrash) {
  const TemporaryFolder folder;
  pcl::PCDWriter writer;
  ASSERT_EQ(writer.writeBinaryCompressed(folder / "a.pcd", coloredCloud()), 0);
  auto loaded = loadPointFile(folder / "a.pcd");
  ASSERT_TRUE(loaded);
  ASSERT_FALSE(savePointFile(folder / "a.ply", *loaded));
  std::mt19937 random(5);
  for (const std::string name : {"a.pcd", "a.ply"}) {
    const auto bytes = fileBytes(folder / name);
    for (int trial = 0; trial < 400; ++trial) {
      writeBytes(folder / ("damaged" + name), damagedBytes(bytes, random, trial % 3 == 0));
      const auto file = loadPointFile(folder / ("damaged" + name));
      ASSERT_TRUE(!file ||
                  file->cloud.data.size() == numPoints(file->cloud) * file->cloud.point_step);
    }
  }
}

}  // namespace
}  // namespace pcl_slim

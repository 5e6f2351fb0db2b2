// SPDX-License-Identifier: BSD-3-Clause
// Points, meshes and lines that contradict themselves: no file function trusts its argument.
#include <gtest/gtest.h>
#include <pcl/PCLPointCloud2.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pcl_slim/features/crest_lines.h"
#include "pcl_slim/filters/io/crest_files.h"
#include "pcl_slim/filters/io/mesh_files.h"
#include "pcl_slim/filters/io/pcl_conversion.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/filters/io/point_file_pieces.h"
#include "pcl_slim/filters/io/splat_files.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "support/temporary_folder.h"

namespace pcl_slim {
namespace {

using pcl_slim_test::TemporaryFolder;

/** A square of two triangles. */
PointFile square() {
  PointFile file;
  for (const char* name : {"x", "y", "z"}) addField(file.cloud, name, kFloat32);
  file.cloud.resize(4);
  for (std::size_t i = 0; i < 4; ++i) {
    const float p[3] = {static_cast<float>(i % 2), static_cast<float>(i / 2), 1.0f};
    std::memcpy(file.cloud.data.data() + i * file.cloud.point_step, p, sizeof(p));
  }
  file.face_begin = {0, 3, 6};
  file.face_vertices = {0, 1, 2, 1, 3, 2};
  return file;
}

struct Mistake {
  const char* name;
  std::function<void(PointFile&)> make;
};

const Mistake kMistakes[] = {
    {"too few bytes", [](PointFile& f) { f.cloud.data.resize(10); }},
    {"too many bytes", [](PointFile& f) { f.cloud.data.resize(1000); }},
    {"points of no bytes", [](PointFile& f) { f.cloud.point_step = 0; }},
    {"a wide cloud", [](PointFile& f) { f.cloud.width = 4000000000u; }},
    {"a cloud of 2^64 points", [](PointFile& f) { f.cloud.width = f.cloud.height = 0xffffffffu; }},
    {"a field beyond its point", [](PointFile& f) { f.cloud.fields[0].offset = 100000; }},
    {"a field at the end of numbers", [](PointFile& f) { f.cloud.fields[0].offset = 0xffffffffu; }},
    {"an unknown type", [](PointFile& f) { f.cloud.fields[1].datatype = 77; }},
    {"many elements", [](PointFile& f) { f.cloud.fields[2].count = 4000000000u; }},
    {"a name with a line end", [](PointFile& f) { f.cloud.fields[1].name = "y\nDATA ascii"; }},
    {"a field without a name", [](PointFile& f) { f.cloud.fields[1].name = ""; }},
    {"no fields", [](PointFile& f) { f.cloud.fields.clear(); }},
    {"a comment of two lines", [](PointFile& f) { f.comments = {"a\nend_header"}; }},
    {"a face of a vertex that is none", [](PointFile& f) { f.face_vertices[2] = 100000; }},
    {"faces beyond their corners",
     [](PointFile& f) {
       f.face_begin = {0, 30};
     }},
    {"faces that run backwards",
     [](PointFile& f) {
       f.face_begin = {0, 6, 3};
     }},
    {"faces that begin late",
     [](PointFile& f) {
       f.face_begin = {3, 6};
     }},
    {"corners without faces", [](PointFile& f) { f.face_begin.clear(); }}};

TEST(PointCheck, NoFunctionTrustsPointsThatContradictThemselves) {
  const TemporaryFolder folder;
  ASSERT_FALSE(square().validate());
  for (const Mistake& mistake : kMistakes) {
    PointFile file = square();
    mistake.make(file);
    const Error error = file.validate();
    EXPECT_EQ(error.code, ErrorCode::kBadInput) << mistake.name;
    EXPECT_NE(error.message.find(": "), std::string::npos) << "no remedy: " << error.message;
    for (const char* extension : {".pcd", ".ply", ".las", ".vtp"}) {
      const std::string path = folder / ("scan" + std::string(extension));
      EXPECT_TRUE(savePointFile(path, file)) << mistake.name << extension;
      EXPECT_FALSE(std::filesystem::exists(path)) << mistake.name << extension;
    }
    EXPECT_FALSE(splatsFrom(file)) << mistake.name;
    EXPECT_FALSE(surfaceFrom(file)) << mistake.name;
    PointFileWriter writer;
    ASSERT_FALSE(writer.open(folder / "pieces.pcd", 4, 1));
    EXPECT_TRUE(writer.add(file)) << mistake.name;
  }
}

TEST(PointCheck, PclCloudsKeepWhatContradictsItself) {
  pcl::PCLPointCloud2 cloud = toPCL(square().cloud);
  ASSERT_FALSE(checkPointTable(toPointTable(cloud)));
  cloud.height = 4;
  cloud.width = 1;
  cloud.row_step = 1000;  // of which there are not as many bytes
  EXPECT_FALSE(checkPointTable(toPointTable(cloud))) << "rows without gaps are whole";
  cloud.height = 4000000000u;
  EXPECT_TRUE(checkPointTable(toPointTable(cloud)));
  cloud.height = 2;
  cloud.width = 2;
  cloud.row_step = 30;
  cloud.data.resize(60);  // six bytes behind each row
  EXPECT_FALSE(checkPointTable(toPointTable(cloud)));
  cloud.data.resize(50);
  EXPECT_TRUE(checkPointTable(toPointTable(cloud)));
}

TEST(PointCheck, MeshesAndLinesThatContradictThemselvesAreNotWritten) {
  const TemporaryFolder folder;
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.normals.resize(3, {0, 0, 1});
  mesh.k1 = mesh.k2 = {0, 0, 0};
  mesh.triangles = {{0, 1, 2}};
  ASSERT_FALSE(mesh.validate());
  const std::function<void(TriangleMesh&)> mistakes[] = {
      [](TriangleMesh& m) { m.triangles[0][1] = 3; }, [](TriangleMesh& m) { m.normals.pop_back(); },
      [](TriangleMesh& m) { m.k2.clear(); }, [](TriangleMesh& m) { m.colors.resize(1); }};
  for (const auto& mistake : mistakes) {
    TriangleMesh wrong = mesh;
    mistake(wrong);
    for (const char* extension : {".ply", ".obj", ".stl", ".glb", ".vtp"}) {
      const std::string path = folder / ("mesh" + std::string(extension));
      EXPECT_TRUE(saveMesh(path, wrong)) << extension;
      EXPECT_FALSE(std::filesystem::exists(path)) << extension;
    }
  }
  CrestLines lines;
  ASSERT_FALSE(lines.validate());
  lines.position.resize(2);
  for (const char* extension : {".pcd", ".ply", ".svg", ".vtp"})
    EXPECT_TRUE(saveCrestLines(folder / ("lines" + std::string(extension)), lines)) << extension;
  lines.position.clear();
  lines.line_begin = {0, 5};
  EXPECT_TRUE(lines.validate());
}

/** The error of a file of this content. */
std::string messageOf(const std::string& path, const std::string& text) {
  pcl_slim_test::writeText(path, text);
  const auto file = loadPointFile(path);
  return file ? "" : file.error().message;
}

TEST(PointCounts, AHeaderThatAnnouncesFewerPointsThanThereAreIsRefused) {
  const TemporaryFolder folder;
  const std::string pcd =
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nDATA ";
  const std::string ply = "ply\nformat ascii 1.0\nelement vertex ";
  const std::string xyz = "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  const std::string two = "1 2 3\n4 5 6\n", three = two + "7 8 9\n";
  EXPECT_EQ(messageOf(folder / "a.pts", "2\n" + two), "");
  EXPECT_NE(messageOf(folder / "a.pts", "2\n" + three).find("one point more"), std::string::npos);
  EXPECT_EQ(messageOf(folder / "b.pts", "1\n1 2 3\n2\n" + two), "") << "two scans in one file";
  EXPECT_EQ(messageOf(folder / "a.pcd", pcd + "ascii\n" + two), "");
  EXPECT_NE(messageOf(folder / "a.pcd", pcd + "ascii\n" + three).find("more follow"),
            std::string::npos);
  EXPECT_EQ(messageOf(folder / "a.pcd", pcd + "binary\n" + std::string(24 + 11, 'a')), "");
  EXPECT_NE(
      messageOf(folder / "a.pcd", pcd + "binary\n" + std::string(36, 'a')).find("more follow"),
      std::string::npos);
  EXPECT_EQ(messageOf(folder / "a.ply", ply + "2" + xyz + two + "\n "), "");
  EXPECT_NE(messageOf(folder / "a.ply", ply + "2" + xyz + three).find("more follows"),
            std::string::npos);
  EXPECT_NE(messageOf(folder / "a.ply", ply + "2.5" + xyz + two).find("line 3"), std::string::npos);
  EXPECT_EQ(messageOf(folder / "a.ply", ply + "2.0" + xyz + two), "");
}

TEST(PointCounts, LinesMayEndAsThoseOfOldMacs) {
  const TemporaryFolder folder;
  const auto numPointsOf = [&](const std::string& name, const std::string& text) -> std::size_t {
    pcl_slim_test::writeText(folder / name, text);
    const auto file = loadPointFile(folder / name);
    EXPECT_TRUE(file) << name << ": " << (file ? "" : file.error().message);
    return file ? numPoints(file->cloud) : 0;
  };
  EXPECT_EQ(numPointsOf("a.xyz", "1 2 3\r4 5 6\r7 8 9\r"), 3u);
  EXPECT_EQ(numPointsOf("b.xyz", "1 2 3\r\n4 5 6\r\n7 8 9"), 3u);
  EXPECT_EQ(numPointsOf("a.obj", "v 1 2 3\rv 4 5 6\r"), 2u);
  EXPECT_EQ(numPointsOf("a.ply",
                        "ply\rformat ascii 1.0\relement vertex 2\rproperty float x\rproperty "
                        "float y\rproperty float z\rend_header\r1 2 3\r4 5 6\r"),
            2u);
}

TEST(PointCounts, AHeaderOfBlankLinesIsRefused) {
  const TemporaryFolder folder;
  const std::string message = messageOf(folder / "a.ply", "ply\n" + std::string(20000, '\n'));
  EXPECT_NE(message.find("10000 empty lines"), std::string::npos) << message;
  EXPECT_EQ(messageOf(folder / "b.ply",
                      [] {
                        std::string text = "ply\nformat ascii 1.0\n";
                        for (int i = 0; i < 20000; ++i) text += "comment 1\n";
                        return text + "element vertex 0\nend_header\n";
                      }()),
            "");
}

}  // namespace
}  // namespace pcl_slim

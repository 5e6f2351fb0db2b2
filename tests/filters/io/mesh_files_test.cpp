// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/mesh_files.h"

#include <gtest/gtest.h>
#include <pcl/PolygonMesh.h>
#include <pcl/io/ply_io.h>

#include <cstring>
#include <fstream>
#include <sstream>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/filters/io/point_file.h"
#include "support/temporary_folder.h"

namespace {

using namespace pcl_slim;

/** A tetrahedron somewhere, with colours. */
TriangleMesh tetrahedron(double shift) {
  TriangleMesh mesh;
  mesh.vertices = {{shift, 0, 0}, {shift + 1, 0, 0}, {shift, 1, 0}, {shift, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  for (int i = 0; i < 4; ++i) {
    mesh.normals.push_back({0, 0.6f, 0.8f});
    mesh.k1.push_back(0.5f + static_cast<float>(i));
    mesh.k2.push_back(-1);
    mesh.colors.push_back({static_cast<std::uint8_t>(10 * i), 200, 255});
  }
  return mesh;
}

std::string textOf(const std::string& path) {
  const auto bytes = readFile(path);
  EXPECT_TRUE(bytes);
  return bytes ? std::string(bytes->begin(), bytes->end()) : "";
}

TEST(MeshFiles, PlyKeepsEverything) {
  const pcl_slim_test::TemporaryFolder folder;
  const std::string path = (folder / "mesh.ply");
  ASSERT_FALSE(saveMesh(path, tetrahedron(0)));
  const auto file = loadPointFile(path);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(numPoints(file->cloud), 4u);
  EXPECT_EQ(file->numFaces(), 4u);
  const auto value = [&](const char* name, std::size_t i) {
    const int f = findField(file->cloud, name);
    EXPECT_GE(f, 0) << name;
    return f < 0 ? 0 : fieldValue(file->cloud, i, file->cloud.fields[static_cast<std::size_t>(f)]);
  };
  EXPECT_EQ(value("x", 1), 1);
  EXPECT_FLOAT_EQ(static_cast<float>(value("normal_z", 2)), 0.8f);
  EXPECT_EQ(value("k1", 3), 3.5);
  EXPECT_EQ(value("k2", 0), -1);
  EXPECT_EQ(file->face_vertices, (std::vector<std::uint32_t>{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}));
  const std::string header = textOf(path);
  EXPECT_NE(header.find("property uchar red"), std::string::npos);
  // PCL reads it too, colours included.
  pcl::PolygonMesh mesh;
  ASSERT_EQ(pcl::io::loadPLYFile(path, mesh), 0);
  EXPECT_EQ(mesh.polygons.size(), 4u);
  EXPECT_EQ(mesh.cloud.width, 4u);
}

TEST(MeshFiles, LargeCoordinatesStayExactWhereTheFormatCan) {
  const pcl_slim_test::TemporaryFolder folder;
  const TriangleMesh mesh = tetrahedron(4918340.125);
  EXPECT_GT(floatErrorOf(mesh), 0.01);
  const std::string path = (folder / "mesh.ply");
  ASSERT_FALSE(saveMesh(path, mesh));
  const auto file = loadPointFile(path);
  ASSERT_TRUE(file);
  EXPECT_EQ(file->cloud.fields[0].datatype, kFloat64);
  EXPECT_EQ(fieldValue(file->cloud, 1, file->cloud.fields[0]), 4918341.125);
  ASSERT_FALSE(saveMesh((folder / "mesh.obj"), mesh));
  EXPECT_NE(textOf((folder / "mesh.obj")).find("v 4918341.125 0 0"), std::string::npos);
}

TEST(MeshFiles, ObjHasPositionsColoursNormalsAndFaces) {
  const pcl_slim_test::TemporaryFolder folder;
  ASSERT_FALSE(saveMesh((folder / "mesh.OBJ"), tetrahedron(0)));
  std::istringstream text(textOf((folder / "mesh.OBJ")));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 12u);
  EXPECT_EQ(lines[1], "v 1 0 0 0.039 0.784 1");
  EXPECT_EQ(lines[4], "vn 0 0.6 0.8");
  EXPECT_EQ(lines[8], "f 1//1 3//3 2//2");
}

TEST(MeshFiles, StlHasTheTriangles) {
  const pcl_slim_test::TemporaryFolder folder;
  ASSERT_FALSE(saveMesh((folder / "mesh.stl"), tetrahedron(0)));
  const std::string bytes = textOf((folder / "mesh.stl"));
  ASSERT_EQ(bytes.size(), 84u + 4 * 50);
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  EXPECT_EQ(count, 4u);
  float facet[12];
  std::memcpy(facet, bytes.data() + 84, sizeof(facet));
  EXPECT_EQ(facet[2], -1) << "normal of the face below";
  EXPECT_EQ(facet[3 + 3 + 1], 1) << "y of its second corner";
}

TEST(MeshFiles, GlbIsWhatItsHeaderSays) {
  const pcl_slim_test::TemporaryFolder folder;
  ASSERT_FALSE(saveMesh((folder / "mesh.glb"), tetrahedron(100)));
  const std::string bytes = textOf((folder / "mesh.glb"));
  ASSERT_GT(bytes.size(), 20u);
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  std::uint32_t words[5];
  std::memcpy(words, bytes.data(), sizeof(words));
  EXPECT_EQ(words[1], 2u);
  EXPECT_EQ(words[2], bytes.size());
  EXPECT_EQ(words[3] % 4, 0u);
  const std::string json = bytes.substr(20, words[3]);
  for (const char* part : {"\"POSITION\":0", "\"COLOR_0\":3", "\"count\":12", "[100.5,0.5,0.5]",
                           "\"min\":[-0.5,-0.5,-0.5]"}) {
    EXPECT_NE(json.find(part), std::string::npos) << part;
  }
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 20 + words[3], 4);
  EXPECT_EQ(length, 4 * 12 + 4 * 12 + 12 * 4 + 4 * 8u);
  EXPECT_EQ(20 + words[3] + 8 + length, bytes.size());
  // The second vertex relative to the middle, in floats.
  float position[3];
  std::memcpy(position, bytes.data() + 20 + words[3] + 8 + 12, sizeof(position));
  EXPECT_EQ(position[0], 0.5f);
  EXPECT_EQ(position[1], -0.5f);
}

TEST(MeshFiles, OthersAreRefusedAndNothingIsLeft) {
  const pcl_slim_test::TemporaryFolder folder;
  EXPECT_EQ(saveMesh((folder / "mesh.pcd"), tetrahedron(0)).code, ErrorCode::kBadArgument);
  EXPECT_FALSE(std::ifstream((folder / "mesh.pcd")).good());
  EXPECT_EQ(saveMesh((folder / "no/mesh.stl"), tetrahedron(0)).code, ErrorCode::kIo);
  EXPECT_TRUE(checkMeshExtension("mesh"));
  EXPECT_FALSE(checkMeshExtension("mesh.GLB"));
}

}  // namespace

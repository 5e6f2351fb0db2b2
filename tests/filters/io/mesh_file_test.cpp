// SPDX-License-Identifier: BSD-3-Clause
// OBJ, STL and OFF: vertices, normals, colours and faces.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "filters/io/point_values.h"
#include "pcl_slim/filters/io/point_file.h"
#include "support/temporary_folder.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using Faces = std::vector<std::uint32_t>;

TEST(ObjFile, VerticesNormalsAndFaces) {
  const auto file = loadText("a.obj",
                             "# made by hand\nmtllib a.mtl\no thing\n"
                             "v 0 0 0\nv 1 0 0\nv 1 1 0 1.0\nv 0 1 4918360.257\nvt 0 0\n"
                             "vn 0 0 2\nvn 0 2 0\n"
                             "f 1/1/1 2/1/1 3//1\nf -4//1 \\\n -2//2 -1//-1\n");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(numPoints(file->cloud), 4u);
  EXPECT_EQ(value(*file, "z", 3), 4918360.257);
  EXPECT_EQ(file->face_begin, (Faces{0, 3, 6}));
  EXPECT_EQ(file->face_vertices, (Faces{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(value(*file, "normal_z", 0), 1);
  EXPECT_NEAR(value(*file, "normal_y", 2), std::sqrt(0.5), 1e-6);
  EXPECT_EQ(value(*file, "normal_y", 3), 1);
  EXPECT_EQ(file->left_out, (std::vector<std::string>{"texture coordinates", "the material"}));
}

TEST(ObjFile, ColoursAndNormalsWithoutFaces) {
  const auto file = loadText("a.obj", "v 0 0 0 1 0.5 0\nv 1 0 0 0 0 1\nvn 1 0 0\nvn 0 1 0\n");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(value(*file, "normal_x", 0), 1);
  EXPECT_EQ(value(*file, "normal_y", 1), 1);
  const auto& rgb = file->cloud.fields[static_cast<std::size_t>(findField(file->cloud, "rgb"))];
  EXPECT_EQ(file->cloud.data[rgb.offset + 2], 255);
  EXPECT_EQ(file->cloud.data[rgb.offset + 1], 128);
  EXPECT_EQ(file->numFaces(), 0u);
}

TEST(StlFile, TextAndBytesJoinTheirCorners) {
  const std::string facet = "facet normal 0 0 1\nouter loop\n";
  const auto text = loadText(
      "a.stl", "solid two\n" + facet +
                   "vertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n" + facet +
                   "vertex -0 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\n"
                   "endsolid two\n");
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_EQ(numPoints(text->cloud), 4u);
  EXPECT_EQ(text->face_vertices, (Faces{0, 1, 2, 0, 2, 3}));

  std::vector<unsigned char> bytes(84 + 2 * 50, 0);
  std::memcpy(bytes.data(), "solid looks like text", 21);
  bytes[80] = 2;
  const float corners[2][9] = {{0, 0, 0, 1, 0, 0, 1, 1, 0}, {0, 0, 0, 1, 1, 0, 0, 1, 0}};
  for (std::size_t i = 0; i < 2; ++i) std::memcpy(&bytes[84 + 50 * i + 12], corners[i], 36);
  const TemporaryFolder folder;
  writeBytes(folder / "b.stl", bytes);
  const auto binary = loadPointFile(folder / "b.stl");
  ASSERT_TRUE(binary) << binary.error().message;
  EXPECT_EQ(binary->face_vertices, text->face_vertices);
  EXPECT_EQ(binary->cloud.data, text->cloud.data);
}

TEST(OffFile, AllFourKinds) {
  const auto plain =
      loadText("a.off", "OFF # comment\n3 1 0\n0 0 0\n1 0 0\n0 1 0.5\n3 0 1 2 255 0 0\n");
  ASSERT_TRUE(plain) << plain.error().message;
  EXPECT_EQ(value(*plain, "z", 2), 0.5);
  EXPECT_EQ(plain->face_vertices, (Faces{0, 1, 2}));
  EXPECT_EQ(plain->left_out.size(), 1u);
  const auto colored = loadText("a.off", "COFF 1 0 0\n1 2 3 255 128 0 255\n");
  ASSERT_TRUE(colored) << colored.error().message;
  const auto real = loadText("a.off", "COFF\n1 0 0\n1 2 3 1.0 0.5 0.0 1.0\n");
  ASSERT_TRUE(real) << real.error().message;
  EXPECT_EQ(colored->cloud.data, real->cloud.data);
  const auto normals = loadText("a.off", "CNOFF\n1 0 0\n1 2 3 0 0 1 9 8 7\n");
  ASSERT_TRUE(normals) << normals.error().message;
  EXPECT_EQ(value(*normals, "normal_z", 0), 1);
  EXPECT_GE(findField(normals->cloud, "rgb"), 0);
}

TEST(MeshFiles, DefectsAreNamedInOneLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"a.obj", "v 0 0\n"},
      {"b.obj", "v 0 0 x\n"},
      {"c.obj", "v 0 0 0\nf 1 2 3\n"},
      {"d.obj", "v 0 0 0\nf 0 1 1\n"},
      {"e.obj", "v 0 0 0\nf 1//1 1//1 1//1\n"},
      {"f.obj", "hello\n"},
      {"g.obj", "v 0 0 0\nf 99999999999999999999 1 1\n"},
      {"a.stl", "solid a\nfacet\nouter loop\nvertex 0 0 0\nendloop\nendfacet\nendsolid\n"},
      {"b.stl", "solid a\nfacet\nouter loop\nvertex 0 0"},
      {"c.stl", "short"},
      {"d.stl", "solid a\n"},
      {"a.off", "3 1 0\n"},
      {"b.off", "OFF\n3 1\n0 0 0\n"},
      {"c.off", "OFF\n1 1 0\n0 0 0\n3 0 1 2\n"},
      {"d.off", "OFF\n1 1 0\n0 0 0\n3 0 0\n"},
      {"e.off", "OFF BINARY\n"},
      {"f.off", "OFF\n-1 0 0\n"},
      {"g.off", "COFF\n1 0 0\n0 0 0\n"},
      {"h.off", "OFF\n4294967294 4294967294 0\n0 0 0\n"},
  };
  for (const auto& [name, text] : cases) {
    const auto file = loadText(name, text);
    ASSERT_FALSE(file) << name;
    EXPECT_NE(file.error().message.find(name), std::string::npos);
    EXPECT_EQ(file.error().message.find('\n'), std::string::npos) << file.error().message;
    EXPECT_NE(file.error().message.find_first_of(":;", file.error().message.find(name) + 6),
              std::string::npos)
        << file.error().message;
  }
}

}  // namespace
}  // namespace pcl_slim

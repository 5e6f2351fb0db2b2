// SPDX-License-Identifier: BSD-3-Clause
// Points as .vtp: VTK reads every value bit for bit, and so does loadPointFile.
#ifdef PCL_SLIM_WITH_VTP
#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataReader.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>

#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/filters/io/splat_files.h"
#include "support/temporary_folder.h"

namespace pcl_slim {
namespace {

using pcl_slim_test::fileBytes;
using pcl_slim_test::TemporaryFolder;
using pcl_slim_test::writeBytes;

struct Column {
  const char* name;
  std::uint8_t type;
  std::uint32_t count;
};

/** Points of random bytes, with a gap before each field. */
PointFile randomPoints(const std::vector<Column>& columns, std::uint32_t n) {
  PointFile file;
  PointTable& cloud = file.cloud;
  for (const Column& column : columns) {
    cloud.point_step += 3;
    addField(cloud, column.name, column.type, column.count);
  }
  cloud.resize(n);
  std::mt19937 random(5);
  for (auto& byte : cloud.data) byte = static_cast<std::uint8_t>(random());
  return file;
}

const std::vector<Column> kAllTypes = {
    {"label", kUInt32, 1},     {"x", kFloat64, 1},        {"y", kFloat64, 1},
    {"z", kFloat64, 1},        {"i8", kInt8, 1},          {"u8", kUInt8, 1},
    {"i16", kInt16, 1},        {"u16", kUInt16, 1},       {"i32", kInt32, 1},
    {"i64", kInt64, 1},        {"u64", kUInt64, 1},       {"normal_x", kFloat32, 1},
    {"normal_y", kFloat32, 1}, {"normal_z", kFloat32, 1}, {"rgba", kUInt32, 1},
    {"fpfh", kFloat32, 33}};

std::vector<std::uint8_t> fieldBytes(const PointTable& cloud, const std::string& name) {
  std::vector<std::uint8_t> bytes;
  const PointField& field = cloud.fields[static_cast<std::size_t>(findField(cloud, name))];
  const std::size_t size = scalarSize(field.datatype) * field.count;
  for (std::size_t i = 0; i < numPoints(cloud); ++i) {
    const auto* at = cloud.data.data() + i * cloud.point_step + field.offset;
    bytes.insert(bytes.end(), at, at + size);
  }
  return bytes;
}

std::vector<std::uint8_t> fieldBytes(vtkDataArray* array) {
  const auto* at = static_cast<const std::uint8_t*>(array->GetVoidPointer(0));
  const auto count = array->GetNumberOfValues() * array->GetDataTypeSize();
  return {at, at + count};
}

/** The bytes of three fields next to each other. */
std::vector<std::uint8_t> tripleBytes(const PointTable& cloud, const char* const (&names)[3],
                                      std::size_t size) {
  std::vector<std::uint8_t> bytes, part[3];
  for (int k = 0; k < 3; ++k) part[k] = fieldBytes(cloud, names[k]);
  for (std::size_t i = 0; i < numPoints(cloud); ++i) {
    for (const auto& p : part) bytes.insert(bytes.end(), &p[i * size], &p[i * size] + size);
  }
  return bytes;
}

vtkSmartPointer<vtkPolyData> readByVtk(const std::string& path) {
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  return reader->GetOutput();
}

TEST(VtpPoints, VtkReadsEveryValue) {
  const TemporaryFolder folder;
  const PointFile file = randomPoints(kAllTypes, 300);
  ASSERT_FALSE(savePointFile(folder / "a.vtp", file));
  const auto data = readByVtk(folder / "a.vtp");
  ASSERT_EQ(data->GetNumberOfPoints(), 300);
  const PointTable& cloud = file.cloud;
  EXPECT_EQ(fieldBytes(data->GetPoints()->GetData()), tripleBytes(cloud, {"x", "y", "z"}, 8));
  vtkPointData* const point = data->GetPointData();
  ASSERT_NE(point->GetNormals(), nullptr);
  EXPECT_STREQ(point->GetNormals()->GetName(), "Normals");
  EXPECT_EQ(fieldBytes(point->GetNormals()),
            tripleBytes(cloud, {"normal_x", "normal_y", "normal_z"}, 4));
  for (const char* name : {"label", "i8", "u8", "i16", "u16", "i32", "i64", "u64", "fpfh"}) {
    ASSERT_NE(point->GetArray(name), nullptr) << name;
    EXPECT_EQ(fieldBytes(point->GetArray(name)), fieldBytes(cloud, name)) << name;
  }
  EXPECT_EQ(point->GetNumberOfArrays(), 12);
}

TEST(VtpPoints, PackedColoursAreBytes) {
  const TemporaryFolder folder;
  const PointFile file = randomPoints(kAllTypes, 300);
  ASSERT_FALSE(savePointFile(folder / "a.vtp", file));
  const auto data = readByVtk(folder / "a.vtp");
  vtkPointData* const point = data->GetPointData();
  const auto packed = fieldBytes(file.cloud, "rgba");
  const auto rgb = fieldBytes(point->GetArray("RGB")), alpha = fieldBytes(point->GetArray("alpha"));
  ASSERT_EQ(rgb.size(), 900u);
  EXPECT_EQ(point->GetScalars(), point->GetArray("RGB"));
  for (std::size_t i = 0; i < 300; ++i) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(rgb[3 * i + k], packed[4 * i + 2 - k]);
    EXPECT_EQ(alpha[i], packed[4 * i + 3]);
  }
}

TEST(VtpPoints, ComeBackWithEveryFieldOfItsTypeAndCount) {
  const TemporaryFolder folder;
  PointFile file = randomPoints(kAllTypes, 200);
  file.comments = {"a scan", "", "pcl_slim kind none"};
  ASSERT_FALSE(savePointFile(folder / "a.vtp", file));
  const auto read = loadPointFile(folder / "a.vtp");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->comments, file.comments);
  EXPECT_TRUE(read->left_out.empty());
  ASSERT_EQ(read->cloud.fields.size(), file.cloud.fields.size());
  for (const PointField& field : file.cloud.fields) {
    const int i = findField(read->cloud, field.name);
    ASSERT_GE(i, 0) << field.name;
    EXPECT_EQ(read->cloud.fields[static_cast<std::size_t>(i)].datatype, field.datatype);
    EXPECT_EQ(read->cloud.fields[static_cast<std::size_t>(i)].count, field.count);
    EXPECT_EQ(fieldBytes(read->cloud, field.name), fieldBytes(file.cloud, field.name))
        << field.name;
  }
  // Coordinates come first; the other fields keep their order. Then nothing changes any more.
  ASSERT_FALSE(savePointFile(folder / "b.vtp", *read));
  const auto again = loadPointFile(folder / "b.vtp");
  ASSERT_TRUE(again);
  EXPECT_EQ(again->cloud.data, read->cloud.data);
  EXPECT_EQ(fileBytes(folder / "a.vtp"), fileBytes(folder / "b.vtp"));
}

TEST(VtpPoints, PointsWithoutCoordinatesStayAndAreInNoCell) {
  const TemporaryFolder folder;
  PointFile file = randomPoints({{"x", kFloat32, 1}, {"y", kFloat32, 1}, {"z", kFloat32, 1}}, 60);
  auto& cloud = file.cloud;
  for (std::size_t i = 0; i < 60; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      float value = static_cast<float>(i) + static_cast<float>(k);
      if (i % 5 == 2 && k == i % 3) value = std::numeric_limits<float>::quiet_NaN();
      std::memcpy(&cloud.data[i * cloud.point_step + cloud.fields[k].offset], &value, 4);
    }
  }
  ASSERT_FALSE(savePointFile(folder / "a.vtp", file));
  const auto data = readByVtk(folder / "a.vtp");
  EXPECT_EQ(data->GetNumberOfPoints(), 60);
  EXPECT_EQ(data->GetNumberOfVerts(), 48);
  EXPECT_EQ(fieldBytes(data->GetPoints()->GetData()), tripleBytes(cloud, {"x", "y", "z"}, 4));
  double bounds[6];
  data->GetCellsBounds(bounds);
  EXPECT_EQ(bounds[0], 0.0);
  EXPECT_EQ(bounds[1], 59.0);
  const auto read = loadPointFile(folder / "a.vtp");
  ASSERT_TRUE(read);
  EXPECT_EQ(fieldBytes(read->cloud, "y"), fieldBytes(cloud, "y"));
}

TEST(VtpPoints, FacesArePolygons) {
  const TemporaryFolder folder;
  PointFile file = randomPoints({{"x", kFloat32, 1}, {"y", kFloat32, 1}, {"z", kFloat32, 1}}, 9);
  file.face_begin = {0, 3, 7, 10};
  file.face_vertices = {0, 1, 2, 8, 7, 6, 5, 2, 3, 4};
  ASSERT_FALSE(savePointFile(folder / "a.vtp", file));
  const auto data = readByVtk(folder / "a.vtp");
  EXPECT_EQ(data->GetNumberOfPolys(), 3);
  EXPECT_EQ(data->GetNumberOfVerts(), 0);
  const auto read = loadPointFile(folder / "a.vtp");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->face_begin, file.face_begin);
  EXPECT_EQ(read->face_vertices, file.face_vertices);
  file.face_vertices[4] = 9;
  EXPECT_NE(savePointFile(folder / "a.vtp", file).message.find("vertex 9 of 9"), std::string::npos);
}

TEST(VtpPoints, AFieldWithAnArraysNameIsNotThatArray) {
  const TemporaryFolder folder;
  for (const char* color : {"rgb", "rgba"}) {
    const std::uint8_t type = color == std::string("rgb") ? kFloat32 : kUInt32;
    PointFile file = randomPoints({{"x", kFloat32, 1},
                                   {"y", kFloat32, 1},
                                   {"z", kFloat32, 1},
                                   {"alpha", kUInt8, 1},
                                   {"RGB", kUInt8, 3},
                                   {"Normals", kFloat32, 3},
                                   {color, type, 1},
                                   {"normal_x", kFloat32, 1},
                                   {"normal_y", kFloat32, 1},
                                   {"normal_z", kFloat32, 1}},
                                  50);
    ASSERT_FALSE(savePointFile(folder / "a.vtp", file));
    const auto read = loadPointFile(folder / "a.vtp");
    ASSERT_TRUE(read) << read.error().message;
    for (const char* name : {"alpha", "RGB", "Normals"})
      EXPECT_EQ(fieldBytes(read->cloud, name + std::string("_")), fieldBytes(file.cloud, name));
    EXPECT_EQ(fieldBytes(read->cloud, "normal_y"), fieldBytes(file.cloud, "normal_y"));
    const auto packed = fieldBytes(file.cloud, color), again = fieldBytes(read->cloud, "rgba");
    EXPECT_EQ(again, packed) << color;
  }
}

TEST(VtpPoints, ATakenNameGrows) {
  const TemporaryFolder folder;
  PointFile file = randomPoints({{"x", kInt32, 1},
                                 {"y", kInt32, 1},
                                 {"z", kFloat32, 1},
                                 {"rgb", kFloat32, 1},
                                 {"rgba", kUInt32, 1},
                                 {"alpha", kUInt16, 1},
                                 {"normal_x", kFloat32, 1}},
                                50);
  ASSERT_FALSE(savePointFile(folder / "a.vtp", file));
  const auto data = readByVtk(folder / "a.vtp");
  vtkPointData* const point = data->GetPointData();
  EXPECT_EQ(point->GetNumberOfArrays(), 5);
  EXPECT_EQ(fieldBytes(point->GetArray("alpha_")), fieldBytes(file.cloud, "alpha"));
  EXPECT_EQ(fieldBytes(point->GetArray("rgba")), fieldBytes(file.cloud, "rgba"));
  EXPECT_EQ(fieldBytes(point->GetArray("normal_x")), fieldBytes(file.cloud, "normal_x"));
  for (vtkIdType i = 0; i < 50; ++i) {
    for (int k = 0; k < 2; ++k) {
      const auto p = static_cast<std::size_t>(i);
      EXPECT_EQ(data->GetPoint(i)[k],
                fieldValue(file.cloud, p, file.cloud.fields[static_cast<std::size_t>(k)]));
    }
  }
  file.cloud.fields[1].name = "other";
  const Error error = savePointFile(folder / "b.vtp", file);
  EXPECT_NE(error.message.find("x y z"), std::string::npos) << error.message;
  EXPECT_EQ(folder.numFiles(), 1u);
}

TEST(VtpPoints, FacesMayHaveNoCorners) {
  const TemporaryFolder folder;
  writeText(folder / "a.vtp",
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" "
            "byte_order=\"LittleEndian\"><PolyData>"
            "<Piece NumberOfPoints=\"1\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
            "NumberOfStrips=\"0\" NumberOfPolys=\"2\"><Points>"
            "<DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">1 2 3"
            "</DataArray></Points><Polys>"
            "<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\"></DataArray>"
            "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">0 0</DataArray>"
            "</Polys></Piece></PolyData></VTKFile>\n");
  const auto file = loadPointFile(folder / "a.vtp");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->face_begin, (std::vector<std::uint32_t>{0, 0, 0}));
  EXPECT_TRUE(file->face_vertices.empty());
  EXPECT_FALSE(file->validate());
}

/** VTK's writer reads from a null pointer at cells of fewer than three corners. */
TEST(VtpPoints, FacesOfFewCornersAreLeftOut) {
  const TemporaryFolder folder;
  PointFile file = randomPoints(kAllTypes, 4);
  file.face_begin = {0, 0, 1, 3, 6};
  file.face_vertices = {0, 1, 2, 3, 2, 1};
  ASSERT_FALSE(savePointFile(folder / "a.vtp", file));
  const auto read = loadPointFile(folder / "a.vtp");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->face_begin, (std::vector<std::uint32_t>{0, 3}));
  EXPECT_EQ(read->face_vertices, (std::vector<std::uint32_t>{3, 2, 1}));
  file.face_begin = {0, 0, 0};
  file.face_vertices.clear();
  ASSERT_FALSE(savePointFile(folder / "b.vtp", file));
  EXPECT_EQ(loadPointFile(folder / "b.vtp")->numFaces(), 0u);
}

TEST(VtpPoints, DamageNeverCrashesAndIsToldInOneLine) {
  const TemporaryFolder folder;
  PointFile file = randomPoints(kAllTypes, 12);
  file.face_begin = {0, 3, 6};
  file.face_vertices = {0, 1, 2, 3, 2, 1};
  ASSERT_FALSE(savePointFile(folder / "a.vtp", file));
  const auto bytes = fileBytes(folder / "a.vtp");
  std::mt19937 random(3);
  int refused = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    auto damaged = bytes;
    for (int k = 0; k <= trial % 3; ++k)
      damaged[random() % damaged.size()] = static_cast<unsigned char>(random());
    if (trial % 5 == 0) damaged.resize(random() % damaged.size());
    writeBytes(folder / "b.vtp", damaged);
    const auto read = loadPointFile(folder / "b.vtp");
    if (read) {
      for (const std::uint32_t v : read->face_vertices) ASSERT_LT(v, numPoints(read->cloud));
      continue;
    }
    ++refused;
    EXPECT_EQ(read.error().message.find('\n'), std::string::npos) << read.error().message;
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace pcl_slim
#endif

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/record_layout.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "pcl_slim/filters/io/point_file.h"
#include "support/temporary_folder.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

constexpr std::size_t kPoints = 300000;  ///< more than one piece

/** All coordinates, then all normals, of a source. */
std::vector<double> valuesOf(const std::string& path, bool normals) {
  const auto layout = recordLayoutOf(path, normals);
  EXPECT_TRUE(layout) << layout.error().message;
  if (!layout) return {};
  RecordSource source(*layout);
  EXPECT_EQ(source.hasNormals(), normals);
  std::vector<double> values;
  const Error error = source.pass([&](const CloudView& piece) {
    for (std::size_t i = 0; i < piece.size; ++i) {
      const auto* at = static_cast<const char*>(piece.xyz) + i * piece.xyz_stride;
      for (std::size_t a = 0; a < 3; ++a) {
        float f = 0;
        double d = 0;
        std::memcpy(&f, at + 4 * a, 4);
        if (piece.scalar == CloudView::Scalar::kDouble) std::memcpy(&d, at + 8 * a, 8);
        values.push_back(piece.scalar == CloudView::Scalar::kDouble ? d : double{f});
      }
      if (piece.normal == nullptr) continue;
      float n[3];
      std::memcpy(n, static_cast<const char*>(piece.normal) + i * piece.normal_stride, sizeof(n));
      values.insert(values.end(), n, n + 3);
    }
    return Error();
  });
  EXPECT_FALSE(error) << error.message;
  return values;
}

double coordinate(std::size_t i, std::size_t a) {
  return static_cast<double>(static_cast<float>(0.25 * static_cast<double>(i % 1000) +
                                                1e-3 * static_cast<double>(i / 1000) +
                                                static_cast<double>(a)));
}

std::vector<double> expected(std::size_t count, bool normals) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t a = 0; a < 3; ++a) values.push_back(coordinate(i, a));
    if (normals) values.insert(values.end(), {0, 0.5, 1});
  }
  return values;
}

void put(std::vector<unsigned char>& bytes, double value, std::size_t size, bool turn) {
  unsigned char raw[8];
  const auto narrow = static_cast<float>(value);
  if (size == 4) std::memcpy(raw, &narrow, 4);
  if (size == 8) std::memcpy(raw, &value, 8);
  for (std::size_t b = 0; b < size; ++b) bytes.push_back(raw[turn ? size - 1 - b : b]);
}

/** A file of points with an intensity between coordinates and normals. */
std::vector<unsigned char> binaryFile(const std::string& header, std::size_t size, bool turn,
                                      std::size_t count) {
  std::vector<unsigned char> bytes(header.begin(), header.end());
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t a = 0; a < 3; ++a) put(bytes, coordinate(i, a), size, turn);
    bytes.push_back(7);
    for (const double n : {0.0, 0.5, 1.0}) put(bytes, n, 4, turn);
  }
  return bytes;
}

std::string plyHeader(const std::string& form, const std::string& type, std::size_t count) {
  return "ply\nformat " + form + " 1.0\nelement vertex " + std::to_string(count) + "\nproperty " +
         type + " x\nproperty " + type + " y\nproperty " + type +
         " z\nproperty uchar intensity\nproperty float nx\nproperty float ny\nproperty float nz\n"
         "end_header\n";
}

std::string pcdHeader(const std::string& data, std::size_t count) {
  return "VERSION 0.7\nFIELDS x y z i normal_x normal_y normal_z\nSIZE 4 4 4 1 4 4 4\n"
         "TYPE F F F U F F F\nCOUNT 1 1 1 1 1 1 1\nWIDTH " +
         std::to_string(count) + "\nHEIGHT 1\nVIEWPOINT 1 2 3 1 0 0 0\nDATA " + data + "\n";
}

std::string textBody(std::size_t count) {
  std::string text;
  char line[100];
  for (std::size_t i = 0; i < count; ++i) {
    std::snprintf(line, sizeof(line), "%.9g %.9g %.9g 7 0 0.5 1\n", coordinate(i, 0),
                  coordinate(i, 1), coordinate(i, 2));
    text += line;
  }
  return text;
}

TEST(RecordLayout, ReadsEveryForm) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& name, const std::vector<unsigned char>& bytes,
                        std::size_t count) {
    const std::string path = folder / (name);
    writeBytes(path, bytes);
    EXPECT_EQ(valuesOf(path, true), expected(count, true)) << name;
    EXPECT_EQ(valuesOf(path, false), expected(count, false)) << name;
  };
  const auto ply = [](const char* form, const char* type) {
    return plyHeader(form, type, kPoints);
  };
  read("a.ply", binaryFile(ply("binary_little_endian", "float"), 4, false, kPoints), kPoints);
  read("b.ply", binaryFile(ply("binary_little_endian", "double"), 8, false, kPoints), kPoints);
  read("c.ply", binaryFile(ply("binary_big_endian", "double"), 8, true, kPoints), kPoints);
  read("d.pcd", binaryFile(pcdHeader("binary", kPoints), 4, false, kPoints), kPoints);
  const std::string text = textBody(70000);
  for (const std::string& head : {plyHeader("ascii", "float", 70000), pcdHeader("ascii", 70000)}) {
    const std::string all = head + text;
    read(head[0] == 'p' ? "e.ply" : "f.pcd", {all.begin(), all.end()}, 70000);
  }
}

TEST(RecordLayout, ReadsTripletsWithoutAHeader) {
  const TemporaryFolder folder;
  for (const std::size_t size : {4, 8}) {
    std::vector<unsigned char> bytes;
    for (std::size_t i = 0; i < 1000; ++i) {
      for (std::size_t a = 0; a < 3; ++a) put(bytes, coordinate(i, a), size, false);
    }
    const std::string path = folder / (size == 4 ? "a.f32" : "a.f64");
    writeBytes(path, bytes);
    EXPECT_TRUE(isRawPointFile(path));
    EXPECT_EQ(valuesOf(path, false), expected(1000, false));
    bytes.pop_back();
    writeBytes(path, bytes);
    const auto cut = recordLayoutOf(path, false);
    EXPECT_EQ(cut.error().code, ErrorCode::kBadInput);
  }
}

TEST(RecordLayout, KnowsTheSensor) {
  const TemporaryFolder folder;
  const std::string path = folder / ("a.pcd");
  writeBytes(path, binaryFile(pcdHeader("binary", 100), 4, false, 100));
  const auto layout = recordLayoutOf(path, true);
  ASSERT_TRUE(layout);
  ASSERT_TRUE(layout->sensor.has_value());
  EXPECT_EQ((*layout->sensor)[2], 3.0);
}

TEST(RecordLayout, SaysWhatCannotBeStreamed) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& name, const std::string& text,
                           const std::string& word) {
    const std::string path = folder / (name);
    writeText(path, text);
    const auto layout = recordLayoutOf(path, true);
    EXPECT_FALSE(layout);
    EXPECT_EQ(layout.error().code, ErrorCode::kBadArgument);
    EXPECT_NE(layout.error().message.find(word), std::string::npos) << layout.error().message;
  };
  refused("a.pcd", pcdHeader("binary_compressed", 4), "pcl_convert_pcd_ascii_binary");
  refused("a.las", "LASF", "convert it");
  const std::string faces =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n1 2 "
      "3\n";
  refused("a.ply", faces, "-use_normals 0");
}

TEST(RecordLayout, NamesDefects) {
  const TemporaryFolder folder;
  const auto bad = [&](const std::string& name, const std::vector<unsigned char>& bytes,
                       const std::string& word) {
    const std::string path = folder / (name);
    writeBytes(path, bytes);
    const auto layout = recordLayoutOf(path, true);
    ASSERT_FALSE(layout);
    EXPECT_NE(layout.error().code, ErrorCode::kBadArgument);
    EXPECT_NE(layout.error().message.find(word), std::string::npos) << layout.error().message;
  };
  auto cut = binaryFile(pcdHeader("binary", 100), 4, false, 100);
  cut.pop_back();
  bad("cut.pcd", cut, "truncated: 99 of 100");
  bad("empty.ply", {}, "empty");
  const std::string other =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float a\nend_header\n1\n";
  bad("other.ply", {other.begin(), other.end()}, "x y z");
  EXPECT_EQ(recordLayoutOf(folder / ("none.pcd"), true).error().code, ErrorCode::kIo);
}

TEST(RecordSource, NamesTheByteWhereAFileHasBecomeShorter) {
  const TemporaryFolder folder;
  const std::string path = folder / ("a.pcd");
  writeBytes(path, binaryFile(pcdHeader("binary", kPoints), 4, false, kPoints));
  const auto layout = recordLayoutOf(path, true);
  ASSERT_TRUE(layout);
  RecordSource source(*layout);
  std::filesystem::resize_file(path, 5000000);
  const Error error = source.pass([](const CloudView&) { return Error(); });
  EXPECT_EQ(error.code, ErrorCode::kBadInput);
  EXPECT_NE(error.message.find("ends at byte 5000000"), std::string::npos) << error.message;
}

TEST(RecordSource, NoticesAFileThatIsOverwrittenWhileItIsRead) {
  const TemporaryFolder folder;
  const std::string path = folder / ("a.pcd");
  const auto bytes = binaryFile(pcdHeader("binary", kPoints), 4, false, kPoints);
  writeBytes(path, bytes);
  const auto layout = recordLayoutOf(path, true);
  ASSERT_TRUE(layout);
  const auto look = [](const CloudView&) { return Error(); };
  RecordSource source(*layout);
  EXPECT_FALSE(source.pass(look));
  EXPECT_FALSE(source.pass(look));
  const auto overwrite = [&](const CloudView&) {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.write(reinterpret_cast<const char*>(bytes.data()), 1);  // the size stays
    file.close();
    const auto now = std::filesystem::last_write_time(path);
    std::filesystem::last_write_time(path, now + std::chrono::milliseconds(20));
    return Error();
  };
  EXPECT_NE(source.pass(overwrite).message.find("changed while"), std::string::npos);
  EXPECT_NE(source.pass(look).message.find("changed while"), std::string::npos);
}

TEST(RecordSource, NamesTheRowOfATextWhereItEndsOrIsNoNumber) {
  const TemporaryFolder folder;
  const std::string path = folder / ("a.pcd");
  const auto message = [&](const std::string& body) {
    writeText(path, pcdHeader("ascii", 3) + body);
    const auto layout = recordLayoutOf(path, true);
    EXPECT_TRUE(layout);
    RecordSource source(*layout);
    return source.pass([](const CloudView&) { return Error(); }).message;
  };
  EXPECT_NE(message("1 2 3 4 5 6 7\n1 2 3 4 5 6 7\n1 2").find("point 2"), std::string::npos);
  EXPECT_NE(message("1 2 3 4 5 6 7\n1 2x 3 4 5 6 7\n1 2 3 4 5 6 7\n").find("2x"),
            std::string::npos);
  EXPECT_EQ(message("nan 2 +3 4 5 6 7\n1 2 3 4 5 6 7\n1 2 3e0 4 5 6 7"), "");
}

}  // namespace

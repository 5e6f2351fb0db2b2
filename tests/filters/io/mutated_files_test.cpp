// SPDX-License-Identifier: BSD-3-Clause
// Files of every format with words, bytes and lines changed at random: each is refused in one sentence, or
// read as points that are consistent and no more than its bytes can have.
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/filters/io/splat_files.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "support/las_bytes.h"
#include "support/temporary_folder.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using Bytes = std::vector<unsigned char>;

constexpr std::size_t kHead = 400;  ///< bytes in which most changes are made

const char* const kWords[] = {
    "0",     "-1",         "1",   "3",          "599",  "2.5",
    "1e9",   "4294967295", "nan", "4294967296", "inf",  "18446744073709551616",
    "x",     "\"",         "",    "ascii",      "list", "binary",
    "float", "0x10",       "#",   "1e308",      "uchar"};

/** The places where words of text begin, with the byte behind them. */
std::vector<std::pair<std::size_t, std::size_t>> wordsOf(const Bytes& bytes) {
  std::vector<std::pair<std::size_t, std::size_t>> words;
  const std::size_t end = std::min(bytes.size(), kHead);
  for (std::size_t at = 0; at < end;) {
    while (at < end && bytes[at] <= ' ') ++at;
    const std::size_t begin = at;
    while (at < end && bytes[at] > ' ') ++at;
    if (at > begin) words.push_back({begin, at});
  }
  return words;
}

class Mutator {
 public:
  explicit Mutator(unsigned int seed) : random_(seed) {}

  void change(Bytes& bytes) {
    if (bytes.empty()) return;
    switch (below(6)) {
      case 0: return changeWord(bytes);
      case 1: return changeWord(bytes);
      case 2:
        bytes[below(std::min(bytes.size(), kHead))] = static_cast<unsigned char>(below(256));
        return;
      case 3: bytes.resize(below(bytes.size() + 1)); return;
      case 4: return putNumber(bytes);
      default: return copyPart(bytes);
    }
  }

  std::size_t below(std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_);
  }

 private:
  void changeWord(Bytes& bytes) {
    const auto words = wordsOf(bytes);
    if (words.empty()) return;
    const auto [begin, end] = words[below(words.size())];
    const std::string word = kWords[below(std::size(kWords))];
    const auto at = bytes.begin() + static_cast<std::ptrdiff_t>(begin);
    bytes.insert(bytes.erase(at, at + static_cast<std::ptrdiff_t>(end - begin)), word.begin(),
                 word.end());
  }

  /** A number of 32 bits at any place. */
  void putNumber(Bytes& bytes) {
    constexpr std::uint32_t kNumbers[] = {0,           1,           0x7fffffffu, 0x80000000u,
                                          0xffffffffu, 0x7fc00000u, 65536};
    if (bytes.size() < 4) return;
    const std::uint32_t number = kNumbers[below(std::size(kNumbers))];
    std::memcpy(bytes.data() + below(std::min(bytes.size(), kHead) - 3), &number, 4);
  }

  void copyPart(Bytes& bytes) {
    const std::size_t length = 1 + below(std::min<std::size_t>(bytes.size(), 40));
    const std::size_t from = below(bytes.size() - length + 1),
                      to = below(std::min(bytes.size(), kHead));
    const Bytes part(bytes.begin() + static_cast<std::ptrdiff_t>(from),
                     bytes.begin() + static_cast<std::ptrdiff_t>(from + length));
    bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(to), part.begin(), part.end());
  }

  std::mt19937 random_;
};

Bytes bytesOf(const std::string& text) {
  return {text.begin(), text.end()};
}

/** A mesh with every kind of field, as each writer makes it, and texts by hand. */
std::vector<std::pair<std::string, Bytes>> originals() {
  PointFile file;
  PointTable& cloud = file.cloud;
  for (const char* name : {"x", "y", "z", "normal_x", "normal_y", "normal_z"})
    addField(cloud, name, kFloat32);
  addField(cloud, "rgb", kFloat32);
  addField(cloud, "radius", kFloat32);
  addField(cloud, "label", kUInt16, 3);
  cloud.resize(24);
  Mutator random(3);
  for (std::uint8_t& byte : cloud.data) byte = static_cast<std::uint8_t>(random.below(64));
  file.face_begin = {0, 3, 7};
  file.face_vertices = {0, 1, 2, 3, 4, 5, 6};
  file.comments = {"a comment", "pcl_slim version 1"};
  const TemporaryFolder folder;
  std::vector<std::pair<std::string, Bytes>> made;
  for (const char* extension : {".pcd", ".ply", ".vtp"}) {
    const std::string path = folder / ("a" + std::string(extension));
    if (!savePointFile(path, file)) made.push_back({extension, fileBytes(path)});
  }
  for (const int format : {1, 3, 7}) made.push_back({".las", lasBytes(format, 12, true).bytes});
  const std::string header =
      "VERSION .7\nFIELDS x y z _ c\nSIZE 4 4 8 1 1\nTYPE F F F U I\nCOUNT 1 1 1 3 2\nWIDTH 2\n"
      "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ";
  made.push_back({".pcd", bytesOf(header + "ascii\n1 2 3 9 9 9 4 5\n1 2 3 9 9 9 4 5\n")});
  made.push_back(
      {".pcd", bytesOf(header + "binary_compressed\n" + std::string("\x2c\0\0\0\x2a\0\0\0", 8) +
                       "\x1f" + std::string(32, 'a') + "\x09" + std::string(10, 'b'))});
  made.push_back({".ply", bytesOf("ply\nformat ascii 1.0\ncomment c\nelement vertex 3\nproperty "
                                  "float x\nproperty double y\n"
                                  "property float z\nproperty list uchar int tags\nelement face 1\n"
                                  "property list uchar int vertex_indices\nend_header\n1 2 3 1 "
                                  "9\n4 5 6 0\n7 8 9 2 1 1\n3 0 1 2\n")});
  made.push_back({".xyz", bytesOf("# x y z\n1 2 3\n4 5 6\n7 8 9\n")});
  made.push_back({".csv", bytesOf("x,y,z,red,green,blue\n1,2,3,4,5,6\n4,5,6,7,8,9\n")});
  made.push_back({".pts", bytesOf("2\n1 2 3 -50 10 20 30\n4 5 6 70 1 2 3\n")});
  made.push_back(
      {".csv",
       bytesOf("sep=;\r\n\"x\";\"y, \"\"n\"\"\";z;\"\"\r\n1,5;\"2,5\";NA;\r\n4;5;6;7\r\n")});
  made.push_back({".txt", bytesOf("# ID, X, Y, Z, T[] as (A, B)\n1 2 3 4 5 6 7\n2 3 4 5\n")});
  made.push_back({".txt", bytesOf(std::string("\xff\xfe\x31\0 \0\x32\0 \0\x33\0\n\0", 14))});
  made.push_back({".ptx", bytesOf("1\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
                                  "5 6 7 1\n1 2 3 .5 1 2 3\n0 0 0 0 0 0 0\n")});
  made.push_back({".obj", bytesOf("# o\nv 1 2 3\nv 4 5 6 1 0 0\nv 7 8 9\nvn 0 0 1\nvt 0 0\nf 1//1 "
                                  "2//1 3/1/1\nf -1 -2 -3\n")});
  made.push_back(
      {".off",
       bytesOf("COFF\n3 1 0\n0 0 0 1 1 1 1\n1 0 0 255 0 0 255\n0 1 0 0 0 0 1\n3 0 1 2 1 0 0\n")});
  made.push_back(
      {".stl",
       bytesOf("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
               "endloop\nendfacet\nendsolid\n")});
  Bytes binary(84 + 50, 1);
  const std::uint32_t one = 1;
  std::memcpy(binary.data() + 80, &one, 4);
  made.push_back({".stl", binary});
  return made;
}

TEST(MutatedFiles, AreRefusedInOneSentenceOrConsistent) {
  constexpr int kMutations = 1500;
  for (const auto& [extension, original] : originals()) {
    Mutator mutator(17);
    int read = 0;
    for (int i = 0; i < kMutations; ++i) {
      Bytes bytes = original;
      for (std::size_t k = 1 + mutator.below(4); k > 0; --k) mutator.change(bytes);
      const auto file = parsePointFile("a" + extension, bytes);
      if (!file) {
        const std::string& message = file.error().message;
        EXPECT_FALSE(message.empty()) << extension;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        EXPECT_LT(message.size(), 500u) << message;
        continue;
      }
      ++read;
      const Error error = file->validate();
      EXPECT_FALSE(error) << extension << " " << i << ": " << error.message;
      EXPECT_LE(numPoints(file->cloud), 3 * bytes.size()) << extension << " " << i;
      (void)splatsFrom(*file);
      (void)surfaceFrom(*file);
    }
    EXPECT_GT(read, 0) << extension << ": no change leaves a file that is read";
  }
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "io/mesh_points.h"
#include "io/point_formats.h"
#include "io/text/text.h"

namespace pcl_slim {

namespace {

/** The words of a file without its comments. */
std::vector<unsigned char> withoutComments(std::vector<unsigned char> bytes) {
  bool comment = false;
  for (unsigned char& c : bytes) {
    if (c == '#') comment = true;
    if (c == '\n') comment = false;
    if (comment) c = ' ';
  }
  return bytes;
}

class OffReader {
 public:
  explicit OffReader(const std::vector<unsigned char>& bytes)
      : scanner_(bytes.data(), bytes.size()) {}

  Result<PointFile> read() {
    if (Error error = readHead()) return error;
    for (std::size_t i = 0; i < vertices_; ++i) {
      if (Error error = readVertex(i)) return error;
    }
    if (!whole_colors_ && !colors_.empty()) white_ = 1.0;
    for (const auto& c : colors_)
      mesh_.colors.push_back({byteOf(c[0]), byteOf(c[1]), byteOf(c[2])});
    for (std::size_t i = 0; i < faces_; ++i) {
      if (Error error = readFace(i)) return error;
    }
    Result<PointFile> file = toPointFile(mesh_, "OFF");
    if (file && face_colors_) file->left_out.push_back("the colours of faces");
    return file;
  }

 private:
  /** A line that is not blank. */
  bool nextLine(std::vector<std::string>& words) {
    std::string line;
    do {
      if (!scanner_.nextLine(line)) return false;
      words = splitWords(line);
    } while (words.empty());
    return true;
  }

  static bool parseNumber(const std::string& word, double& value, bool& in_float) {
    return parseDecimal(word.data(), word.data() + word.size(), value, in_float);
  }

  Error readHead() {
    std::vector<std::string> words;
    std::string key = nextLine(words) ? words[0] : "";
    normals_ = key == "NOFF" || key == "CNOFF";
    has_colors_ = key == "COFF" || key == "CNOFF";
    if (key != "OFF" && !normals_ && !has_colors_)
      return badInput("not an OFF file: it starts with none of OFF, COFF, NOFF and CNOFF");
    if (words.size() > 1 && words[1] == "BINARY")
      return badInput("binary OFF files are not read; write it as ASCII");
    words.erase(words.begin());
    if (words.empty() && !nextLine(words)) return truncated("counts", 0, 2);
    double counts[2] = {};
    bool ignored = false;
    for (std::size_t k = 0; k < 2; ++k) {
      if (words.size() < 2 || !parseNumber(words[k], counts[k], ignored) || !(counts[k] >= 0) ||
          counts[k] > 4294967294.0 || counts[k] != std::floor(counts[k]))
        return badInput("the OFF file gives no counts of vertices and faces; write it again");
    }
    vertices_ = static_cast<std::size_t>(counts[0]);
    faces_ = static_cast<std::size_t>(counts[1]);
    return {};
  }

  static Error truncated(const std::string& what, std::size_t have, std::size_t want) {
    return badInput("the OFF file is truncated: " + std::to_string(have) + " of " +
                    std::to_string(want) + " " + what + "; copy it again");
  }

  Error readVertex(std::size_t i) {
    std::vector<std::string> words;
    if (!nextLine(words)) return truncated("vertices", i, vertices_);
    std::array<double, 10> v{};
    bool ignored = false;
    const std::size_t needed = normals_ ? 6u : 3u, count = std::min(words.size(), v.size());
    bool good = count >= needed + (has_colors_ ? 3u : 0u);
    for (std::size_t k = 0; k < count && good; ++k) {
      good = parseNumber(words[k], v[k], k < 3 ? mesh_.in_float : ignored);
      if (k >= needed) whole_colors_ = whole_colors_ && words[k].find('.') == std::string::npos;
    }
    if (!good)
      return badInput("vertex " + std::to_string(i) +
                      " of the OFF file is no list of numbers, or "
                      "has too few; mend it");
    mesh_.positions.push_back({v[0], v[1], v[2]});
    if (normals_)
      mesh_.normals.push_back(
          {static_cast<float>(v[3]), static_cast<float>(v[4]), static_cast<float>(v[5])});
    if (has_colors_) colors_.push_back({v[needed], v[needed + 1], v[needed + 2]});
    return {};
  }

  Error readFace(std::size_t i) {
    std::vector<std::string> words;
    if (!nextLine(words)) return truncated("faces", i, faces_);
    double corners = 0, vertex = 0;
    bool ignored = false;
    const auto isIndex = [](double value) { return value >= 0 && value == std::floor(value); };
    bool good = parseNumber(words[0], corners, ignored) && isIndex(corners) &&
                corners < static_cast<double>(words.size());
    const std::size_t count = good ? static_cast<std::size_t>(corners) : 0;
    for (std::size_t k = 1; k <= count && good; ++k) {
      good = parseNumber(words[k], vertex, ignored) && isIndex(vertex) && vertex < 4294967295.0;
      if (good) mesh_.face_vertices.push_back(static_cast<std::uint32_t>(vertex));
    }
    if (!good)
      return badInput("face " + std::to_string(i) +
                      " of the OFF file is no list of vertices; mend it");
    face_colors_ = face_colors_ || words.size() > count + 1;
    mesh_.endFace();
    return {};
  }

  std::uint8_t byteOf(double value) const {
    const double share = value / white_;
    return share > 0 ? static_cast<std::uint8_t>(std::lround(255 * std::min(share, 1.0)))
                     : std::uint8_t{0};
  }

  TextScanner scanner_;
  bool normals_ = false, has_colors_ = false, face_colors_ = false, whole_colors_ = true;
  double white_ = 255.0;
  std::size_t vertices_ = 0, faces_ = 0;
  MeshPoints mesh_;
  std::vector<std::array<double, 3>> colors_;
};

}  // namespace

Result<PointFile> parseOff(const std::vector<unsigned char>& bytes) {
  return OffReader(withoutComments(bytes)).read();
}

}  // namespace pcl_slim

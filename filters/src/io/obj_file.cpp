// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "io/mesh_points.h"
#include "io/point_formats.h"
#include "io/text/text.h"

namespace pcl_slim {

namespace {

constexpr std::int64_t kNone = -1;

/** Words of one line in place. */
class Words {
 public:
  Words(const char* at, const char* end) : at_(at), end_(end) {}

  bool next(const char*& begin, const char*& end) {
    while (at_ != end_ && isBlank(*at_)) ++at_;
    begin = at_;
    while (at_ != end_ && !isBlank(*at_)) ++at_;
    end = at_;
    return begin != end;
  }

 private:
  static bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

  const char* at_;
  const char* end_;
};

/** A number of a corner, counted from 1, or back from the last if negative. */
std::int64_t indexOf(const char* begin, const char* end, std::size_t count) {
  std::int64_t index = 0;
  const auto [stop, code] = std::from_chars(begin, end, index);
  if (code != std::errc() || stop != end || index == 0) return kNone;
  const std::int64_t from_zero = index > 0 ? index - 1 : static_cast<std::int64_t>(count) + index;
  return from_zero >= 0 && from_zero < static_cast<std::int64_t>(count) ? from_zero : kNone;
}

class ObjReader {
 public:
  explicit ObjReader(const std::vector<unsigned char>& bytes)
      : scanner_(bytes.data(), bytes.size()) {}

  Result<PointFile> read() {
    std::string line, more;
    for (number_ = 1; scanner_.nextLine(line); ++number_) {
      while (!line.empty() && line.back() == '\\' && scanner_.nextLine(more)) {
        line.back() = ' ';
        line += more;
        ++number_;
      }
      if (Error error = takeLine(line)) return error;
    }
    if (mesh_.positions.empty())
      return badInput("it has no lines 'v x y z'; name an OBJ file with vertices");
    bringColors();
    spreadNormals();
    Result<PointFile> file = toPointFile(mesh_, "OBJ");
    if (file) file->left_out.assign(left_out_.begin(), left_out_.end());
    return file;
  }

 private:
  Error bad(const std::string& what) const {
    return badInput("line " + std::to_string(number_) + " of the OBJ file " + what + "; mend it");
  }

  Error takeLine(const std::string& line) {
    Words words(line.data(), line.data() + line.size());
    const char *begin = nullptr, *end = nullptr;
    if (!words.next(begin, end) || *begin == '#') return {};
    const std::string key(begin, end);
    if (key == "v") return takeVertex(words);
    if (key == "vn") return takeNormal(words);
    if (key == "f") return takeFace(words);
    if (key == "vt") left_out_.insert("texture coordinates");
    if (key == "l" || key == "p" || key == "curv" || key == "surf")
      left_out_.insert("'" + key + "'");
    if (key == "usemtl" || key == "mtllib") left_out_.insert("the material");
    return {};
  }

  /** Reads up to most numbers. \return how many there are, or -1 where a word is none. */
  static int numbers(Words& words, int most, double* values, bool& in_float) {
    const char *begin = nullptr, *end = nullptr;
    int count = 0;
    while (count < most && words.next(begin, end)) {
      if (!parseDecimal(begin, end, values[count++], in_float)) return -1;
    }
    return count;
  }

  Error takeVertex(Words& words) {
    double v[7];
    const char *begin = nullptr, *end = nullptr;
    bool ignored = false;
    if (numbers(words, 3, v, mesh_.in_float) != 3) return bad("has no three coordinates");
    const int more = numbers(words, 4, v + 3, ignored);
    if (more < 0 || words.next(begin, end)) return bad("has something behind its coordinates");
    mesh_.positions.push_back({v[0], v[1], v[2]});
    // x y z r g b, or x y z w r g b; a fourth number alone is a weight.
    if (more < 3) return {};
    const double* color = v + more;
    colors_.push_back({color[0], color[1], color[2]});
    return {};
  }

  /** Colours are fractions or, where one is larger than 1, numbers up to 255. */
  void bringColors() {
    if (colors_.size() != mesh_.positions.size()) return;
    double most = 0;
    for (const auto& color : colors_) most = std::max({most, color[0], color[1], color[2]});
    const double white = most > 1 ? 255 : 1;
    for (const auto& color : colors_) {
      std::array<std::uint8_t, 3> bytes{};
      for (std::size_t k = 0; k < 3; ++k) {
        const double share = std::min(color[k] / white, 1.0);
        bytes[k] =
            share > 0 ? static_cast<std::uint8_t>(std::lround(255 * share)) : std::uint8_t{0};
      }
      mesh_.colors.push_back(bytes);
    }
  }

  Error takeNormal(Words& words) {
    double v[3];
    bool ignored = false;
    if (numbers(words, 3, v, ignored) != 3) return bad("has no three components");
    normals_.push_back(
        {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])});
    return {};
  }

  /** A corner: vertex, vertex/texture, vertex//normal or vertex/texture/normal. */
  Error takeCorner(const char* begin, const char* end) {
    const char* slash = std::find(begin, end, '/');
    const std::int64_t vertex = indexOf(begin, slash, mesh_.positions.size());
    if (vertex == kNone) return bad("names a vertex that is not there");
    mesh_.face_vertices.push_back(static_cast<std::uint32_t>(vertex));
    const char* second = slash == end ? end : std::find(slash + 1, end, '/');
    if (second == end || second + 1 == end) return {};
    const std::int64_t normal = indexOf(second + 1, end, normals_.size());
    if (normal == kNone) return bad("names a normal that is not there");
    uses_.push_back({static_cast<std::uint32_t>(vertex), static_cast<std::uint32_t>(normal)});
    return {};
  }

  Error takeFace(Words& words) {
    const char *begin = nullptr, *end = nullptr;
    while (words.next(begin, end)) {
      if (Error error = takeCorner(begin, end)) return error;
    }
    mesh_.endFace();
    return {};
  }

  /** Normals of vertices: those that faces give them, or one a vertex where no face names any. */
  void spreadNormals() {
    if (uses_.empty()) {
      if (normals_.size() == mesh_.positions.size()) mesh_.normals = normals_;
      return;
    }
    std::vector<std::array<float, 3>> sums(mesh_.positions.size());
    for (const auto& [vertex, normal] : uses_) {
      for (std::size_t a = 0; a < 3; ++a) sums[vertex][a] += normals_[normal][a];
    }
    for (auto& n : sums) {
      const float length = std::hypot(n[0], n[1], n[2]);
      for (float& component : n) component = length > 0.0f ? component / length : 0.0f;
    }
    mesh_.normals = std::move(sums);
  }

  TextScanner scanner_;
  std::size_t number_ = 1;
  MeshPoints mesh_;
  std::vector<std::array<float, 3>> normals_;
  std::vector<std::array<double, 3>> colors_;                  ///< as the file has them
  std::vector<std::pair<std::uint32_t, std::uint32_t>> uses_;  ///< vertex and normal of corners
  std::set<std::string> left_out_;
};

}  // namespace

Result<PointFile> parseObj(const std::vector<unsigned char>& bytes) {
  return ObjReader(bytes).read();
}

}  // namespace pcl_slim

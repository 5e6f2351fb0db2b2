// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "io/point_formats.h"
#include "io/text/text.h"
#include "pcl_slim/core/random.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

namespace {

/** Vertices and faces as the readers of mesh formats collect them. */
struct MeshPoints {
  std::vector<std::array<double, 3>> positions;
  std::vector<std::array<float, 3>> normals;             ///< one a vertex, or none
  std::vector<std::array<std::uint8_t, 3>> colors;       ///< red green blue, one a vertex, or none
  std::vector<std::uint32_t> face_begin, face_vertices;  ///< as PointFile has them
  bool in_float = true;                                  ///< floats represent every coordinate

  void endFace();
};

Error checkMesh(const MeshPoints& mesh, const std::string& format) {
  const std::size_t n = mesh.positions.size();
  if (n > 0xfffffffeu || mesh.face_vertices.size() > 0xffffffffu)
    return badInput("the " + format + " file has more than 2^32 - 2 vertices or corners; split it");
  for (const std::uint32_t vertex : mesh.face_vertices) {
    if (vertex >= n) {
      return badInput("a face of the " + format + " file names vertex " + std::to_string(vertex) +
                      " of " + std::to_string(n) + ", counted from 0; write it again");
    }
  }
  return {};
}

void layOut(const MeshPoints& mesh, PointTable& cloud) {
  for (const char* axis : {"x", "y", "z"})
    addField(cloud, axis, mesh.in_float ? kFloat32 : kFloat64);
  if (!mesh.normals.empty()) {
    for (const char* axis : {"normal_x", "normal_y", "normal_z"}) addField(cloud, axis, kFloat32);
  }
  if (!mesh.colors.empty()) addField(cloud, "rgb", kFloat32);
  cloud.resize(mesh.positions.size());
}

void MeshPoints::endFace() {
  if (face_begin.empty()) face_begin.push_back(0);
  face_begin.push_back(static_cast<std::uint32_t>(face_vertices.size()));
}

/** The file: x y z, normal_x normal_y normal_z, rgb. \return an error for a face that names a
 * vertex that is not there. \param[in] format as errors call it: "OBJ". */
Result<PointFile> toPointFile(const MeshPoints& mesh, const char* format) {
  if (Error error = checkMesh(mesh, format)) return error;
  PointFile file;
  layOut(mesh, file.cloud);
  std::uint8_t* at = file.cloud.data.data();
  const auto put = [&at](const auto& value) {
    std::memcpy(at, &value, sizeof(value));
    at += sizeof(value);
  };
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    for (const double coordinate : mesh.positions[i]) {
      if (mesh.in_float)
        put(static_cast<float>(coordinate));
      else
        put(coordinate);
    }
    if (!mesh.normals.empty()) put(mesh.normals[i]);
    if (mesh.colors.empty()) continue;
    const auto& c = mesh.colors[i];
    put(std::array<std::uint8_t, 4>{c[2], c[1], c[0], 0});
  }
  file.face_begin = mesh.face_begin;
  file.face_vertices = mesh.face_vertices;
  return file;
}

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

namespace {

constexpr std::size_t kHeadBytes = 84, kFacetBytes = 50;

struct PlaceHash {
  std::size_t operator()(const std::array<double, 3>& p) const {
    return static_cast<std::size_t>(placeHash(p));
  }
};

/** Joins corners at one place. */
class VertexJoiner {
 public:
  explicit VertexJoiner(MeshPoints& mesh) : mesh_(mesh) {}

  void add(const std::array<double, 3>& p) {
    const auto [entry, is_new] =
        index_.try_emplace(p, static_cast<std::uint32_t>(mesh_.positions.size()));
    if (is_new) mesh_.positions.push_back(p);
    mesh_.face_vertices.push_back(entry->second);
  }

 private:
  MeshPoints& mesh_;
  std::unordered_map<std::array<double, 3>, std::uint32_t, PlaceHash> index_;
};

Result<PointFile> parseBinary(const std::vector<unsigned char>& bytes, std::size_t facets) {
  MeshPoints mesh;
  VertexJoiner vertices(mesh);
  bool has_attributes = false;
  for (std::size_t i = 0; i < facets; ++i) {
    const unsigned char* facet = bytes.data() + kHeadBytes + i * kFacetBytes;
    float corners[3][3];
    std::memcpy(corners, facet + 12, sizeof(corners));
    for (const auto& c : corners) vertices.add({c[0], c[1], c[2]});
    mesh.endFace();
    has_attributes = has_attributes || facet[48] != 0 || facet[49] != 0;
  }
  Result<PointFile> file = toPointFile(mesh, "STL");
  if (file && has_attributes) file->left_out.push_back("the attributes of facets");
  return file;
}

Result<PointFile> parseAscii(const std::vector<unsigned char>& bytes) {
  MeshPoints mesh;
  VertexJoiner vertices(mesh);
  TextScanner scanner(bytes.data(), bytes.size());
  const char *begin = nullptr, *end = nullptr;
  std::string word;
  std::size_t corners = 0;
  while (scanner.nextWord(begin, end)) {
    word.assign(begin, end);
    if (word == "endloop") {
      if (corners != 3) {
        return badInput("facet " + std::to_string(mesh.face_begin.size()) +
                        " of the STL file has " + std::to_string(corners) +
                        " vertices, not 3; write it again");
      }
      mesh.endFace();
      corners = 0;
    }
    if (word != "vertex") continue;
    std::array<double, 3> p{};
    for (double& coordinate : p) {
      if (!scanner.nextWord(begin, end) || !parseDecimal(begin, end, coordinate, mesh.in_float))
        return badInput("a vertex of the STL file has no three coordinates; write it again");
    }
    vertices.add(p);
    ++corners;
  }
  if (corners != 0 || word.rfind("endsolid", 0) != 0) {
    // The last word may be the solid's name.
    const std::string text(bytes.begin(), bytes.end());
    if (corners != 0 || text.rfind("endsolid") == std::string::npos)
      return badInput("the STL file is truncated: it has no 'endsolid'; copy it again");
  }
  return toPointFile(mesh, "STL");
}

}  // namespace

Result<PointFile> parseStl(const std::vector<unsigned char>& bytes) {
  std::uint32_t facets = 0;
  if (bytes.size() >= kHeadBytes) std::memcpy(&facets, bytes.data() + 80, sizeof(facets));
  const std::size_t there =
      bytes.size() >= kHeadBytes ? (bytes.size() - kHeadBytes) / kFacetBytes : 0;
  // Binary files may start with "solid", too; only those have the size that follows from their
  // count.
  if (bytes.size() >= kHeadBytes &&
      bytes.size() == kHeadBytes + facets * std::uint64_t{kFacetBytes})
    return parseBinary(bytes, facets);
  if (bytes.size() >= 5 && std::memcmp(bytes.data(), "solid", 5) == 0) return parseAscii(bytes);
  if (bytes.size() < kHeadBytes)
    return badInput("not an STL file: it neither starts with 'solid' nor has a header of 84 bytes");
  if (facets > there) {
    return badInput("the STL file is truncated: " + std::to_string(there) + " of " +
                    std::to_string(facets) + " facets; copy it again");
  }
  return parseBinary(bytes, facets);
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <unordered_map>
#include <vector>

#include "io/mesh_points.h"
#include "io/point_formats.h"
#include "io/text/text.h"
#include "pcl_slim/core/random.h"

namespace pcl_slim {

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

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/mesh_files.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <locale>
#include <sstream>
#include <string>
#include <vector>

#include "io/point_formats.h"
#include "io/vtp/vtp.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/srgb.h"
#include "pcl_slim/filters/io/point_file.h"
#include "pcl_slim/mesh/triangle_mesh.h"

namespace pcl_slim {

namespace {

constexpr double kFloatStep = 0x1p-24;  ///< largest rounding of a float over its size
constexpr double kShareOfEdge = 1e-3;

}  // namespace

double floatErrorOf(const TriangleMesh& mesh) {
  double farthest = 0, edges = 0;
  for (const Vector3& p : mesh.vertices) {
    for (const double x : p) farthest = std::max(farthest, std::abs(x));
  }
  for (const auto& t : mesh.triangles) {
    edges += length(subtract(mesh.vertices[t[0]], mesh.vertices[t[1]]));
  }
  return edges > 0 ? farthest * kFloatStep * static_cast<double>(mesh.triangles.size()) / edges : 0;
}

namespace {

/** Whether float keeps vertices where they are. */
bool floatsSuffice(const TriangleMesh& mesh) {
  return floatErrorOf(mesh) <= kShareOfEdge;
}

template <typename T>
void put(T value, std::uint8_t*& at) {
  std::memcpy(at, &value, sizeof(value));
  at += sizeof(value);
}

void addFields(const TriangleMesh& mesh, const MeshColumns& columns, PointTable& cloud) {
  const auto place = columns.narrow ? kFloat32 : kFloat64;
  for (const char* name : {"x", "y", "z"}) addField(cloud, name, place);
  for (const char* name : {"normal_x", "normal_y", "normal_z"}) {
    addField(cloud, name, kFloat32);
  }
  for (const char* name : {"k1", "k2"}) {
    if (columns.curvature) addField(cloud, name, kFloat32);
  }
  if (!mesh.sigma.empty()) addField(cloud, "sigma_position", kFloat32);
  if (!mesh.colors.empty()) addField(cloud, "rgb", kFloat32);
}

}  // namespace

PointFile toPointFile(const TriangleMesh& mesh, const MeshColumns& columns) {
  PointFile file;
  PointTable& cloud = file.cloud;
  addFields(mesh, columns, cloud);
  cloud.resize(mesh.vertices.size());
  std::uint8_t* at = cloud.data.data();
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (const double x : mesh.vertices[v]) {
      if (columns.narrow)
        put(finiteFloat(x), at);
      else
        put(x, at);
    }
    for (const float n : mesh.normals[v]) put(n, at);
    if (columns.curvature) {
      put(mesh.k1[v], at);
      put(mesh.k2[v], at);
    }
    if (!mesh.sigma.empty()) put(mesh.sigma[v], at);
    if (mesh.colors.empty()) continue;
    const auto& c = mesh.colors[v];
    put(static_cast<std::uint32_t>(c[0] << 16 | c[1] << 8 | c[2]), at);
  }
  file.face_begin.reserve(mesh.triangles.size() + 1);
  file.face_begin.push_back(0);
  for (const auto& t : mesh.triangles) {
    file.face_vertices.insert(file.face_vertices.end(), t.begin(), t.end());
    file.face_begin.push_back(static_cast<std::uint32_t>(file.face_vertices.size()));
  }
  return file;
}

namespace {

// Wavefront .obj and binary .stl.

std::string formatObj(const TriangleMesh& mesh) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  // Nine digits represent a float exactly, seventeen a double.
  text.precision(floatsSuffice(mesh) ? 9 : 17);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vector3& p = mesh.vertices[v];
    text << "v " << p[0] << ' ' << p[1] << ' ' << p[2];
    if (!mesh.colors.empty()) {
      for (const std::uint8_t c : mesh.colors[v]) text << ' ' << std::round(c / 0.255) / 1000;
    }
    text << '\n';
  }
  text.precision(6);
  for (const auto& n : mesh.normals) text << "vn " << n[0] << ' ' << n[1] << ' ' << n[2] << '\n';
  for (const auto& t : mesh.triangles) {
    text << 'f';
    for (const std::uint32_t v : t) text << ' ' << v + 1 << "//" << v + 1;
    text << '\n';
  }
  return text.str();
}

std::vector<unsigned char> formatStl(const TriangleMesh& mesh) {
  constexpr std::size_t kHeader = 80, kFacet = 50;
  std::vector<unsigned char> bytes(kHeader + 4 + kFacet * mesh.triangles.size(), 0);
  std::memcpy(bytes.data(), "pcl_slim", 8);
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  std::memcpy(bytes.data() + kHeader, &count, 4);
  unsigned char* at = bytes.data() + kHeader + 4;
  for (const auto& t : mesh.triangles) {
    const Vector3& p = mesh.vertices[t[0]];
    const Vector3 normal =
        normalized(cross(subtract(mesh.vertices[t[1]], p), subtract(mesh.vertices[t[2]], p)));
    float values[12];
    for (std::size_t a = 0; a < 3; ++a) {
      values[a] = static_cast<float>(normal[a]);
      for (std::size_t k = 0; k < 3; ++k) {
        values[3 + 3 * k + a] = static_cast<float>(mesh.vertices[t[k]][a]);
      }
    }
    std::memcpy(at, values, sizeof(values));
    at += kFacet;
  }
  return bytes;
}

// glTF 2.0, binary form: a chunk of JSON, then one of numbers (Khronos, glTF 2.0 Specification,
// 4.4).

enum ComponentType { kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126 };
enum Target { kArrayBuffer = 34962, kElementArrayBuffer = 34963 };

std::string numbersOf(const float (&values)[3]) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(9);
  text << '[' << values[0] << ',' << values[1] << ',' << values[2] << ']';
  return text.str();
}

/** Views, accessors and the bytes they are of. */
class GlbBuffer {
 public:
  /** Appends numbers. \param[in] rest more of the accessor's JSON, from a comma on. */
  template <typename T>
  void add(const std::vector<T>& numbers, ComponentType type, const char* shape, std::size_t count,
           Target target, const std::string& rest) {
    const std::size_t size = numbers.size() * sizeof(T), begin = bytes.size();
    bytes.resize(begin + size);
    if (size > 0) std::memcpy(bytes.data() + begin, numbers.data(), size);
    const std::string comma = views.empty() ? "" : ",";
    views += comma + "{\"buffer\":0,\"byteOffset\":" + std::to_string(begin) +
             ",\"byteLength\":" + std::to_string(size) + ",\"target\":" + std::to_string(target) +
             "}";
    accessors += comma + "{\"bufferView\":" + std::to_string(number) +
                 ",\"componentType\":" + std::to_string(type) +
                 ",\"count\":" + std::to_string(count) + ",\"type\":\"" + shape + "\"" + rest + "}";
    ++number;
  }

  std::vector<unsigned char> bytes;
  std::string views, accessors;
  std::size_t number = 0;
};

/** The middle of the box about a mesh, in floats. */
std::array<float, 3> middleOf(const TriangleMesh& mesh) {
  std::array<float, 3> middle{};
  for (std::size_t a = 0; a < 3; ++a) {
    double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
    for (const Vector3& p : mesh.vertices) {
      low = std::min(low, p[a]);
      high = std::max(high, p[a]);
    }
    if (low <= high) middle[a] = static_cast<float>(0.5 * (low + high));
  }
  return middle;
}

void addPositions(const TriangleMesh& mesh, const std::array<float, 3>& middle, GlbBuffer& buffer) {
  std::vector<float> values;
  values.reserve(3 * mesh.vertices.size());
  constexpr float kMost = std::numeric_limits<float>::max();
  float low[3] = {kMost, kMost, kMost}, high[3] = {-kMost, -kMost, -kMost};
  for (const Vector3& p : mesh.vertices) {
    for (std::size_t a = 0; a < 3; ++a) {
      const auto x = static_cast<float>(p[a] - static_cast<double>(middle[a]));
      low[a] = std::min(low[a], x);
      high[a] = std::max(high[a], x);
      values.push_back(x);
    }
  }
  buffer.add(values, kFloat, "VEC3", mesh.vertices.size(), kArrayBuffer,
             ",\"min\":" + numbersOf(low) + ",\"max\":" + numbersOf(high));
}

/** glTF's vertex colours are linear: sixteen bits keep the darks of eight bits of sRGB apart. */
std::uint16_t linearOf(std::uint8_t c) {
  return static_cast<std::uint16_t>(std::lround(linearFromSrgb(c / 255.0) * 65535));
}

void addColors(const TriangleMesh& mesh, GlbBuffer& buffer) {
  std::vector<std::uint16_t> values;
  values.reserve(4 * mesh.colors.size());
  for (const auto& color : mesh.colors) {
    for (const std::uint8_t c : color) values.push_back(linearOf(c));
    values.push_back(65535);
  }
  buffer.add(values, kUnsignedShort, "VEC4", mesh.colors.size(), kArrayBuffer,
             ",\"normalized\":true");
}

std::string headerOf(const GlbBuffer& buffer, const std::array<float, 3>& middle, bool colors) {
  const float translation[3] = {middle[0], middle[1], middle[2]};
  return "{\"asset\":{\"version\":\"2.0\",\"generator\":\"pcl_slim\"},\"scene\":0,"
         "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"translation\":" +
         numbersOf(translation) +
         "}],\"materials\":[{\"doubleSided\":true,\"pbrMetallicRoughness\":{\"baseColorFactor\":" +
         (colors ? "[1,1,1,1]" : "[0.6,0.6,0.6,1]") +
         ",\"metallicFactor\":0,\"roughnessFactor\":0.6}}],"
         "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1" +
         (colors ? ",\"COLOR_0\":3" : "") + "},\"indices\":2,\"material\":0}]}],\"buffers\":[{" +
         "\"byteLength\":" + std::to_string(buffer.bytes.size()) + "}],\"bufferViews\":[" +
         buffer.views + "],\"accessors\":[" + buffer.accessors + "]}";
}

void putWord(std::uint32_t word, std::vector<unsigned char>& bytes) {
  for (int shift = 0; shift < 32; shift += 8) {
    bytes.push_back(static_cast<unsigned char>(word >> shift & 0xffu));
  }
}

/** An error for a mesh too large for the 32-bit lengths of the format. */
Result<std::vector<unsigned char>> formatGlb(const TriangleMesh& mesh) {
  const std::array<float, 3> middle = middleOf(mesh);
  GlbBuffer buffer;
  addPositions(mesh, middle, buffer);
  std::vector<float> normals;
  for (const auto& n : mesh.normals) normals.insert(normals.end(), n.begin(), n.end());
  buffer.add(normals, kFloat, "VEC3", mesh.normals.size(), kArrayBuffer, "");
  std::vector<std::uint32_t> corners;
  for (const auto& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  buffer.add(corners, kUnsignedInt, "SCALAR", corners.size(), kElementArrayBuffer, "");
  if (!mesh.colors.empty()) addColors(mesh, buffer);
  std::string header = headerOf(buffer, middle, !mesh.colors.empty());
  while (header.size() % 4 != 0) header += ' ';
  const std::size_t total = 12 + 8 + header.size() + 8 + buffer.bytes.size();
  if (total > std::numeric_limits<std::uint32_t>::max()) {
    return Error{ErrorCode::kIo,
                 "the mesh is larger than the 4 GB of a .glb file; write a .ply file instead"};
  }
  std::vector<unsigned char> bytes;
  bytes.reserve(total);
  for (const std::uint32_t word : {0x46546c67u, 2u, static_cast<std::uint32_t>(total),
                                   static_cast<std::uint32_t>(header.size()), 0x4e4f534au}) {
    putWord(word, bytes);
  }
  bytes.insert(bytes.end(), header.begin(), header.end());
  putWord(static_cast<std::uint32_t>(buffer.bytes.size()), bytes);
  putWord(0x004e4942u, bytes);
  bytes.insert(bytes.end(), buffer.bytes.begin(), buffer.bytes.end());
  return bytes;
}

}  // namespace

Error checkMeshExtension(const std::string& path) {
  const std::string extension = lowerExtension(path);
  if (extension == ".vtp") return checkVtp(path);
  for (const char* known : {".ply", ".obj", ".stl", ".glb"}) {
    if (extension == known) return {};
  }
  return {ErrorCode::kBadArgument, "'" + path + "' must be named .ply, .obj, .stl, .glb or .vtp"};
}

Error saveMesh(const std::string& path, const TriangleMesh& mesh) {
  if (Error error = checkMeshExtension(path)) return error;
  if (Error error = mesh.validate()) return error;
  const std::string extension = lowerExtension(path);
  if (extension == ".ply")
    return savePointFile(path, toPointFile(mesh, {floatsSuffice(mesh), true}));
  if (extension == ".vtp") return saveMeshVtp(path, mesh, floatsSuffice(mesh));
  if (extension == ".obj") {
    const std::string text = formatObj(mesh);
    return writeFile(path, text.data(), text.size());
  }
  if (extension == ".stl") {
    const std::vector<unsigned char> bytes = formatStl(mesh);
    return writeFile(path, bytes.data(), bytes.size());
  }
  const Result<std::vector<unsigned char>> bytes = formatGlb(mesh);
  if (!bytes) return bytes.error();
  return writeFile(path, bytes->data(), bytes->size());
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Wavefront .obj and binary .stl.
#include <cmath>
#include <cstring>
#include <locale>
#include <sstream>

#include "io/triangles/mesh_formats.h"

namespace pcl_slim {

std::string
formatObj(const TriangleMesh& mesh)
{
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

std::vector<unsigned char>
formatStl(const TriangleMesh& mesh)
{
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

}  // namespace pcl_slim

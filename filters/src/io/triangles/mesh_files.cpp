// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/mesh_files.h"

#include <algorithm>
#include <cmath>

#include "io/triangles/mesh_formats.h"
#include "io/vtp/vtp_file.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

namespace {

constexpr double kFloatStep = 0x1p-24;  ///< largest rounding of a float over its size
constexpr double kShareOfEdge = 1e-3;

}  // namespace

double
floatErrorOf(const TriangleMesh& mesh)
{
  double farthest = 0, edges = 0;
  for (const Vector3& p : mesh.vertices) {
    for (const double x : p) farthest = std::max(farthest, std::abs(x));
  }
  for (const auto& t : mesh.triangles) {
    edges += length(subtract(mesh.vertices[t[0]], mesh.vertices[t[1]]));
  }
  return edges > 0 ? farthest * kFloatStep * static_cast<double>(mesh.triangles.size()) / edges : 0;
}

bool
floatsSuffice(const TriangleMesh& mesh)
{
  return floatErrorOf(mesh) <= kShareOfEdge;
}

Error
checkMeshExtension(const std::string& path)
{
  const std::string extension = lowerExtension(path);
  if (extension == ".vtp") return checkVtp(path);
  for (const char* known : {".ply", ".obj", ".stl", ".glb"}) {
    if (extension == known) return {};
  }
  return {ErrorCode::kBadArgument, "'" + path + "' must be named .ply, .obj, .stl, .glb or .vtp"};
}

Error
saveMesh(const std::string& path, const TriangleMesh& mesh)
{
  if (Error error = checkMeshExtension(path)) return error;
  const std::string extension = lowerExtension(path);
  if (extension == ".ply")
    return savePointFile(path, toPointFile(mesh, {floatsSuffice(mesh), true}));
  if (extension == ".vtp") return saveMeshVtp(path, mesh);
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

// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>

#include "io/scalar_type.h"
#include "io/triangles/mesh_formats.h"
#include "pcl_slim/filters/io/mesh_conversion.h"

namespace pcl_slim {

namespace {

template <typename T>
void
put(T value, std::uint8_t*& at)
{
  std::memcpy(at, &value, sizeof(value));
  at += sizeof(value);
}

void
addFields(const TriangleMesh& mesh, const MeshColumns& columns, pcl::PCLPointCloud2& cloud)
{
  const auto place = columns.narrow ? kFloat32 : kFloat64;
  for (const char* name : {"x", "y", "z"}) addField(cloud, name, place);
  for (const char* name : {"normal_x", "normal_y", "normal_z"}) {
    addField(cloud, name, kFloat32);
  }
  for (const char* name : {"k1", "k2"}) {
    if (columns.curvature) addField(cloud, name, kFloat32);
  }
  if (!mesh.colors.empty()) addField(cloud, "rgb", kFloat32);
}

}  // namespace

PointFile
toPointFile(const TriangleMesh& mesh, const MeshColumns& columns)
{
  PointFile file;
  pcl::PCLPointCloud2& cloud = file.cloud;
  addFields(mesh, columns, cloud);
  cloud.width = static_cast<pcl::uindex_t>(mesh.vertices.size());
  cloud.height = 1;
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.data.resize(static_cast<std::size_t>(cloud.point_step) * cloud.width);
  std::uint8_t* at = cloud.data.data();
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (const double x : mesh.vertices[v]) {
      if (columns.narrow)
        put(static_cast<float>(x), at);
      else
        put(x, at);
    }
    for (const float n : mesh.normals[v]) put(n, at);
    if (columns.curvature) {
      put(mesh.k1[v], at);
      put(mesh.k2[v], at);
    }
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

pcl::PolygonMesh
toPolygonMesh(const TriangleMesh& mesh, bool curvature)
{
  pcl::PolygonMesh made;
  made.cloud = toPointFile(mesh, {true, curvature}).cloud;
  made.cloud.is_dense = 1;
  made.polygons = polygonsOf(mesh);
  return made;
}

std::vector<pcl::Vertices>
polygonsOf(const TriangleMesh& mesh)
{
  std::vector<pcl::Vertices> polygons(mesh.triangles.size());
  for (std::size_t t = 0; t < polygons.size(); ++t) {
    polygons[t].vertices.assign(mesh.triangles[t].begin(), mesh.triangles[t].end());
  }
  return polygons;
}

}  // namespace pcl_slim

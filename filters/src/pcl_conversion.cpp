// SPDX-License-Identifier: BSD-3-Clause
// Surfaces, splats, meshes and crest lines as PCL's clouds.
#include "pcl_slim/filters/io/pcl_conversion.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include "pcl_slim/filters/io/mesh_conversion.h"
#include "pcl_slim/filters/io/mesh_files.h"
#include "pcl_slim/filters/io/splat_conversion.h"
#include "pcl_slim/filters/io/surface_conversion.h"
#include "pcl_slim/filters/point_crest.h"

namespace pcl_slim {

SurfaceMetadata toPCL(const SLIMSurface& surface, pcl::PointCloud<PointSLIM>& cloud) {
  PointTable table;
  const SurfaceMetadata metadata = toPointTable(surface, table);
  cloud = pcl::PointCloud<PointSLIM>();
  cloud.resize(surface.size());
  const std::uint8_t* at = nullptr;
  const auto take = [&at](auto* values, std::size_t count) {
    std::memcpy(values, at, count * sizeof(*values));
    at += count * sizeof(*values);
  };
  for (std::size_t i = 0; i < surface.size(); ++i) {
    at = table.data.data() + i * table.point_step;
    PointSLIM& p = cloud[i];
    take(p.data, 3);
    take(p.data_n, 3);
    take(&p.radius, 1);
    take(p.c, static_cast<std::size_t>(surface.stride()));
    for (float* value : {&p.degree, &p.level, &p.leaf, &p.error, &p.confidence}) take(value, 1);
    if (!surface.hasTrimMaps()) continue;
    take(&p.trim_low, 1);
    take(&p.trim_high, 1);
  }
  cloud.is_dense = true;
  return metadata;
}

SurfaceMetadata toPCL(const SLIMSurface& surface, pcl::PCLPointCloud2& cloud) {
  PointTable table;
  const SurfaceMetadata metadata = toPointTable(surface, table);
  cloud = toPCL(std::move(table));
  cloud.is_dense = 1;
  return metadata;
}

Result<SLIMSurface> fromPCL(const pcl::PointCloud<PointSLIM>& cloud,
                            const SurfaceMetadata* metadata) {
  return surfaceFrom(toPointFile(cloud).cloud, metadata);
}

Result<SLIMSurface> fromPCL(const pcl::PCLPointCloud2& cloud, const SurfaceMetadata* metadata) {
  return surfaceFrom(toPointTable(cloud), metadata);
}

void toPCL(const SplatSet& splats, const std::array<double, 3>& shift,
           pcl::PointCloud<pcl::PointSurfel>& cloud) {
  toPCL(toPointFile(splats, shift), cloud);
  cloud.is_dense = true;
}

pcl::PolygonMesh toPolygonMesh(const TriangleMesh& mesh, bool curvature) {
  pcl::PolygonMesh made;
  made.cloud = toPCL(toPointFile(mesh, {true, curvature}).cloud);
  made.cloud.is_dense = 1;
  made.polygons = polygonsOf(mesh);
  return made;
}

std::vector<pcl::Vertices> polygonsOf(const TriangleMesh& mesh) {
  std::vector<pcl::Vertices> polygons(mesh.triangles.size());
  for (std::size_t t = 0; t < polygons.size(); ++t) {
    polygons[t].vertices.assign(mesh.triangles[t].begin(), mesh.triangles[t].end());
  }
  return polygons;
}

void toPointCloud(const CrestLines& lines, pcl::PointCloud<PointCrest>& cloud) {
  cloud = pcl::PointCloud<PointCrest>();
  cloud.reserve(lines.numVertices());
  for (std::size_t line = 0; line < lines.numLines(); ++line) {
    for (std::uint32_t v = lines.line_begin[line]; v < lines.line_begin[line + 1]; ++v) {
      PointCrest p;
      for (std::size_t a = 0; a < 3; ++a) {
        p.data[a] = static_cast<float>(lines.position[v][a]);
        p.data_n[a] = lines.normal[v][a];
      }
      p.tangent_x = lines.tangent[v][0];
      p.tangent_y = lines.tangent[v][1];
      p.tangent_z = lines.tangent[v][2];
      p.k1 = lines.k1[v];
      p.k2 = lines.k2[v];
      p.significance = lines.significance[v];
      p.strength = static_cast<float>(lines.strength[line]);
      p.type = static_cast<std::uint32_t>(lines.type[line]);
      p.line = static_cast<std::uint32_t>(line);
      cloud.push_back(p);
    }
  }
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "scan/mesh_input.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

TriangleMesh triangleMeshOf(const CloudFile& cloud) {
  const CloudView view = cloud.view();
  const ColorView colors = colorsOf(cloud);
  TriangleMesh mesh;
  for (std::size_t i = 0; i < view.size; ++i) {
    mesh.vertices.push_back(view.position(i));
    const std::array<float, 3> none{0.0f, 0.0f, 0.0f};
    const auto normal = view.normal ? view.givenNormal(i) : none;
    mesh.normals.push_back(isFinite(normal) ? normal : none);
    if (colors.bgr == nullptr) continue;
    const std::uint8_t* const bgr =
        static_cast<const std::uint8_t*>(colors.bgr) + i * colors.stride;
    mesh.colors.push_back({bgr[2], bgr[1], bgr[0]});
  }
  const PointTable& table = cloud.file.cloud;
  for (const auto& [name, column] : {std::pair{"k1", &mesh.k1}, std::pair{"k2", &mesh.k2},
                                     std::pair{"sigma_position", &mesh.sigma}}) {
    const int field = findField(table, name);
    for (std::size_t i = 0; field >= 0 && i < view.size; ++i)
      column->push_back(
          static_cast<float>(fieldValue(table, i, table.fields[static_cast<std::size_t>(field)])));
  }
  for (std::size_t f = 0; f < cloud.file.numFaces(); ++f) {
    const std::uint32_t begin = cloud.file.face_begin[f], end = cloud.file.face_begin[f + 1];
    for (std::uint32_t k = begin + 2; k < end; ++k)
      mesh.triangles.push_back({cloud.file.face_vertices[begin], cloud.file.face_vertices[k - 1],
                                cloud.file.face_vertices[k]});
  }
  return mesh;
}

Error checkTriangles(const TriangleMesh& mesh) {
  constexpr double kMost = 1e30;
  bool has_area = false;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const auto& t = mesh.triangles[f];
    for (const std::uint32_t v : t) {
      const Vector3& p = mesh.vertices[v];
      if (!isFinite(p) || std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}) > kMost)
        return {ErrorCode::kBadInput, "vertex " + std::to_string(v) +
                                          " of a face is not finite or beyond 1e30; remove its "
                                          "faces"};
    }
    const Vector3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    has_area = has_area || length(cross(subtract(b, a), subtract(c, a))) > 0.0;
  }
  if (has_area) return {};
  return {ErrorCode::kBadInput, "no face has an area; name a mesh that has"};
}

}  // namespace pcl_slim

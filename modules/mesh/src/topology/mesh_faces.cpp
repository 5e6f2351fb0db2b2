// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/mesh/mesh_faces.h"

#include <algorithm>
#include <string>

namespace pcl_slim {

void
MeshFaces::add(const std::uint32_t* first, std::size_t count)
{
  if (begin.empty()) begin.push_back(0);
  corners.insert(corners.end(), first, first + count);
  begin.push_back(static_cast<std::uint32_t>(corners.size()));
}

Error
MeshFaces::validate(std::size_t num_vertices) const
{
  for (std::size_t f = 0; f < size(); ++f) {
    if (begin[f + 1] < begin[f] || begin[f + 1] > corners.size()) {
      return {ErrorCode::kBadInput, "face " + std::to_string(f) +
                                        " has offsets that do not ascend; make the faces again"};
    }
    for (const std::uint32_t vertex : (*this)[f]) {
      if (vertex < num_vertices) continue;
      return {ErrorCode::kBadInput, "face " + std::to_string(f) + " names vertex " +
                                        std::to_string(vertex) + " of " +
                                        std::to_string(num_vertices) + "; make the faces again"};
    }
  }
  return {};
}

Vector3
areaVector(const std::vector<Vector3>& vertices, IndexRow corners)
{
  Vector3 area{};
  for (std::size_t k = 2; k < corners.size(); ++k) {
    const Vector3& o = vertices[corners[0]];
    const Vector3 part =
        cross(subtract(vertices[corners[k - 1]], o), subtract(vertices[corners[k]], o));
    area = along(area, 0.5, part);
  }
  return area;
}

Vector3
centroid(const std::vector<Vector3>& vertices, IndexRow corners)
{
  Vector3 sum{};
  for (const std::uint32_t v : corners) sum = along(sum, 1.0, vertices[v]);
  return corners.size() > 0 ? scaled(sum, 1.0 / static_cast<double>(corners.size())) : sum;
}

MeshTopology::MeshTopology(const MeshFaces& faces, std::size_t num_vertices)
{
  findFacesOfVertices(faces, num_vertices);
  findNeighbours(faces);
}

void
MeshTopology::findFacesOfVertices(const MeshFaces& faces, std::size_t num_vertices)
{
  vertex_begin_.assign(num_vertices + 1, 0);
  for (const std::uint32_t v : faces.corners) ++vertex_begin_[v + 1];
  for (std::size_t v = 0; v < num_vertices; ++v) vertex_begin_[v + 1] += vertex_begin_[v];
  std::vector<std::uint32_t> next(vertex_begin_.begin(), vertex_begin_.end() - 1);
  vertex_faces_.resize(faces.corners.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (const std::uint32_t v : faces[f]) vertex_faces_[next[v]++] = static_cast<std::uint32_t>(f);
  }
}

void
MeshTopology::findNeighbours(const MeshFaces& faces)
{
  edge_begin_.assign(1, 0);
  around_begin_.assign(1, 0);
  std::vector<std::uint32_t> near;
  const auto finish = [](std::vector<std::uint32_t>& begin, std::vector<std::uint32_t>& all) {
    const auto from = all.begin() + begin.back();
    std::sort(from, all.end());
    all.erase(std::unique(from, all.end()), all.end());
    begin.push_back(static_cast<std::uint32_t>(all.size()));
  };
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const IndexRow corners = faces[f];
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const IndexRow here = facesOf(corners[k]);
      const IndexRow next = facesOf(corners[(k + 1) % corners.size()]);
      for (const std::uint32_t g : here) {
        if (g == f) continue;
        around_faces_.push_back(g);
        if (std::binary_search(next.begin(), next.end(), g)) edge_faces_.push_back(g);
      }
    }
    finish(edge_begin_, edge_faces_);
    finish(around_begin_, around_faces_);
  }
}

}  // namespace pcl_slim

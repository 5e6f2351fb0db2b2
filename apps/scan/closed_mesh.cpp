// SPDX-License-Identifier: BSD-3-Clause
#include "scan/closed_mesh.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

namespace {

/** Whether each edge is run along once in either direction. */
bool
isClosed(const PointFile& mesh)
{
  std::vector<std::uint64_t> edges, opposite;
  for (std::size_t f = 0; f < mesh.numFaces(); ++f) {
    const std::uint32_t begin = mesh.face_begin[f], end = mesh.face_begin[f + 1];
    for (std::uint32_t k = begin; k < end; ++k) {
      const std::uint64_t from = mesh.face_vertices[k];
      const std::uint64_t to = mesh.face_vertices[k + 1 < end ? k + 1 : begin];
      edges.push_back(from << 32 | to);
      opposite.push_back(to << 32 | from);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::sort(opposite.begin(), opposite.end());
  return !edges.empty() && edges == opposite &&
         std::adjacent_find(edges.begin(), edges.end()) == edges.end();
}

/** Six times the volume that the faces enclose; below 0 where they face inwards. */
double
volumeOf(const std::function<Vector3(std::uint32_t)>& position, const PointFile& mesh)
{
  const Vector3 origin = position(mesh.face_vertices[0]);
  const auto corner = [&](std::uint32_t k) {
    return subtract(position(mesh.face_vertices[k]), origin);
  };
  double volume = 0.0;
  for (std::size_t f = 0; f < mesh.numFaces(); ++f) {
    const std::uint32_t begin = mesh.face_begin[f];
    for (std::uint32_t k = begin + 1; k + 1 < mesh.face_begin[f + 1]; ++k)
      volume += dot(corner(begin), cross(corner(k), corner(k + 1)));
  }
  return volume;
}

}  // namespace

bool
turnOutwards(const std::function<std::array<double, 3>(std::uint32_t)>& position, PointFile& mesh)
{
  if (!isClosed(mesh) || !(volumeOf(position, mesh) < 0.0)) return false;
  for (std::size_t f = 0; f < mesh.numFaces(); ++f) {
    const auto first = mesh.face_vertices.begin();
    std::reverse(first + mesh.face_begin[f], first + mesh.face_begin[f + 1]);
  }
  return true;
}

}  // namespace pcl_slim

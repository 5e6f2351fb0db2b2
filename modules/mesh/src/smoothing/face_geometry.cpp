// SPDX-License-Identifier: BSD-3-Clause
#include "smoothing/face_geometry.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kChunk = 1024;

}  // namespace

FaceGeometry
measureFaces(const std::vector<Vector3>& vertices, const MeshFaces& faces, int threads)
{
  FaceGeometry made;
  made.centroids.resize(faces.size());
  made.normals.resize(faces.size());
  made.areas.resize(faces.size());
  parallelFor(faces.size(), resolveThreads(threads), kChunk, [&](std::size_t f, int) {
    const Vector3 area = areaVector(vertices, faces[f]);
    made.centroids[f] = centroid(vertices, faces[f]);
    made.areas[f] = length(area);
    made.normals[f] = normalized(area);
  });
  return made;
}

std::vector<Vector3>
vertexNormals(const FaceGeometry& geometry, const std::vector<Vector3>& face_normals,
              const MeshTopology& topology, std::size_t num_vertices, int threads)
{
  std::vector<Vector3> made(num_vertices);
  parallelFor(num_vertices, resolveThreads(threads), kChunk, [&](std::size_t v, int) {
    Vector3 sum{};
    for (const std::uint32_t f : topology.facesOf(v)) {
      sum = along(sum, geometry.areas[f], face_normals[f]);
    }
    made[v] = normalized(sum);
  });
  return made;
}

double
meanEdgeLength(const std::vector<Vector3>& vertices, const MeshFaces& faces)
{
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const IndexRow corners = faces[f];
    for (std::size_t k = 0; k < corners.size(); ++k, ++count) {
      sum += length(subtract(vertices[corners[k]], vertices[corners[(k + 1) % corners.size()]]));
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

double
sharpShare(const std::vector<Vector3>& normals, const MeshTopology& topology)
{
  constexpr double kSharp = M_PI / 6;
  double all = 0, sharp = 0;
  for (std::size_t f = 0; f < normals.size(); ++f) {
    for (const std::uint32_t g : topology.acrossEdges(f)) {
      if (g < f) continue;
      const double angle = std::acos(std::clamp(dot(normals[f], normals[g]), -1.0, 1.0));
      all += angle;
      if (angle > kSharp) sharp += angle;
    }
  }
  return all > 0 ? sharp / all : 0;
}

}  // namespace pcl_slim::detail

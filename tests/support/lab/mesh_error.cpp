// SPDX-License-Identifier: BSD-3-Clause
#include "support/lab/mesh_error.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::measure {

namespace {

/** Places in a triangle, by the weights of its corners: corners, middles of edges, centroid; their
 * shares of the integral are those of the rule of degree 3. */
constexpr double kPlaces[7][4] = {{1, 0, 0, 0.05},
                                  {0, 1, 0, 0.05},
                                  {0, 0, 1, 0.05},
                                  {0.5, 0.5, 0, 2 / 15.0},
                                  {0.5, 0, 0.5, 2 / 15.0},
                                  {0, 0.5, 0.5, 2 / 15.0},
                                  {1 / 3.0, 1 / 3.0, 1 / 3.0, 0.45}};

double angleBetween(const Vector3& a, const Vector3& b) {
  return std::atan2(length(cross(a, b)), std::abs(dot(a, b))) * 180 / M_PI;
}

}  // namespace

MeshError measureMesh(Shape shape, const TriangleMesh& mesh) {
  MeshError error;
  double squares = 0, angles = 0;
  for (const auto& t : mesh.triangles) {
    const Vector3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Vector3 cross_product = cross(subtract(b, a), subtract(c, a));
    const double area = 0.5 * length(cross_product);
    error.area += area;
    for (const auto& place : kPlaces) {
      const Vector3 p = along(along(scaled(a, place[0]), place[1], b), place[2], c);
      const Truth truth = truthAt(shape, p);
      error.max = std::max(error.max, std::abs(truth.distance));
      squares += area * place[3] * truth.distance * truth.distance;
      if (&place != &kPlaces[6] || !(area > 0)) continue;
      const double angle = angleBetween(cross_product, truth.normal);
      angles += area * angle * angle;
    }
  }
  error.rms = std::sqrt(squares / std::max(error.area, 1e-300));
  error.normal = std::sqrt(angles / std::max(error.area, 1e-300));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Truth truth = truthAt(shape, mesh.vertices[v]);
    error.vertex_rms += truth.distance * truth.distance;
    const double angle =
        angleBetween({mesh.normals[v][0], mesh.normals[v][1], mesh.normals[v][2]}, truth.normal);
    error.vertex_normal += angle * angle;
  }
  const auto count = static_cast<double>(std::max<std::size_t>(mesh.vertices.size(), 1));
  error.vertex_rms = std::sqrt(error.vertex_rms / count);
  error.vertex_normal = std::sqrt(error.vertex_normal / count);
  return error;
}

}  // namespace pcl_slim::measure

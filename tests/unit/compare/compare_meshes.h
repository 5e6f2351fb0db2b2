// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "pcl_slim/compare/deviation.h"
#include "pcl_slim/mesh/triangle_mesh.h"
#include "support/meshes.h"

namespace pcl_slim_test {

/** A mesh's triangles without normals and curvatures, as a file of CAD has them. */
inline pcl_slim::TriangleMesh trianglesOf(const TestMesh& mesh) {
  pcl_slim::TriangleMesh made;
  made.vertices = mesh.vertices;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const pcl_slim::IndexRow row = mesh.faces[f];
    made.triangles.push_back({row[0], row[1], row[2]});
  }
  return made;
}

/** The same triangles, each with corners of its own, as STL files have them. */
inline pcl_slim::TriangleMesh soupOf(const pcl_slim::TriangleMesh& mesh) {
  pcl_slim::TriangleMesh made;
  for (const auto& triangle : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(made.vertices.size());
    for (const std::uint32_t v : triangle) made.vertices.push_back(mesh.vertices[v]);
    made.triangles.push_back({first, first + 1, first + 2});
  }
  return made;
}

/** Stretches and moves a mesh. */
inline pcl_slim::TriangleMesh placed(pcl_slim::TriangleMesh mesh, const pcl_slim::Vector3& size,
                                     const pcl_slim::Vector3& at) {
  for (auto& p : mesh.vertices) {
    for (std::size_t a = 0; a < 3; ++a) p[a] = size[a] * p[a] + at[a];
  }
  return mesh;
}

/** The box of half widths size about a place: cubeMesh(n) stretched. */
inline pcl_slim::TriangleMesh boxMesh(int n, const pcl_slim::Vector3& size,
                                      const pcl_slim::Vector3& at = {}) {
  return placed(trianglesOf(cubeMesh(n)), size, at);
}

/** Appends the triangles of another mesh. */
inline void append(const pcl_slim::TriangleMesh& more, pcl_slim::TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (auto triangle : more.triangles) {
    for (auto& v : triangle) v += first;
    mesh.triangles.push_back(triangle);
  }
}

/** The mesh as an exact reference. */
inline pcl_slim::DeviationReference referenceTo(const pcl_slim::TriangleMesh& mesh) {
  pcl_slim::Result<pcl_slim::DeviationReference> made =
      pcl_slim::DeviationReference::make(mesh, {}, 1);
  EXPECT_TRUE(made) << made.error().message;
  return std::move(*made);
}

/** A surface, which must outlive the reference. */
inline pcl_slim::DeviationReference referenceTo(const pcl_slim::SLIMSurface& surface) {
  pcl_slim::Result<pcl_slim::DeviationReference> made =
      pcl_slim::DeviationReference::make(surface, 1);
  EXPECT_TRUE(made) << made.error().message;
  return std::move(*made);
}

/** Signed distance from the box of half widths size about the origin; negative inside. */
inline double boxDistance(const pcl_slim::Vector3& size, const pcl_slim::Vector3& p) {
  double outside = 0, inside = -pcl_slim::Bounds::kInfinity;
  for (std::size_t a = 0; a < 3; ++a) {
    const double off = std::abs(p[a]) - size[a];
    outside += std::max(off, 0.0) * std::max(off, 0.0);
    inside = std::max(inside, off);
  }
  return outside > 0 ? std::sqrt(outside) : inside;
}

/** count places, evenly in the cube of this half width. */
inline std::vector<pcl_slim::Vector3> randomPlaces(std::size_t count, double half, unsigned seed) {
  std::mt19937_64 random(seed);
  std::vector<pcl_slim::Vector3> places(count);
  for (auto& p : places) {
    for (double& x : p) x = half * (2 * static_cast<double>(random() >> 11) * 0x1p-53 - 1);
  }
  return places;
}

}  // namespace pcl_slim_test

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/mesh/detail/mesh_topology.h"

#include <gtest/gtest.h>

#include "pcl_slim/mesh/triangle_mesh.h"
#include "support/meshes.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::detail;

TriangleMesh triangles(const std::vector<Triangle>& made, std::size_t vertices) {
  TriangleMesh mesh;
  mesh.vertices.resize(vertices);
  mesh.triangles = made;
  return mesh;
}

/** A tetrahedron's four triangles over vertices a b c d. */
void addTetrahedron(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d,
                    std::vector<Triangle>& made) {
  made.insert(made.end(), {{a, b, c}, {a, c, d}, {a, d, b}, {b, d, c}});
}

TEST(Census, CountsAClosedMesh) {
  const auto cube = pcl_slim_test::cubeMesh(4);
  TriangleMesh mesh = triangles({}, cube.vertices.size() + 2);
  for (std::size_t f = 0; f < cube.faces.size(); ++f) {
    mesh.triangles.push_back({cube.faces[f][0], cube.faces[f][1], cube.faces[f][2]});
  }
  MeshCensus census = censusOf(mesh);
  EXPECT_EQ(census.triangles, 192u);
  EXPECT_EQ(census.vertices, 98u) << "vertices without a triangle do not count";
  EXPECT_EQ(census.edges, 288u);
  EXPECT_EQ(census.euler, 2);
  EXPECT_EQ(census.components, 1u);
  EXPECT_EQ(census.border_edges + census.nonmanifold_edges + census.nonmanifold_vertices, 0u);
  EXPECT_EQ(census.turned_edges, 0u);
  std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
  EXPECT_EQ(censusOf(mesh).turned_edges, 3u);
  mesh.triangles.pop_back();
  census = censusOf(mesh);
  EXPECT_EQ(census.border_edges, 3u);
  EXPECT_EQ(census.euler, 1);
}

TEST(Fans, BodiesThatShareAnEdgeAreParted) {
  std::vector<Triangle> made;
  addTetrahedron(0, 1, 2, 3, made);
  addTetrahedron(0, 1, 4, 5, made);
  const MeshCensus before = censusOf(triangles(made, 6));
  EXPECT_EQ(before.nonmanifold_edges, 1u);
  EXPECT_EQ(before.nonmanifold_vertices, 2u);
  const auto copies = separateFans(6, made, 1);
  EXPECT_EQ(copies, (std::vector<std::uint32_t>{0, 1}));
  const MeshCensus after = censusOf(triangles(made, 8));
  EXPECT_EQ(after.nonmanifold_edges + after.nonmanifold_vertices + after.border_edges, 0u);
  EXPECT_EQ(after.components, 2u);
  EXPECT_EQ(after.euler, 4);
}

TEST(Fans, BodiesThatShareAVertexAreParted) {
  std::vector<Triangle> made;
  addTetrahedron(0, 1, 2, 3, made);
  addTetrahedron(0, 4, 5, 6, made);
  EXPECT_EQ(censusOf(triangles(made, 7)).nonmanifold_vertices, 1u);
  EXPECT_EQ(separateFans(7, made, 1), (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(censusOf(triangles(made, 8)).nonmanifold_vertices, 0u);
  EXPECT_TRUE(separateFans(8, made, 1).empty()) << "nothing is left to part";
}

TEST(Fans, SidesAreThoseOfMost) {
  std::vector<Triangle> made;
  addTetrahedron(0, 1, 2, 3, made);
  addTetrahedron(4, 5, 6, 7, made);
  const std::vector<Triangle> right = made;
  std::swap(made[0][1], made[0][2]);
  std::swap(made[6][0], made[6][1]);
  const auto turned = agreeOnSides(made, 1);
  EXPECT_EQ(turned, (std::vector<std::uint8_t>{1, 0, 0, 0, 0, 0, 1, 0}));
  EXPECT_EQ(censusOf(triangles(made, 8)).turned_edges, 0u);
  EXPECT_EQ(made[1], right[1]);
}

}  // namespace

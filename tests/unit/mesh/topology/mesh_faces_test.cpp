// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/mesh/mesh_faces.h"

#include <gtest/gtest.h>

#include "pcl_slim/mesh/detail/mesh_topology.h"
#include "support/meshes.h"

namespace {

using namespace pcl_slim;
using pcl_slim_test::cubeMesh;

std::vector<std::uint32_t> listed(IndexRow row) {
  return {row.begin(), row.end()};
}

/** Two triangles and a square in a row: 0 1 2, 2 1 3 and 3 1 4 5. */
MeshFaces strip() {
  MeshFaces faces;
  const std::uint32_t a[] = {0, 1, 2}, b[] = {2, 1, 3}, c[] = {3, 1, 4, 5};
  faces.add(a, 3);
  faces.add(b, 3);
  faces.add(c, 4);
  return faces;
}

TEST(MeshFaces, AreasAndMiddlesAreThoseOfPolygons) {
  const std::vector<Vector3> vertices = {{0, 0, 1}, {2, 0, 1}, {2, 3, 1}, {0, 3, 1}};
  const std::uint32_t corners[] = {0, 1, 2, 3};
  const IndexRow square = {corners, corners + 4}, edge = {corners, corners + 2};
  EXPECT_EQ(areaVector(vertices, square), (Vector3{0, 0, 6}));
  EXPECT_EQ(centroid(vertices, square), (Vector3{1, 1.5, 1}));
  EXPECT_EQ(areaVector(vertices, edge), (Vector3{0, 0, 0}));
}

TEST(MeshFaces, ValidationNamesTheFace) {
  MeshFaces faces = strip();
  EXPECT_FALSE(faces.validate(6));
  EXPECT_NE(faces.validate(5).message.find("face 2 names vertex 5 of 5"), std::string::npos);
  faces.begin[1] = 9;
  EXPECT_NE(faces.validate(6).message.find("face 1"), std::string::npos);
  EXPECT_EQ(MeshFaces().size(), 0u);
}

TEST(MeshTopology, FindsNeighboursAcrossEdgesAndCorners) {
  const MeshTopology topology(strip(), 7);
  EXPECT_EQ(listed(topology.facesOf(1)), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(listed(topology.facesOf(6)), (std::vector<std::uint32_t>{}));
  EXPECT_EQ(listed(topology.acrossEdges(0)), (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(listed(topology.acrossEdges(1)), (std::vector<std::uint32_t>{0, 2}));
  EXPECT_EQ(listed(topology.around(0)), (std::vector<std::uint32_t>{1, 2}));
}

TEST(EdgeCensus, CountsWhatDisagreesAndWhatBranches) {
  std::uint64_t disagreeing = 9, branching = 9;
  detail::countEdges(cubeMesh(3).faces, disagreeing, branching);
  EXPECT_EQ(disagreeing, 0u);
  EXPECT_EQ(branching, 0u);
  MeshFaces faces = strip();
  const std::uint32_t turned[] = {4, 5, 6}, third[] = {1, 2, 6};
  faces.add(turned, 3);
  detail::countEdges(faces, disagreeing, branching);
  EXPECT_EQ(disagreeing, 1u);
  EXPECT_EQ(branching, 0u);
  faces.add(third, 3);
  detail::countEdges(faces, disagreeing, branching);
  EXPECT_EQ(branching, 1u);
}

}  // namespace

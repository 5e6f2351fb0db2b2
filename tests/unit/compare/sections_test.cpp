// SPDX-License-Identifier: BSD-3-Clause
// Lines in which planes cut bodies: lengths, directions, ends.
#include "pcl_slim/compare/sections.h"

#include <gtest/gtest.h>

#include "unit/compare/compare_meshes.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

std::vector<SectionLine> cut(const TriangleMesh& mesh, const Vector3& place,
                             const Vector3& normal) {
  const Result<SectionPlane> plane = SectionPlane::through(place, normal);
  EXPECT_TRUE(plane);
  Result<std::vector<SectionLine>> lines = cutMesh(mesh, *plane);
  EXPECT_TRUE(lines) << lines.error().message;
  return *lines;
}

/** Area to the left of a line as seen from the normal's tip, by the shoelace formula. */
double enclosed(const SectionLine& line, const Vector3& normal) {
  Vector3 sum{};
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const Vector3& next = line.points[(i + 1) % line.points.size()];
    sum = along(sum, 0.5,
                cross(subtract(line.points[i], line.points[0]), subtract(next, line.points[0])));
  }
  return dot(sum, normal);
}

TEST(Sections, OutlinesOfABoxAreClosedAndTurnLeft) {
  const TriangleMesh box = boxMesh(3, {2, 1, 0.5}, {10, 20, 30});
  for (const TriangleMesh& mesh : {box, soupOf(box)}) {
    const auto lines = cut(mesh, {10, 20, 30.1}, {0, 0, 1});
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_TRUE(lines[0].closed);
    EXPECT_NEAR(enclosed(lines[0], {0, 0, 1}), 8, 1e-12);
    for (std::size_t i = 0; i < lines[0].points.size(); ++i) {
      const auto [low, high] = lines[0].edge[i];
      const Vector3& a = mesh.vertices[low];
      const Vector3 p = along(a, lines[0].share[i], subtract(mesh.vertices[high], a));
      EXPECT_NEAR(length(subtract(p, lines[0].points[i])), 0, 1e-12);
      EXPECT_NEAR(p[2], 30.1, 1e-12);
    }
  }
}

TEST(Sections, APlaneThroughVerticesCutsOnce) {
  // The plane contains a ring of vertices and the edges between them.
  const auto lines = cut(boxMesh(2, {1, 1, 1}), {0, 0, 0}, {0, 0, 1});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_TRUE(lines[0].closed);
  EXPECT_NEAR(enclosed(lines[0], {0, 0, 1}), 4, 1e-12);
}

TEST(Sections, CirclesOfASphere) {
  const Vector3 normal = normalized({1, 2, 3});
  const auto lines = cut(trianglesOf(sphereMesh(40)), scaled(normal, 0.5), normal);
  ASSERT_EQ(lines.size(), 1u);
  // A circle of radius sqrt(3)/2; the sphere's facets are up to 1/3200 inside.
  EXPECT_NEAR(enclosed(lines[0], normal), M_PI * 0.75, 4e-3);
  // A plane beside it meets nothing.
  EXPECT_TRUE(cut(trianglesOf(sphereMesh(4)), scaled(normal, 1.5), normal).empty());
}

TEST(Sections, LinesOfOpenMeshesEndAtBorders) {
  TriangleMesh open = boxMesh(4, {1, 1, 1});
  std::vector<std::array<std::uint32_t, 3>> kept;
  for (const auto& t : open.triangles) {
    const bool right =
        open.vertices[t[0]][0] == 1 && open.vertices[t[1]][0] == 1 && open.vertices[t[2]][0] == 1;
    if (!right) kept.push_back(t);
  }
  open.triangles = kept;
  const auto lines = cut(open, {0, 0, 0.1}, {0, 0, 1});
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_FALSE(lines[0].closed);
  // From one end of the missing side round the three others, outside to the right.
  EXPECT_NEAR(lines[0].points.front()[1], 1, 1e-12);
  EXPECT_NEAR(lines[0].points.back()[1], -1, 1e-12);
  double total = 0;
  for (std::size_t i = 1; i < lines[0].points.size(); ++i) {
    total += length(subtract(lines[0].points[i], lines[0].points[i - 1]));
  }
  EXPECT_NEAR(total, 6, 1e-12);
}

TEST(Sections, SeveralBodiesGiveSeveralLines) {
  TriangleMesh both = boxMesh(1, {1, 1, 1});
  append(boxMesh(1, {1, 1, 1}, {5, 0, 0}), both);
  const auto lines = cut(both, {0, 0, 0.3}, {0, 0, 1});
  ASSERT_EQ(lines.size(), 2u);
  for (const SectionLine& line : lines) EXPECT_NEAR(enclosed(line, {0, 0, 1}), 4, 1e-12);
}

TEST(Sections, PlanesHaveAxesForDrawing) {
  for (const Vector3& normal :
       {Vector3{0, 0, 1}, Vector3{0, 0, -2}, Vector3{1, 0, 0}, Vector3{1, 2, 3}}) {
    const Result<SectionPlane> plane = SectionPlane::through({1, 1, 1}, normal);
    ASSERT_TRUE(plane);
    EXPECT_NEAR(length(subtract(cross(plane->right, plane->up), plane->normal)), 0, 1e-12);
    EXPECT_GE(plane->up[2], 0);
  }
  EXPECT_EQ(SectionPlane::through({0, 0, 0}, {0, 0, 0}).error().code, ErrorCode::kBadInput);
}

}  // namespace

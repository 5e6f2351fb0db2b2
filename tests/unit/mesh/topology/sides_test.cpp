// SPDX-License-Identifier: BSD-3-Clause
// Sides of triangles: small regions follow their neighbours, large ones keep theirs.
#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/mesh/detail/mesh_topology.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "pcl_slim/mesh/triangle_mesh.h"
#include "support/side_scans.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::detail;

/** A planar grid of squares, two triangles each, over vertices x + (width + 1) y. */
std::vector<Triangle> gridTriangles(std::uint32_t width, std::uint32_t height) {
  std::vector<Triangle> made;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::uint32_t v = x + (width + 1) * y, up = v + width + 1;
      made.push_back({v, v + 1, up + 1});
      made.push_back({v, up + 1, up});
    }
  }
  return made;
}

/** Turns the squares of a grid that a rule selects. \return which triangles are turned */
template <typename Rule>
std::vector<std::uint8_t> turnSquares(std::uint32_t width, const Rule& rule,
                                      std::vector<Triangle>& made) {
  std::vector<std::uint8_t> turned(made.size(), 0);
  for (std::uint32_t t = 0; t < made.size(); ++t) {
    const std::uint32_t square = t / 2;
    if (!rule(square % width, square / width)) continue;
    std::swap(made[t][1], made[t][2]);
    turned[t] = 1;
  }
  return turned;
}

TEST(AgreeOnSides, KeepsThoseThatAgree) {
  std::vector<Triangle> made = gridTriangles(10, 10);
  const std::vector<Triangle> before = made;
  EXPECT_EQ(agreeOnSides(made, 1), std::vector<std::uint8_t>(made.size(), 0));
  EXPECT_EQ(made, before);
  made.clear();
  EXPECT_TRUE(agreeOnSides(made, 1).empty());
}

TEST(AgreeOnSides, TurnsASmallRegion) {
  const auto inside = [](std::uint32_t x, std::uint32_t y) {
    return x >= 4 && x < 7 && y >= 5 && y < 7;
  };
  for (const int threads : {1, 3}) {
    std::vector<Triangle> made = gridTriangles(20, 20);
    const std::vector<Triangle> right = made;
    const auto expected = turnSquares(20, inside, made);
    const auto found = agreeOnSides(made, threads);
    EXPECT_EQ(found, expected);
    TriangleMesh mesh;
    mesh.vertices.resize(21 * 21);
    mesh.triangles = made;
    EXPECT_EQ(censusOf(mesh).turned_edges, 0u);
  }
}

TEST(AgreeOnSides, ALargeRegionKeepsItsSideAgainstALargerOne) {
  // Two sheets of 20 x 12 and 20 x 20 squares, linked by 3 edges alone, which the contour got wrong.
  std::vector<Triangle> made = gridTriangles(20, 32);
  const auto smaller = [](std::uint32_t, std::uint32_t y) { return y >= 20; };
  turnSquares(20, smaller, made);
  std::vector<Triangle> parted;
  for (std::uint32_t t = 0; t < made.size(); ++t) {
    Triangle triangle = made[t];
    const bool upper = t / 2 / 20 >= 20;
    // The vertices of the smaller sheet's first row are its own, but for four.
    for (std::uint32_t& v : triangle) {
      if (upper && v / 21 == 20 && v % 21 > 3) v += 1000;
    }
    parted.push_back(triangle);
  }
  const std::vector<Triangle> before = parted;
  EXPECT_EQ(agreeOnSides(parted, 1), std::vector<std::uint8_t>(parted.size(), 0));
  EXPECT_EQ(parted, before);
}

TEST(AgreeOnSides, ManySmallRegionsTurnEach) {
  std::vector<Triangle> made = gridTriangles(30, 30);
  const auto expected = turnSquares(
      30, [](std::uint32_t x, std::uint32_t y) { return x % 5 == 2 && y % 4 == 1; }, made);
  EXPECT_EQ(agreeOnSides(made, 1), expected);
}

/** The connected component of each triangle: its least triangle. */
std::vector<std::uint32_t> componentsOf(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : {t[1], t[2]}) parent[root(v)] = root(t[0]);
  }
  std::vector<std::uint32_t> component;
  for (const auto& t : mesh.triangles) component.push_back(root(t[0]));
  return component;
}

TEST(MeshSides, OfADepthFrameFaceTheCamera) {
  measure::DepthCamera camera;
  camera.width = 240;
  camera.height = 180;
  camera.focal = 220;
  const auto scan = scanByCamera(measure::namedSolids("room"), camera, 3);
  const pcl_slim_test::Cloud cloud = pcl_slim_test::aboutSensor(scan);
  const CloudView view = cloud.view();
  const auto store = PointStore::build(view, 1);
  ASSERT_TRUE(store);
  FitParams params;
  params.viewpoint = {{0, 0, 0}};
  params.threads = 1;
  SLIMSurface surface;
  ASSERT_FALSE(fitSurface(*store, params, surface));
  TriangleMesh mesh;
  MeshParams how;
  how.threads = 1;
  ASSERT_FALSE(extractMesh(surface, how, mesh));
  const auto component = componentsOf(mesh);
  std::map<std::uint32_t, std::pair<double, double>> areas;  // that faces the camera, and all
  double facing = 0, all = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& corners = mesh.triangles[t];
    const Vector3 &a = mesh.vertices[corners[0]], &b = mesh.vertices[corners[1]],
                  &c = mesh.vertices[corners[2]];
    const Vector3 n = cross(subtract(b, a), subtract(c, a));
    const double area = length(n), seen = dot(n, a) < 0 ? area : 0;
    areas[component[t]].first += seen;
    areas[component[t]].second += area;
    facing += seen;
    all += area;
  }
  EXPECT_GT(areas.size(), 1u);
  EXPECT_GT(facing, 0.995 * all);
  for (const auto& [least, area] : areas)
    EXPECT_GT(area.first, 0.5 * area.second) << "component " << least << " of area " << area.second;
}

}  // namespace

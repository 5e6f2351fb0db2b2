// SPDX-License-Identifier: BSD-3-Clause
// Nearest places on triangles against all triangles and exact bodies; signs, borders, bad triangles.
#include "pcl_slim/compare/triangle_index.h"

#include <gtest/gtest.h>

#include <limits>

#include "unit/compare/compare_meshes.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

TriangleIndex indexOf(const TriangleMesh& mesh) {
  Result<TriangleIndex> made = TriangleIndex::make(mesh, 1);
  EXPECT_TRUE(made) << made.error().message;
  return std::move(*made);
}

/** Distance from a triangle: to its plane where the foot is inside, else to its edges. */
double triangleDistance(const TriangleMesh& mesh, std::size_t t, const Vector3& p) {
  const auto& c = mesh.triangles[t];
  const Vector3 area = cross(subtract(mesh.vertices[c[1]], mesh.vertices[c[0]]),
                             subtract(mesh.vertices[c[2]], mesh.vertices[c[0]]));
  const Vector3 n = normalized(area);
  double least = Bounds::kInfinity;
  bool inside = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3& a = mesh.vertices[c[k]];
    const Vector3 edge = subtract(mesh.vertices[c[(k + 1) % 3]], a), ap = subtract(p, a);
    inside = inside && dot(cross(n, edge), ap) >= 0;
    const double share = std::min(1.0, std::max(0.0, dot(ap, edge) / dot(edge, edge)));
    least = std::min(least, length(along(ap, -share, edge)));
  }
  return inside ? std::abs(dot(subtract(p, mesh.vertices[c[0]]), n)) : least;
}

TEST(TriangleIndex, FindsTheNearestOfAllTriangles) {
  // Triangles of all sizes in no order, as no mesh is.
  const auto corners = randomPlaces(1500, 1, 3);
  TriangleMesh soup;
  for (std::uint32_t t = 0; t < 500; ++t) {
    const double size = std::pow(0.01, t % 5 / 4.0);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vector3 off = subtract(corners[3 * t + k], corners[3 * t]);
      soup.vertices.push_back(along(corners[3 * t], size, off));
    }
    soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const TriangleIndex index = indexOf(soup);
  for (const Vector3& p : randomPlaces(500, 2, 5)) {
    double least = Bounds::kInfinity;
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
      least = std::min(least, triangleDistance(soup, t, p));
    }
    const TriangleFoot foot = index.nearest(p);
    ASSERT_TRUE(foot.found());
    EXPECT_NEAR(std::abs(foot.distance), least, 1e-12);
    EXPECT_NEAR(length(subtract(p, foot.position)), least, 1e-12);
    EXPECT_NEAR(triangleDistance(soup, foot.triangle, p), least, 1e-12);
    Vector3 weighted{};
    for (std::size_t k = 0; k < 3; ++k) {
      weighted = along(weighted, foot.weights[k], soup.vertices[soup.triangles[foot.triangle][k]]);
    }
    EXPECT_NEAR(length(subtract(weighted, foot.position)), 0, 1e-12);
    // A hint, however bad, and a bound just above change nothing; one below finds nothing.
    EXPECT_EQ(index.nearest(p, Bounds::kInfinity, nullptr, 7).distance, foot.distance);
    EXPECT_EQ(index.nearest(p, least * (1 + 1e-9)).distance, foot.distance);
    EXPECT_FALSE(index.nearest(p, least * (1 - 1e-9)).found());
  }
}

TEST(TriangleIndex, HasTheSignsOfAClosedBody) {
  // Most feet are on edges and vertices, where the normal of one triangle alone is often wrong.
  const Vector3 size = {1, 0.6, 0.2};
  const TriangleMesh box = boxMesh(2, size);
  for (const TriangleMesh& mesh : {box, soupOf(box)}) {
    const TriangleIndex index = indexOf(mesh);
    EXPECT_TRUE(index.statistics().closed());
    EXPECT_TRUE(index.statistics().oriented());
    EXPECT_NEAR(index.statistics().volume, 8 * 0.12, 1e-12);
    EXPECT_EQ(index.statistics().vertices, box.vertices.size());
    for (const Vector3& p : randomPlaces(2000, 2, 11)) {
      const TriangleFoot foot = index.nearest(p);
      EXPECT_NEAR(foot.distance, boxDistance(size, p), 1e-12);
      EXPECT_FALSE(foot.border);
    }
  }
}

TEST(TriangleIndex, LosesNothingInSurveyCoordinates) {
  const Vector3 size = {0.5, 0.25, 0.125}, far = {524288, 5242880, 1024};
  const TriangleIndex index = indexOf(boxMesh(3, size, far));
  for (const Vector3& p : randomPlaces(200, 1, 2)) {
    const TriangleFoot foot = index.nearest(along(far, 1, p));
    // The place itself is rounded by 2^-31.
    EXPECT_NEAR(foot.distance, boxDistance(size, p), 2e-9);
  }
}

TEST(TriangleIndex, NumbersPlacesOfNeedlesExactly) {
  // Heights of 1e-9 of the length: barycentric coordinates by products of edges are rounding errors.
  TriangleMesh needle;
  needle.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, 1e-9, 0}};
  needle.triangles = {{0, 1, 2}};
  const TriangleIndex index = indexOf(needle);
  EXPECT_EQ(index.statistics().flat, 0u);
  for (const double x : {0.001, 0.3, 0.5, 0.77}) {
    const TriangleFoot foot = index.nearest({x, 4e-10 * std::min(x, 1 - x), 0.25});
    EXPECT_NEAR(foot.distance, 0.25, 1e-12);
    EXPECT_NEAR(foot.position[0], x, 1e-9);
  }
}

TEST(TriangleIndex, SurvivesBadTriangles) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vector3 size = {1, 1, 1};
  TriangleMesh mesh = boxMesh(1, size);
  const std::uint32_t n = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back({nan, 0, 0});
  mesh.vertices.push_back(mesh.vertices[0]);
  mesh.triangles.push_back({0, 1, n});      // not finite
  mesh.triangles.push_back({0, n + 1, 2});  // two corners at one place
  mesh.triangles.push_back({3, 3, 4});
  const TriangleIndex index = indexOf(mesh);
  EXPECT_EQ(index.statistics().dropped, 3u);
  EXPECT_TRUE(index.statistics().closed());
  for (const Vector3& p : randomPlaces(200, 2, 13)) {
    EXPECT_NEAR(index.nearest(p).distance, boxDistance(size, p), 1e-12);
  }
}

TEST(TriangleIndex, FlatTrianglesCloseSeams) {
  // The top of a box has a vertex on an edge of its side, and a triangle of no area between them.
  const Vector3 size = {1, 1, 1};
  TriangleMesh mesh = boxMesh(1, size);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto c = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3 &a = mesh.vertices[c[k]], &b = mesh.vertices[c[(k + 1) % 3]],
                    &o = mesh.vertices[c[(k + 2) % 3]];
      const bool top_edge = a[2] == 1 && b[2] == 1 && o[2] == 1 && a[0] == 1 && b[0] == 1;
      if (!top_edge) continue;
      const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.push_back({1, 0.25, 1});
      mesh.triangles[t] = {c[k], middle, c[(k + 2) % 3]};
      mesh.triangles.push_back({middle, c[(k + 1) % 3], c[(k + 2) % 3]});
      mesh.triangles.push_back({c[k], c[(k + 1) % 3], middle});
      t = mesh.triangles.size();
      break;
    }
  }
  ASSERT_EQ(mesh.triangles.size(), 14u);
  const TriangleIndex index = indexOf(mesh);
  EXPECT_EQ(index.statistics().flat, 1u);
  EXPECT_TRUE(index.statistics().closed());
  for (const Vector3& p : randomPlaces(2000, 2, 17)) {
    const TriangleFoot foot = index.nearest(p);
    EXPECT_NEAR(foot.distance, boxDistance(size, p), 1e-12);
    EXPECT_FALSE(foot.border);
  }
}

TEST(TriangleIndex, KnowsBordersAndTurnedTriangles) {
  TriangleMesh square;
  square.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  const TriangleIndex index = indexOf(square);
  EXPECT_EQ(index.statistics().border_edges, 4u);
  EXPECT_FALSE(index.statistics().closed());
  EXPECT_TRUE(index.statistics().oriented());
  EXPECT_FALSE(index.nearest({0.5, 0.5, 1}).border);  // on the inner edge
  EXPECT_TRUE(index.nearest({1.5, 0.3, 1}).border);
  EXPECT_TRUE(index.nearest({-1, -1, 1}).border);
  EXPECT_LT(index.nearest({0.2, 0.4, -1}).distance, 0);
  square.triangles[1] = {0, 3, 2};
  EXPECT_EQ(indexOf(square).statistics().turned_edges, 1u);
}

TEST(TriangleIndex, FindsTheNearestThatFacesASide) {
  const Vector3 size = {1, 1, 0.01};
  const TriangleIndex index = indexOf(boxMesh(4, size));
  for (const Vector3& p : randomPlaces(300, 0.9, 19)) {
    const Vector3 up = {0, 0, 1}, down = {0, 0, -1};
    EXPECT_NEAR(index.nearest(p, 10, &up).distance, p[2] - 0.01, 1e-12);
    EXPECT_NEAR(index.nearest(p, 10, &down).distance, -p[2] - 0.01, 1e-12);
  }
  const Vector3 up = {0, 0, 1};
  EXPECT_FALSE(index.nearest({0, 0, -1}, 1, &up).found());
}

TEST(TriangleIndex, TreatsManyPlacesAsOneByOneForAnyThreads) {
  const TriangleIndex index = indexOf(trianglesOf(sphereMesh(8)));
  std::vector<Vector3> places = randomPlaces(3000, 2, 23);
  places[5][1] = std::numeric_limits<double>::infinity();
  const auto one = index.nearest(places, 0.7, {}, 1), four = index.nearest(places, 0.7, {}, 4);
  EXPECT_FALSE(one[5].found());
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i == 5) continue;
    EXPECT_EQ(one[i].distance, index.nearest(places[i], 0.7).distance);
    EXPECT_EQ(one[i].triangle, four[i].triangle);
    EXPECT_EQ(one[i].position, four[i].position);
  }
}

TEST(TriangleIndex, FarPlacesAndDeepTreesAreNoTrouble) {
  // Triangles at distances that double: every split at the middle of the box leaves one on a side.
  TriangleMesh mesh;
  for (std::uint32_t t = 0; t < 40; ++t) {
    const double x = std::ldexp(1e-4, static_cast<int>(t));
    for (const Vector3& p : {Vector3{x, 0, 0}, Vector3{x, 1, 0}, Vector3{x, 0, 1}}) {
      mesh.vertices.push_back(p);
    }
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const TriangleIndex index = indexOf(mesh);
  for (int t = 20; t < 39; ++t) {
    const double x = std::ldexp(1e-4, t);
    EXPECT_NEAR(index.nearest({1.25 * x, 0.2, 0.2}).position[0] / x, 1, 1e-9);
  }
  EXPECT_TRUE(index.nearest({1e30, 1e30, 0}).found());
  EXPECT_FALSE(index.nearest({1e300, 0, 0}).found());
}

TEST(TriangleIndex, NamesWhatIsWrong) {
  EXPECT_EQ(TriangleIndex::make({}).error().code, ErrorCode::kBadInput);
  TriangleMesh mesh = boxMesh(1, {1, 1, 1});
  mesh.triangles[3][1] = 99;
  const Result<TriangleIndex> made = TriangleIndex::make(mesh);
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().message.find("vertex 99 of 8"), std::string::npos);
  EXPECT_EQ(TriangleIndex::make(boxMesh(1, {1e300, 1, 1})).error().code, ErrorCode::kBadInput);
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "pcl_slim/fit/fit.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "support/clouds.h"
#include "vertices/surface_vertices.h"

namespace {

using namespace pcl_slim;
using pcl_slim_test::Cloud;

/** A box about the origin. */
struct Box {
  Vector3 half = {1, 0.8, 0.6};

  /** Signed distance, exact but outside beyond edges, where it is that from the nearest side's
   * plane. */
  double distance(const Vector3& p) const {
    double most = -1e9;
    for (std::size_t a = 0; a < 3; ++a) most = std::max(most, std::abs(p[a]) - half[a]);
    return most;
  }
};

SLIMSurface fit(const Cloud& cloud, bool sharp) {
  FitParams params;
  params.threads = 2;
  params.sharp_features = sharp;
  SLIMSurface surface;
  const Error error = fitSurface(pcl_slim_test::storeOf(cloud), params, surface);
  EXPECT_FALSE(error) << error.message;
  return surface;
}

TriangleMesh meshOf(const SLIMSurface& rounded, const MeshParams& params,
                    MeshStatistics& statistics) {
  TriangleMesh mesh;
  const Error error = extractMesh(rounded, params, mesh, &statistics);
  EXPECT_FALSE(error) << error.message;
  return mesh;
}

/** Distance from a corner of the box to the nearest vertex, the largest of all eight. */
double farthestCorner(const Box& box, const TriangleMesh& mesh) {
  double most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vector3 c = box.half;
    for (std::size_t a = 0; a < 3; ++a) c[a] *= (corner >> a & 1) != 0 ? 1 : -1;
    double least = 1e9;
    for (const Vector3& p : mesh.vertices) least = std::min(least, length(subtract(p, c)));
    most = std::max(most, least);
  }
  return most;
}

TEST(MeshSharpening, ABoxGetsItsEdgesAndCorners) {
  const Box box;
  for (const double noise : {0.0, 0.004}) {
    const Cloud cloud = pcl_slim_test::boxCloud(box.half, 12000, noise);
    const SLIMSurface rounded = fit(cloud, false), sharp = fit(cloud, true);
    MeshParams params;
    MeshStatistics statistics;
    const double round_corner = farthestCorner(box, meshOf(rounded, params, statistics));
    EXPECT_EQ(statistics.census.euler, 2)
        << "sides at right angles are one surface, as normals say";
    params.sharp = &sharp;
    const TriangleMesh mesh = meshOf(rounded, params, statistics);
    EXPECT_EQ(statistics.census.euler, 2);
    EXPECT_EQ(statistics.census.border_edges, 0u);
    EXPECT_EQ(statistics.census.nonmanifold_edges + statistics.census.nonmanifold_vertices, 0u);
    EXPECT_EQ(statistics.census.turned_edges, 0u);
    EXPECT_GE(statistics.corner_vertices, 8u);
    EXPECT_GT(statistics.edge_vertices, 100u);
    const double limit = 0.001 + noise;  // noise is averaged to a fifth on sides, less at corners
    EXPECT_LT(farthestCorner(box, mesh), 2 * limit);
    EXPECT_GT(round_corner, 4 * farthestCorner(box, mesh));
    double squares = 0, area = 0;
    for (const auto& t : mesh.triangles) {
      const Vector3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
      const double own = length(cross(subtract(b, a), subtract(c, a)));
      const double d = box.distance(scaled(along(along(a, 1, b), 1, c), 1 / 3.0));
      squares += own * d * d;
      area += own;
    }
    EXPECT_LT(std::sqrt(squares / area), limit / 2) << "of centroids, with noise " << noise;
  }
}

/** Its rim is rounded off so far that no leaf of the sharp fit reaches some of the mesh's vertices.
 */
TEST(MeshSharpening, ARimIsWhole) {
  Cloud cloud;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int i = 0; i < 12000; ++i) {
    const double a = 2 * M_PI * uniform(random), c = std::cos(a), s = std::sin(a);
    const double side = i % 4 == 0 ? 1 : -1, r = std::sqrt(uniform(random));
    if (i % 2 == 0) {
      cloud.add({r * c, r * s, side}, {0, 0, side});
    } else {
      cloud.add({c, s, 2 * uniform(random) - 1}, {c, s, 0});
    }
  }
  const SLIMSurface rounded = fit(cloud, false), sharp = fit(cloud, true);
  MeshParams params;
  params.sharp = &sharp;
  MeshStatistics statistics;
  const TriangleMesh mesh = meshOf(rounded, params, statistics);
  EXPECT_EQ(statistics.census.euler, 2);
  constexpr int kParts = 120;
  std::vector<int> on_rim(kParts, 0);
  for (const Vector3& p : mesh.vertices) {
    if (std::abs(p[2] - 1) > 0.005 || std::abs(std::hypot(p[0], p[1]) - 1) > 0.005) continue;
    ++on_rim[static_cast<std::size_t>((std::atan2(p[1], p[0]) / M_PI + 1) * 0.5 * (kParts - 1e-9))];
  }
  EXPECT_EQ(std::count(on_rim.begin(), on_rim.end(), 0), 0)
      << "parts of three degrees without a vertex";
}

TEST(MeshSharpening, FewTrianglesKeepTheCorners) {
  const Box box;
  const Cloud cloud = pcl_slim_test::boxCloud(box.half, 12000, 0);
  const SLIMSurface rounded = fit(cloud, false), sharp = fit(cloud, true);
  MeshParams params;
  params.sharp = &sharp;
  params.max_triangles = 300;
  MeshStatistics statistics;
  const TriangleMesh mesh = meshOf(rounded, params, statistics);
  EXPECT_LE(mesh.triangles.size(), 300u);
  EXPECT_EQ(statistics.census.euler, 2);
  EXPECT_LT(farthestCorner(box, mesh), 0.005);
}

TEST(MeshSharpening, GivesTheSameBytesForAnyNumberOfThreads) {
  const Cloud cloud = pcl_slim_test::boxCloud(Box().half, 6000, 0.004);
  const SLIMSurface rounded = fit(cloud, false), sharp = fit(cloud, true);
  MeshParams params;
  params.sharp = &sharp;
  MeshStatistics statistics;
  params.threads = 1;
  const TriangleMesh first = meshOf(rounded, params, statistics);
  params.threads = 3;
  const TriangleMesh second = meshOf(rounded, params, statistics);
  ASSERT_EQ(first.vertices.size(), second.vertices.size());
  EXPECT_EQ(std::memcmp(first.vertices.data(), second.vertices.data(),
                        first.vertices.size() * sizeof(Vector3)),
            0);
  EXPECT_EQ(first.triangles, second.triangles);
}

TEST(MeshSharpening, NeedsASurfaceWithSides) {
  const Cloud cloud = pcl_slim_test::boxCloud(Box().half, 3000, 0);
  const SLIMSurface rounded = fit(cloud, false), sideless = fit(cloud.withoutNormals(), false);
  MeshParams params;
  params.sharp = &sideless;
  TriangleMesh mesh;
  EXPECT_EQ(extractMesh(rounded, params, mesh).code, ErrorCode::kBadInput);
  EXPECT_TRUE(mesh.vertices.empty());
}

TEST(Crease, IsWherePlanesMeetNextToAPlace) {
  using detail::Plane;
  const Plane planes[3] = {{{0, 0, 1}, {0, 0, 1}}, {{0, 2, 5}, {0, 1, 0}}, {{3, 9, 9}, {1, 0, 0}}};
  Vector3 place;
  ASSERT_TRUE(detail::meetingOf(planes, 2, {7, 7, 7}, place));
  EXPECT_NEAR(length(subtract(place, {7, 2, 1})), 0, 1e-12);
  ASSERT_TRUE(detail::meetingOf(planes, 3, {7, 7, 7}, place));
  EXPECT_NEAR(length(subtract(place, {3, 2, 1})), 0, 1e-12);
  const Plane parallel[2] = {{{0, 0, 1}, {0, 0, 1}}, {{0, 0, 2}, normalized({0.01, 0, 1})}};
  EXPECT_FALSE(detail::meetingOf(parallel, 2, {0, 0, 0}, place));
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/mesh/mesh_extraction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "support/clouds.h"
#include "support/lab/mesh_error.h"
#include "support/sphere_surface.h"

namespace {

using namespace pcl_slim;
using measure::Shape;
using pcl_slim_test::Cloud;

SLIMSurface surfaceOf(const Cloud& cloud) {
  const PointStore store = pcl_slim_test::storeOf(cloud);
  FitParams params;
  params.threads = 2;
  SLIMSurface surface;
  const Error error = fitSurface(store, params, surface);
  EXPECT_FALSE(error) << error.message;
  return surface;
}

TriangleMesh extract(const SLIMSurface& surface, const MeshParams& params,
                     MeshStatistics& statistics) {
  TriangleMesh mesh;
  const Error error = extractMesh(surface, params, mesh, &statistics);
  EXPECT_FALSE(error) << error.message;
  return mesh;
}

void expectManifold(const MeshCensus& census) {
  EXPECT_EQ(census.nonmanifold_edges, 0u);
  EXPECT_EQ(census.nonmanifold_vertices, 0u);
  EXPECT_EQ(census.turned_edges, 0u);
}

struct ClosedCase {
  const char* name;
  Shape shape;
  std::int64_t euler;
  double noise;
  bool normals;
};

void PrintTo(const ClosedCase& c, std::ostream* out) {
  *out << c.name << " noise " << c.noise << (c.normals ? " with normals" : "");
}

class ClosedSurfaces : public testing::TestWithParam<ClosedCase> {};

TEST_P(ClosedSurfaces, AreClosedManifoldAndWithinTheTolerance) {
  const ClosedCase c = GetParam();
  Cloud cloud = pcl_slim_test::sceneCloud(c.shape, 8000, c.noise);
  if (!c.normals) cloud = cloud.withoutNormals();
  MeshStatistics statistics;
  const SLIMSurface surface = surfaceOf(cloud);
  MeshParams params;
  if (c.noise == 0) params.tolerance = 4e-4 * surface.info.diagonal * surface.info.scale;
  const TriangleMesh mesh = extract(surface, params, statistics);
  const MeshCensus& census = statistics.census;
  EXPECT_EQ(census.euler, c.euler);
  EXPECT_EQ(census.components, 1u);
  EXPECT_EQ(census.border_edges, 0u);
  EXPECT_EQ(statistics.unprojected, 0u);
  expectManifold(census);

  const measure::MeshError error = measure::measureMesh(c.shape, mesh);
  const double sigma = c.noise * surface.info.diagonal * surface.info.scale;
  if (c.noise == 0) {
    EXPECT_LE(error.max, statistics.tolerance);
    EXPECT_LE(error.normal, 1.0);
  } else {
    // The vertices are on the fit, which averages the noise down to about a fifth. Triangles as
    // wide as the points' spacing add about the tolerance.
    EXPECT_LE(error.vertex_rms, 0.35 * sigma);
    EXPECT_LE(error.rms, error.vertex_rms + 0.7 * statistics.tolerance);
  }
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    volume += dot(mesh.vertices[t[0]], cross(mesh.vertices[t[1]], mesh.vertices[t[2]])) / 6;
  }
  EXPECT_TRUE(volume > 0 || !c.normals) << "triangles face outwards, as the normals do";
}

std::vector<ClosedCase> closedCases() {
  std::vector<ClosedCase> cases;
  for (const double noise : {0.0, 0.001, 0.005}) {
    for (const bool normals : {true, false}) {
      cases.push_back({"sphere", Shape::kSphere, 2, noise, normals});
      cases.push_back({"torus", Shape::kTorus, 0, noise, normals});
      cases.push_back({"bumpy", Shape::kBumpy, 2, noise, normals});
    }
  }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Scenes, ClosedSurfaces, testing::ValuesIn(closedCases()));

TEST(MeshExtraction, ToleranceBoundsTheError) {
  const SLIMSurface surface = surfaceOf(pcl_slim_test::sceneCloud(Shape::kTorus, 20000, 0));
  std::size_t last = std::numeric_limits<std::size_t>::max();
  for (const double tolerance : {3e-4, 1e-3}) {
    MeshParams params;
    params.tolerance = tolerance;
    MeshStatistics statistics;
    const TriangleMesh mesh = extract(surface, params, statistics);
    EXPECT_LE(measure::measureMesh(Shape::kTorus, mesh).max, tolerance);
    EXPECT_EQ(statistics.census.euler, 0);
    EXPECT_LT(mesh.triangles.size(), last);
    last = mesh.triangles.size();
  }
}

TEST(MeshExtraction, VerticesHaveTheSurfacesNormalsAndCurvatures) {
  const SLIMSurface surface = surfaceOf(pcl_slim_test::sceneCloud(Shape::kSphere, 20000, 0));
  MeshStatistics statistics;
  const TriangleMesh mesh = extract(surface, {}, statistics);
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  ASSERT_EQ(mesh.k1.size(), mesh.vertices.size());
  ASSERT_EQ(mesh.k2.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vector3 n = {mesh.normals[v][0], mesh.normals[v][1], mesh.normals[v][2]};
    EXPECT_GT(dot(n, mesh.vertices[v]), 0.9999);
    EXPECT_NEAR(mesh.k1[v], 1, 0.02);
    EXPECT_NEAR(mesh.k2[v], 1, 0.02);
  }
}

TEST(MeshExtraction, OpenReliefEndsWhereItsPointsDo) {
  for (const double noise : {0.0, 0.001, 0.005}) {
    const SLIMSurface surface = surfaceOf(pcl_slim_test::sceneCloud(Shape::kRelief, 30000, noise));
    MeshStatistics statistics;
    const TriangleMesh mesh = extract(surface, {}, statistics);
    EXPECT_EQ(statistics.census.euler, 1) << "a disc";
    EXPECT_EQ(statistics.census.components, 1u);
    EXPECT_GT(statistics.census.border_edges, 50u);
    expectManifold(statistics.census);
    // The square's side is 2; the rim is within four spacings of 2 / sqrt(30000), and noise moves
    // it.
    const double reach = 1 + 4 * 2 / std::sqrt(30000.0) + 3 * noise * 2.9;
    double most = 0;
    for (const Vector3& p : mesh.vertices) {
      most = std::max({most, std::abs(p[0]), std::abs(p[1])});
    }
    EXPECT_LT(most, reach);
    EXPECT_GT(most, 0.99);
  }
}

TEST(MeshExtraction, WithoutTrimmingItGoesOnToTheLeavesEnds) {
  const SLIMSurface surface = surfaceOf(pcl_slim_test::sceneCloud(Shape::kRelief, 20000, 0.001));
  MeshStatistics statistics;
  MeshParams params;
  const double trimmed =
      measure::measureMesh(Shape::kRelief, extract(surface, params, statistics)).area;
  params.trim = false;
  const double whole =
      measure::measureMesh(Shape::kRelief, extract(surface, params, statistics)).area;
  EXPECT_GT(whole, 1.01 * trimmed);
  expectManifold(statistics.census);
}

/** A square with a round hole. */
Cloud punched(double radius) {
  Cloud cloud;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> along(-1, 1);
  while (cloud.size() < 20000) {
    const double x = along(random), y = along(random);
    if (std::hypot(x, y) > radius) cloud.add(x, y, 0.05 * x * x);
  }
  return cloud;
}

TEST(MeshExtraction, HolesOfTheDataStayOpenUnlessTheyAreSmall) {
  const double spacing = 2 / std::sqrt(20000.0);
  MeshStatistics statistics;
  const SLIMSurface surface = surfaceOf(punched(8 * spacing));
  extract(surface, {}, statistics);
  EXPECT_EQ(statistics.census.euler, 0) << "a ring";
  EXPECT_EQ(statistics.census.components, 1u);
  expectManifold(statistics.census);
  EXPECT_EQ(statistics.border_loops, 2u);
  EXPECT_EQ(statistics.sheet_ends, 1u);
  EXPECT_NEAR(statistics.widest_hole, 16, 2);
  MeshParams params;
  params.hole_size = statistics.widest_hole + 0.1;
  extract(surface, params, statistics);
  EXPECT_EQ(statistics.census.euler, 1) << "a disc";
  EXPECT_EQ(statistics.closed_holes, 1u);
  EXPECT_NEAR(statistics.closed_area / (64 * M_PI * spacing * spacing), 1, 0.25);
  const SLIMSurface small = surfaceOf(punched(2.2 * spacing));
  extract(small, {}, statistics);
  EXPECT_EQ(statistics.census.euler, 1) << "a disc";
  EXPECT_EQ(statistics.border_loops, 1u);
}

TEST(MeshExtraction, SmallComponentsAreLeftOut) {
  Cloud cloud = pcl_slim_test::sceneCloud(Shape::kSphere, 5000, 0);
  std::mt19937 random(5);
  std::normal_distribution<double> gauss;
  for (int i = 0; i < 300; ++i) {
    const Vector3 d = normalized({gauss(random), gauss(random), gauss(random)});
    cloud.add({3 + 0.25 * d[0], 0.25 * d[1], 0.25 * d[2]}, {d[0], d[1], d[2]});
  }
  const SLIMSurface surface = surfaceOf(cloud);
  MeshStatistics statistics;
  MeshParams params;
  extract(surface, params, statistics);
  EXPECT_EQ(statistics.census.components, 2u);
  EXPECT_EQ(statistics.dropped, 0u);
  params.min_component_points = 1000;
  extract(surface, params, statistics);
  EXPECT_EQ(statistics.census.components, 1u);
  EXPECT_EQ(statistics.left_out.components, 1u);
  EXPECT_NEAR(statistics.left_out.points, 300, 100);
  params.min_component_points = 1e9;
  extract(surface, params, statistics);
  EXPECT_EQ(statistics.census.components, 1u) << "the largest stays";
}

TEST(MeshExtraction, NumberOfTrianglesCanBeLimited) {
  const SLIMSurface surface = surfaceOf(pcl_slim_test::sceneCloud(Shape::kTorus, 10000, 0));
  MeshParams params;
  double last = 0;
  for (const std::uint64_t most : {20000, 5000, 1000}) {
    params.max_triangles = most;
    MeshStatistics statistics;
    const TriangleMesh mesh = extract(surface, params, statistics);
    EXPECT_LE(mesh.triangles.size(), most);
    EXPECT_GE(mesh.triangles.size(), most - 2);
    EXPECT_GT(statistics.collapsed, 0u);
    EXPECT_EQ(statistics.census.euler, 0);
    EXPECT_EQ(statistics.census.border_edges, 0u);
    expectManifold(statistics.census);
    const measure::MeshError error = measure::measureMesh(Shape::kTorus, mesh);
    EXPECT_LT(error.vertex_rms, 1e-5) << "vertices stay on the surface";
    EXPECT_GT(error.rms, last);
    last = error.rms;
  }
  // A thousand triangles of .0159 each: the sagitta of an edge of .19 on a radius of .4 is .011.
  EXPECT_LT(last, 0.011);
  params.max_triangles = 1;
  TriangleMesh none;
  EXPECT_EQ(extractMesh(surface, params, none).code, ErrorCode::kBadArgument);
  EXPECT_TRUE(none.vertices.empty());
}

TEST(MeshExtraction, FewTrianglesKeepTheBorder) {
  const SLIMSurface surface = surfaceOf(pcl_slim_test::sceneCloud(Shape::kRelief, 10000, 0));
  MeshParams params;
  params.max_triangles = 3000;
  MeshStatistics statistics;
  const TriangleMesh mesh = extract(surface, params, statistics);
  EXPECT_EQ(statistics.census.euler, 1);
  EXPECT_EQ(statistics.census.components, 1u);
  expectManifold(statistics.census);
  const double area = measure::measureMesh(Shape::kRelief, mesh).area;
  params.max_triangles = 0;
  const double whole =
      measure::measureMesh(Shape::kRelief, extract(surface, params, statistics)).area;
  EXPECT_NEAR(area / whole, 1, 0.01);
}

template <typename T>
void expectSameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(T)), 0);
}

TEST(MeshExtraction, GivesTheSameBytesForAnyNumberOfThreads) {
  for (const bool normals : {true, false}) {
    Cloud cloud = pcl_slim_test::sceneCloud(Shape::kRelief, 15000, 0.001);
    if (!normals) cloud = cloud.withoutNormals();
    const SLIMSurface surface = surfaceOf(cloud);
    MeshParams params;
    MeshStatistics statistics;
    params.threads = 1;
    const TriangleMesh first = extract(surface, params, statistics);
    for (const int threads : {2, 5}) {
      params.threads = threads;
      const TriangleMesh mesh = extract(surface, params, statistics);
      expectSameBytes(first.vertices, mesh.vertices);
      expectSameBytes(first.normals, mesh.normals);
      expectSameBytes(first.k1, mesh.k1);
      expectSameBytes(first.k2, mesh.k2);
      expectSameBytes(first.triangles, mesh.triangles);
    }
  }
}

TEST(MeshExtraction, KeepsWorldCoordinates) {
  Cloud cloud = pcl_slim_test::sceneCloud(Shape::kSphere, 5000, 0);
  for (std::size_t i = 0; i < cloud.points.size(); i += 3) {
    cloud.points[i] += 500000;
    cloud.points[i + 1] += 5400000;
  }
  MeshStatistics statistics;
  const TriangleMesh mesh = extract(surfaceOf(cloud), {}, statistics);
  for (const Vector3& p : mesh.vertices) {
    EXPECT_NEAR(length(subtract(p, {500000, 5400000, 0})), 1, 1e-4);
  }
}

TEST(MeshExtraction, NamesBadArguments) {
  const SLIMSurface surface = surfaceOf(pcl_slim_test::sceneCloud(Shape::kSphere, 2000, 0));
  TriangleMesh mesh;
  mesh.vertices.resize(3);
  EXPECT_EQ(extractMesh(SLIMSurface(), {}, mesh).code, ErrorCode::kBadInput);
  EXPECT_TRUE(mesh.vertices.empty()) << "outputs are cleared";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const auto& change) {
    MeshParams params;
    change(params);
    const Error error = extractMesh(surface, params, mesh);
    return error.code == ErrorCode::kBadArgument && !error.message.empty() && mesh.vertices.empty();
  };
  EXPECT_TRUE(refused([&](MeshParams& p) { p.tolerance = -1; }));
  EXPECT_TRUE(refused([&](MeshParams& p) { p.tolerance = nan; }));
  EXPECT_TRUE(refused([&](MeshParams& p) { p.hole_size = nan; }));
  EXPECT_TRUE(refused([&](MeshParams& p) { p.min_component_points = -1; }));
  EXPECT_TRUE(refused([&](MeshParams& p) { p.relax = 101; }));
  EXPECT_TRUE(refused([&](MeshParams& p) { p.threads = -1; }));
  SLIMSurface broken = surface;
  broken.radius[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(extractMesh(broken, {}, mesh));
}

TEST(MeshExtraction, CanBeCancelled) {
  const SLIMSurface surface = surfaceOf(pcl_slim_test::sceneCloud(Shape::kSphere, 5000, 0));
  for (const char* stage : {"dividing cells", "contouring", "smoothing triangles"}) {
    Progress* running = nullptr;
    Progress progress([&](float, const char* at) {
      if (std::strcmp(at, stage) == 0) running->cancel();
    });
    running = &progress;
    TriangleMesh mesh;
    EXPECT_EQ(extractMesh(surface, {}, mesh, nullptr, &progress).code, ErrorCode::kCancelled);
    EXPECT_TRUE(mesh.triangles.empty());
  }
}

TEST(MeshExtraction, FewPointsGiveAMesh) {
  MeshStatistics statistics;
  const TriangleMesh mesh =
      extract(surfaceOf(pcl_slim_test::sceneCloud(Shape::kSphere, 60, 0)), {}, statistics);
  EXPECT_FALSE(mesh.triangles.empty());
  expectManifold(statistics.census);
}

}  // namespace

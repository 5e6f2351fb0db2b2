// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/mesh/mesh_smoothing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/meshes.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

double sphereError(const std::vector<Vector3>& vertices, const Vector3& middle = {}) {
  double sum = 0;
  for (const Vector3& p : vertices) sum += std::pow(length(subtract(p, middle)) - 1, 2);
  return std::sqrt(sum / static_cast<double>(vertices.size()));
}

/** Greatest coordinate less 1: how far a vertex is off a side of the cube. */
double cubeError(const std::vector<Vector3>& vertices) {
  double sum = 0;
  for (const Vector3& p : vertices) {
    sum += std::pow(std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}) - 1, 2);
  }
  return std::sqrt(sum / static_cast<double>(vertices.size()));
}

SmoothedMesh smoothed(const TestMesh& mesh, const MeshSmoothParams& params = {},
                      MeshSmoothStatistics* s = nullptr) {
  SmoothedMesh made;
  const Error error = smoothMesh(mesh.view(), mesh.faces, params, nullptr, made, s);
  EXPECT_FALSE(error) << error.message;
  return made;
}

TEST(MeshSmoothing, ASphereLosesItsNoise) {
  for (const bool squares : {false, true}) {
    TestMesh sphere = sphereMesh(24, squares);
    addNoise(0.01, sphere);
    const double before = sphereError(sphere.vertices);
    MeshSmoothStatistics s;
    const SmoothedMesh made = smoothed(sphere, {}, &s);
    // Normals average over a dozen faces four times; what is left is noise of longer waves.
    EXPECT_LT(sphereError(made.vertices), 0.45 * before) << squares;
    EXPECT_FALSE(s.sharp);
    EXPECT_EQ(s.moved, sphere.vertices.size());
    EXPECT_EQ(s.faces, sphere.faces.size());
    for (std::size_t v = 0; v < made.normals.size(); ++v) {
      EXPECT_GT(dot(made.normals[v], normalized(sphere.vertices[v])), 0.98);
    }
  }
}

TEST(MeshSmoothing, ACubeKeepsItsEdges) {
  TestMesh cube = cubeMesh(24);
  addNoise(0.012, cube);
  MeshSmoothStatistics s;
  const SmoothedMesh made = smoothed(cube, {}, &s);
  EXPECT_TRUE(s.sharp);
  EXPECT_GT(s.sharp_share, 0.63);
  EXPECT_LT(cubeError(made.vertices), 0.35 * cubeError(cube.vertices));
  MeshSmoothParams rounded;
  rounded.edges = MeshEdges::kRounded;
  EXPECT_LT(cubeError(made.vertices), 0.6 * cubeError(smoothed(cube, rounded, &s).vertices));
  EXPECT_FALSE(s.sharp);
}

TEST(MeshSmoothing, AsThePaperHasIt) {
  TestMesh sphere = sphereMesh(24);
  addNoise(0.005, sphere);
  MeshSmoothParams params;
  params.fit.paper_mode = true;
  MeshSmoothStatistics s;
  const SmoothedMesh made = smoothed(sphere, params, &s);
  // Tangent planes at the centroids meet outside the sphere, by the square of half an edge: 1e-3.
  EXPECT_LT(sphereError(made.vertices), 0.7 * sphereError(sphere.vertices));
  EXPECT_GT(s.fit.leaves, 0u);
}

TEST(MeshSmoothing, PlaceAndSizeDoNotMatter) {
  TestMesh sphere = sphereMesh(16);
  addNoise(0.01, sphere);
  const SmoothedMesh near = smoothed(sphere);
  TestMesh far = sphere;
  const Vector3 middle = {512000.5, 5403000.25, 250};
  for (Vector3& p : far.vertices) p = along(middle, 64, p);
  const SmoothedMesh there = smoothed(far);
  for (std::size_t v = 0; v < near.vertices.size(); ++v) {
    const Vector3 expected = along(middle, 64, near.vertices[v]);
    EXPECT_LT(length(subtract(there.vertices[v], expected)), 1e-4);
  }
}

TEST(MeshSmoothing, ThreadsChangeNothing) {
  TestMesh cube = cubeMesh(20);
  addNoise(0.01, cube);
  MeshSmoothParams params;
  params.fit.threads = 1;
  const SmoothedMesh one = smoothed(cube, params);
  for (const int threads : {2, 5, 0}) {
    params.fit.threads = threads;
    const SmoothedMesh many = smoothed(cube, params);
    EXPECT_EQ(one.vertices, many.vertices);
    EXPECT_EQ(one.face_normals, many.face_normals);
  }
}

TEST(MeshSmoothing, WhatCannotMoveStays) {
  TestMesh sphere = sphereMesh(12);
  addNoise(0.01, sphere);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto bad = static_cast<std::uint32_t>(sphere.vertices.size());
  sphere.vertices.push_back({nan, 0, 0});
  sphere.vertices.push_back({0.5, 0.25, 7});
  const std::uint32_t broken[] = {0, 1, bad}, twice[] = {0, 1, 1}, thin[] = {0, 1};
  sphere.faces.add(broken, 3);
  sphere.faces.add(twice, 3);
  sphere.faces.add(thin, 2);
  MeshSmoothStatistics s;
  const SmoothedMesh made = smoothed(sphere, {}, &s);
  EXPECT_TRUE(std::isnan(made.vertices[bad][0]));
  EXPECT_EQ(made.vertices[bad + 1], (Vector3{0.5, 0.25, 7}));
  EXPECT_EQ(s.faces_left_out, 3u);
  EXPECT_EQ(s.non_finite, 1u);
  EXPECT_EQ(s.isolated, 1u);
  EXPECT_EQ(s.moved, sphere.vertices.size() - 2);
  EXPECT_EQ(made.face_normals.back(), (Vector3{}));
  for (std::size_t v = 0; v < bad; ++v) EXPECT_NEAR(length(made.vertices[v]), 1, 0.05);
}

TEST(MeshSmoothing, FlatFacesWithoutAreaAndBranchesDoNoHarm) {
  TestMesh cube = cubeMesh(10);
  addNoise(0.01, cube);
  // A face along an edge of another has no area; one that stands on an edge makes it branch.
  const auto added = static_cast<std::uint32_t>(cube.vertices.size());
  const IndexRow first = cube.faces[0];
  cube.vertices.push_back(scaled(along(cube.vertices[first[0]], 1, cube.vertices[first[1]]), 0.5));
  cube.vertices.push_back(along(cube.vertices[first[0]], 0.5, {1, 1, 1}));
  const std::uint32_t flat[] = {first[0], first[1], added}, fin[] = {first[0], first[1], added + 1};
  cube.faces.add(flat, 3);
  cube.faces.add(fin, 3);
  MeshSmoothStatistics s;
  const SmoothedMesh made = smoothed(cube, {}, &s);
  EXPECT_EQ(s.nonmanifold_edges, 1u);
  for (const Vector3& p : made.vertices) {
    for (const double x : p) EXPECT_LT(std::abs(x), 1.7);
  }
}

TEST(MeshSmoothing, BadInputIsNamed) {
  const TestMesh cube = cubeMesh(3);
  SmoothedMesh made;
  const auto message = [&](const CloudView& view, const MeshFaces& faces,
                           const MeshSmoothParams& p) {
    made.vertices.resize(2);
    const Error error = smoothMesh(view, faces, p, nullptr, made);
    EXPECT_TRUE(made.vertices.empty());
    return error.message;
  };
  EXPECT_NE(message(cube.view(), {}, {}).find("no faces"), std::string::npos);
  EXPECT_NE(message({}, cube.faces, {}).find("no vertices"), std::string::npos);
  CloudView few = cube.view();
  few.size = 4;
  EXPECT_NE(message(few, cube.faces, {}).find("names vertex"), std::string::npos);
  MeshFaces useless;
  const std::uint32_t twice[] = {0, 1, 1};
  useless.add(twice, 3);
  EXPECT_NE(message(cube.view(), useless, {}).find("none of 1 faces"), std::string::npos);
  MeshSmoothParams params;
  params.fit.degree = 9;
  EXPECT_NE(message(cube.view(), cube.faces, params).find("degree"), std::string::npos);
}

TEST(MeshSmoothing, ATriangleAloneIsNoSurface) {
  TestMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::uint32_t corners[] = {0, 1, 2};
  mesh.faces.add(corners, 3);
  SmoothedMesh made;
  const Error error = smoothMesh(mesh.view(), mesh.faces, {}, nullptr, made);
  EXPECT_EQ(error.code, ErrorCode::kNoSurface);
  EXPECT_TRUE(made.vertices.empty());
}

TEST(MeshSmoothing, StopsWhenAsked) {
  TestMesh cube = cubeMesh(12);
  Progress progress;
  progress.cancel();
  SmoothedMesh made;
  const Error error =
      smoothMesh(cube.view(), cube.faces, {}, nullptr, made, nullptr, nullptr, &progress);
  EXPECT_EQ(error.code, ErrorCode::kCancelled);
  EXPECT_TRUE(made.vertices.empty());
}

}  // namespace

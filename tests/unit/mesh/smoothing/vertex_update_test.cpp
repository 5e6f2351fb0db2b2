// SPDX-License-Identifier: BSD-3-Clause
#include "smoothing_steps.h"

#include <gtest/gtest.h>

#include "support/meshes.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::detail;
using namespace pcl_slim_test;

struct Moved {
  TestMesh mesh;
  MeshTopology topology{mesh.faces, mesh.vertices.size()};
  FaceGeometry true_faces{measureFaces(mesh.vertices, mesh.faces, 1)};
  std::vector<std::uint8_t> held = std::vector<std::uint8_t>(mesh.vertices.size());

  explicit Moved(TestMesh made) : mesh(std::move(made)) {}
  MovingMesh moving() { return {mesh.faces, topology, mesh.vertices, held, 1}; }
  double leastAgreement() const {
    double least = 1;
    const FaceGeometry now = measureFaces(mesh.vertices, mesh.faces, 1);
    for (std::size_t f = 0; f < now.normals.size(); ++f) {
      least = std::min(least, dot(now.normals[f], true_faces.normals[f]));
    }
    return least;
  }
};

TEST(VertexUpdate, FacesTakeTheNormalsGiven) {
  Moved cube(cubeMesh(8));
  addNoise(0.02, cube.mesh);
  const double before = cube.leastAgreement();
  followNormals(cube.true_faces.normals, 50, cube.moving());
  EXPECT_LT(before, 0.99);
  EXPECT_GT(cube.leastAgreement(), 0.999);
}

TEST(VertexUpdate, QuadricsFindEdgesAndCorners) {
  Moved cube(cubeMesh(4));
  const auto places = cube.true_faces.centroids;
  const auto exact = cube.mesh.vertices;
  addNoise(0.02, cube.mesh);
  minimiseQuadrics(places, cube.true_faces.normals, cube.true_faces.areas, 1e-6, cube.moving());
  for (std::size_t v = 0; v < exact.size(); ++v) {
    for (std::size_t a = 0; a < 3; ++a) {
      // On a side of the cube: there the planes fix this coordinate.
      if (std::abs(exact[v][a]) < 1) continue;
      EXPECT_NEAR(cube.mesh.vertices[v][a], exact[v][a], 1e-6);
    }
  }
}

TEST(VertexUpdate, NoFaceTurnsOver) {
  Moved cube(cubeMesh(4));
  // Normals so askew that following them would turn faces over.
  auto normals = cube.true_faces.normals;
  for (std::size_t f = 0; f < normals.size(); f += 3) {
    normals[f] = normalized(along(normals[f], 1.2, normals[(f + 40) % normals.size()]));
  }
  std::vector<std::uint8_t> upright;
  for (std::size_t f = 0; f < normals.size(); ++f) {
    upright.push_back(dot(cube.true_faces.normals[f], normals[f]) > 0.1);
  }
  followNormals(normals, 200, cube.moving());
  const FaceGeometry now = measureFaces(cube.mesh.vertices, cube.mesh.faces, 1);
  for (std::size_t f = 0; f < normals.size(); ++f) {
    EXPECT_TRUE(upright[f] == 0 || dot(now.normals[f], normals[f]) > 0) << f;
  }
}

TEST(VertexUpdate, UnfoldsAFaceTurnedOver) {
  Moved sphere(sphereMesh(6));
  // A vertex drawn far over its neighbours turns some of its faces over.
  const std::uint32_t v = sphere.mesh.faces[20][0];
  sphere.mesh.vertices[v] = normalized(
      along(sphere.mesh.vertices[v], 1.0, sphere.mesh.vertices[sphere.mesh.faces[40][0]]));
  ASSERT_LT(sphere.leastAgreement(), 0);
  unfold(sphere.true_faces.normals, 20, sphere.moving());
  EXPECT_GT(sphere.leastAgreement(), 0);
}

}  // namespace

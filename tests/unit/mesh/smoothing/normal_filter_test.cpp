// SPDX-License-Identifier: BSD-3-Clause
#include "smoothing_steps.h"

#include <gtest/gtest.h>

#include "support/meshes.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::detail;
using pcl_slim_test::cubeMesh;

TEST(NormalFilter, KeepsFacesOfACubeApart) {
  const auto mesh = cubeMesh(6);
  const MeshTopology topology(mesh.faces, mesh.vertices.size());
  const FaceGeometry geometry = measureFaces(mesh.vertices, mesh.faces, 1);
  const auto sharp =
      filterNormals({geometry, topology, 0.15, 1}, geometry.normals, geometry.normals);
  const auto blunt =
      filterNormals({geometry, topology, 2.0, 1}, geometry.normals, geometry.normals);
  double sharp_least = 1, blunt_least = 1;
  for (std::size_t f = 0; f < sharp.size(); ++f) {
    sharp_least = std::min(sharp_least, dot(sharp[f], geometry.normals[f]));
    blunt_least = std::min(blunt_least, dot(blunt[f], geometry.normals[f]));
  }
  EXPECT_GT(sharp_least, 1 - 1e-12);
  EXPECT_LT(blunt_least, 0.9);
}

TEST(NormalFilter, MendsALoneNormalAndNoOther) {
  const auto mesh = cubeMesh(6);
  const MeshTopology topology(mesh.faces, mesh.vertices.size());
  const FaceGeometry geometry = measureFaces(mesh.vertices, mesh.faces, 1);
  // A face amid a side, not at an edge of the cube.
  const std::size_t lone = 2 * (6 * 2 + 2);
  auto normals = geometry.normals;
  normals[lone] = scaled(normals[lone], -1);
  mendLoneNormals({geometry, topology, 0.15, 1}, normals);
  for (std::size_t f = 0; f < normals.size(); ++f) {
    EXPECT_GT(dot(normals[f], geometry.normals[f]), 1 - 1e-12) << f;
  }
}

TEST(FaceGeometry, SharpShareTellsCubesFromSpheres) {
  const auto cube = cubeMesh(8), sphere = pcl_slim_test::sphereMesh(8);
  const auto share = [](const pcl_slim_test::TestMesh& mesh) {
    const MeshTopology topology(mesh.faces, mesh.vertices.size());
    return sharpShare(measureFaces(mesh.vertices, mesh.faces, 1).normals, topology);
  };
  EXPECT_DOUBLE_EQ(share(cube), 1);
  EXPECT_DOUBLE_EQ(share(sphere), 0);
}

}  // namespace

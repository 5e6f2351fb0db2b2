// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <map>
#include <random>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/mesh/mesh_faces.h"

namespace pcl_slim_test {

struct TestMesh {
  std::vector<pcl_slim::Vector3> vertices;
  pcl_slim::MeshFaces faces;

  pcl_slim::CloudView view() const {
    pcl_slim::CloudView made;
    made.xyz = vertices.data();
    made.xyz_stride = sizeof(pcl_slim::Vector3);
    made.scalar = pcl_slim::CloudView::Scalar::kDouble;
    made.size = vertices.size();
    return made;
  }
};

/** The cube [-1, 1]^3 with n x n cells a side, outward triangles or squares. */
inline TestMesh cubeMesh(int n, bool squares = false) {
  TestMesh mesh;
  std::map<std::vector<int>, std::uint32_t> known;
  const auto vertex = [&](int side, int u, int v) {
    std::vector<int> at(3);
    const std::size_t axis = static_cast<std::size_t>(side) / 2;
    at[axis] = side % 2 == 0 ? n : 0;
    // The two others in the order that makes their cross product point outwards.
    at[(axis + 1) % 3] = side % 2 == 0 ? u : v;
    at[(axis + 2) % 3] = side % 2 == 0 ? v : u;
    const auto [found, added] = known.emplace(at, mesh.vertices.size());
    if (added)
      mesh.vertices.push_back({2.0 * at[0] / n - 1, 2.0 * at[1] / n - 1, 2.0 * at[2] / n - 1});
    return found->second;
  };
  for (int side = 0; side < 6; ++side) {
    for (int u = 0; u < n; ++u) {
      for (int v = 0; v < n; ++v) {
        const std::uint32_t q[4] = {vertex(side, u, v), vertex(side, u + 1, v),
                                    vertex(side, u + 1, v + 1), vertex(side, u, v + 1)};
        const std::uint32_t second[3] = {q[0], q[2], q[3]};
        mesh.faces.add(q, squares ? 4 : 3);
        if (!squares) mesh.faces.add(second, 3);
      }
    }
  }
  return mesh;
}

/** The cube's mesh on the unit sphere. */
inline TestMesh sphereMesh(int n, bool squares = false) {
  TestMesh mesh = cubeMesh(n, squares);
  for (auto& p : mesh.vertices) {
    for (double& x : p) x = std::tan(x * M_PI / 4);
    p = pcl_slim::normalized(p);
  }
  return mesh;
}

inline void addNoise(double deviation, TestMesh& mesh, unsigned int seed = 5) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, deviation);
  for (auto& p : mesh.vertices) {
    for (double& x : p) x += normal(random);
  }
}

}  // namespace pcl_slim_test

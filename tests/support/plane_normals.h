// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Eigenvalues>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/knn.h"
#include "support/clouds.h"

namespace pcl_slim_test {

/** The cloud with normals of planes through each point's k neighbours, as PCL estimates them. */
inline Cloud withPlaneNormals(const Cloud& cloud, std::size_t k) {
  const pcl_slim::PointStore store = storeOf(cloud);
  pcl_slim::NeighborSearch search(store);
  std::vector<std::uint32_t> neighbors;
  std::vector<float> distances_sq;
  Cloud made;
  for (std::size_t i = 0; i < store.size(); ++i) {
    search.nearest(i, k, neighbors, distances_sq);
    Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(neighbors.size()));
    for (std::size_t j = 0; j < neighbors.size(); ++j) {
      const auto p = store.position(neighbors[j]);
      points.col(static_cast<Eigen::Index>(j)) << p[0], p[1], p[2];
    }
    const Eigen::Matrix3Xd centered = points.colwise() - points.rowwise().mean();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(centered * centered.transpose());
    const Eigen::Vector3d own(store.normal(i)[0], store.normal(i)[1], store.normal(i)[2]);
    Eigen::Vector3d n = axes.eigenvectors().col(0);
    if (n.dot(own) < 0) n = -n;
    const auto p = store.position(i);
    made.add(p, {n[0], n[1], n[2]});
  }
  return made;
}

}  // namespace pcl_slim_test

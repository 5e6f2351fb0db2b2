// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include "disc/splat_builder.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

Eigen::Vector3d
positionOf(const PointStore& store, std::size_t i)
{
  const auto p = store.position(i);
  return {p[0], p[1], p[2]};
}

Eigen::Vector3d
normalOf(const PointStore& store, const std::vector<std::uint32_t>& near)
{
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::uint32_t j : near) mean += positionOf(store, j);
  mean /= static_cast<double>(near.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const std::uint32_t j : near) {
    const Eigen::Vector3d d = positionOf(store, j) - mean;
    covariance += d * d.transpose();
  }
  // The closed form wants entries near one.
  const double largest = covariance.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) return Eigen::Vector3d::UnitZ();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance / largest);
  return solver.eigenvectors().col(0);
}

}  // namespace

std::vector<float>
estimateNormals(const PointStore& store, const CloudView& cloud, int neighbors,
                const double viewpoint[3], int threads)
{
  threads = resolveThreads(threads);
  Eigen::Vector3d eye;
  for (int a = 0; a < 3; ++a) {
    eye[a] = (viewpoint[a] - store.origin()[static_cast<std::size_t>(a)]) / store.scale();
  }
  std::vector<float> of_store(3 * store.size());
  std::vector<NeighborSearch> searches(static_cast<std::size_t>(threads), NeighborSearch(store));
  const auto k = static_cast<std::size_t>(neighbors);
  parallelFor(store.size(), threads, 1024, [&](std::size_t i, int thread) {
    thread_local std::vector<std::uint32_t> near;
    thread_local std::vector<float> distances_sq;
    searches[static_cast<std::size_t>(thread)].nearest(i, k, near, distances_sq);
    Eigen::Vector3d n = normalOf(store, near);
    if (store.hasSensors()) {
      const auto own = store.sensor(i);
      if (n.dot(Eigen::Vector3d(own[0], own[1], own[2]) - positionOf(store, i)) < 0.0) n = -n;
    } else if (n.dot(eye - positionOf(store, i)) < 0.0) {
      n = -n;
    }
    for (int a = 0; a < 3; ++a)
      of_store[3 * i + static_cast<std::size_t>(a)] = static_cast<float>(n[a]);
  });
  const auto stored = store.storeOfInput();
  std::vector<float> normals(3 * cloud.size, 0.0f);
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (stored[i] == PointStore::kSkipped) continue;
    const std::size_t input = cloud.inputIndex(i);
    for (std::size_t a = 0; a < 3; ++a)
      normals[3 * input + a] = of_store[3 * std::size_t{stored[i]} + a];
  }
  return normals;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "fit/nanoflann_unit.h"

#include <Eigen/Eigenvalues>
#include <nanoflann.hpp>

#include "fit/float_cloud.h"
#include "support/lab/bench.h"
#include "support/lab/scenes.h"

namespace pcl_slim::measure {

namespace {

constexpr std::size_t kNeighbors = 10, kPointsPerLeaf = 10;

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, FloatCloud>,
                                                 FloatCloud, 3>;

float smallestEigenvalue(const std::vector<float>& xyz, const std::uint32_t* index,
                         std::size_t count) {
  Eigen::Matrix<float, 3, Eigen::Dynamic, 0, 3, kNeighbors> patch(3, count);
  for (std::size_t j = 0; j < count; ++j) {
    patch.col(static_cast<Eigen::Index>(j)) = Eigen::Vector3f::Map(&xyz[3 * index[j]]);
  }
  patch.colwise() -= Eigen::Vector3f(patch.rowwise().mean());
  const Eigen::Matrix3f covariance = patch * patch.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> axes;
  axes.computeDirect(covariance, Eigen::EigenvaluesOnly);
  return axes.eigenvalues()[0];
}

}  // namespace

double measureUnit(const std::vector<float>& xyz) {
  const double start = cpuSeconds();
  const FloatCloud cloud{xyz};
  Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(kPointsPerLeaf));
  tree.buildIndex();
  volatile float sum = 0;  // the compiler may not drop the work
  for (std::size_t i = 0; i < xyz.size() / 3; ++i) {
    std::uint32_t index[kNeighbors];
    float distance_sq[kNeighbors];
    const std::size_t found = tree.knnSearch(&xyz[3 * i], kNeighbors, index, distance_sq);
    sum = sum + smallestEigenvalue(xyz, index, found);
  }
  return cpuSeconds() - start;
}

}  // namespace pcl_slim::measure

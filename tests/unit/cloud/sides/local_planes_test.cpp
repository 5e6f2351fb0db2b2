// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/detail/sides.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "pcl_slim/cloud/knn.h"
#include "support/clouds.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

PointStore noisyStore(std::size_t points) {
  std::mt19937_64 rng(3);
  std::normal_distribution<double> gauss(0, 1);
  Cloud cloud;
  for (std::size_t i = 0; i < points; ++i) {
    const double x = gauss(rng), y = gauss(rng), z = 0.2 * gauss(rng);
    cloud.add(x, y, z);
  }
  return storeOf(cloud);
}

Eigen::Vector3d placeOf(const PointStore& store, std::size_t i) {
  const auto p = store.position(i);
  return {p[0], p[1], p[2]};
}

TEST(LocalPlanes, FeetAreThoseOfAllPairs) {
  const PointStore store = noisyStore(600);
  constexpr std::size_t kNear = 24;
  const auto feet = detail::feetOnLocalPlanes(store, kNear, 2);
  for (std::size_t i = 0; i < store.size(); ++i) {
    const Eigen::Vector3d at = placeOf(store, i);
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t j = 0; j < store.size(); ++j)
      near.emplace_back((placeOf(store, j) - at).squaredNorm(), j);
    std::nth_element(near.begin(), near.begin() + kNear, near.end());
    Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(kNear));
    for (std::size_t k = 0; k < kNear; ++k)
      points.col(static_cast<Eigen::Index>(k)) = placeOf(store, near[k].second);
    const Eigen::Vector3d mean = points.rowwise().mean();
    points.colwise() -= mean;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(points * points.transpose());
    const Eigen::Vector3d normal = axes.eigenvectors().col(0);
    const Eigen::Vector3d foot = at - normal * normal.dot(at - mean);
    for (std::size_t a = 0; a < 3; ++a)
      ASSERT_NEAR(feet[i][a], foot[static_cast<Eigen::Index>(a)], 1e-6);
  }
}

TEST(LocalPlanes, AStoreOfMovedPointsAnswersForTheirNewPlaces) {
  PointStore store = noisyStore(3000);
  const PointStore before = store;
  const auto feet = detail::feetOnLocalPlanes(store, 32, 1);
  store.moveTo(feet, 2);
  double drift = 0;
  for (std::size_t i = 0; i < store.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) ASSERT_NEAR(store.position(i)[a], feet[i][a], 1e-7);
    const Eigen::Vector3d way = placeOf(store, i) - placeOf(before, i);
    drift = std::max(drift, way.norm());
  }
  EXPECT_NEAR(store.drift(), drift, 1e-6);
  EXPECT_EQ(store.orderOfStore(), before.orderOfStore());
  PointStore again = store;
  std::vector<std::array<double, 3>> back;
  for (std::size_t i = 0; i < before.size(); ++i) back.push_back(before.position(i));
  again.moveTo(back, 1);
  EXPECT_NEAR(again.drift(), 2 * drift, 1e-6);  // of both ways
  NeighborSearch search(store);
  std::vector<std::uint32_t> neighbors;
  std::vector<float> squares;
  for (std::size_t i = 0; i < store.size(); i += 37) {
    search.nearest(i, 9, neighbors, squares);
    std::vector<double> all;
    for (std::size_t j = 0; j < store.size(); ++j)
      all.push_back((placeOf(store, j) - placeOf(store, i)).squaredNorm());
    std::sort(all.begin(), all.end());
    for (std::size_t k = 0; k < 9; ++k)
      ASSERT_NEAR(squares[k], all[k], 3e-6 * all[k] + 2e-7 * std::sqrt(all[k]));
  }
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/knn.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "pcl_slim/cloud/detail/block_kernels.h"
#include "support/clouds.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

/** What float offsets within a block, up to half the box long, may change in a squared distance. */
double slack(double distance_sq) {
  return 3e-6 * distance_sq + 2e-7 * std::sqrt(distance_sq) + 1e-14;
}

/** Compares every step-th query among every stride-th point with sorted distances of all pairs. */
void expectBruteForce(const PointStore& store, std::size_t k, std::size_t step,
                      std::size_t stride = 1) {
  NeighborSearch search(store, stride);
  std::vector<std::uint32_t> neighbors;
  std::vector<float> distances_sq;
  std::vector<double> all;
  for (std::size_t i = 0; i < store.size(); i += step) {
    search.nearest(i, k, neighbors, distances_sq);
    const auto p = store.position(i);
    all.clear();
    for (std::size_t j = 0; j < store.size(); j += stride) {
      const auto q = store.position(j);
      all.push_back(std::pow(p[0] - q[0], 2) + std::pow(p[1] - q[1], 2) + std::pow(p[2] - q[2], 2));
    }
    const std::size_t expected = std::min(k, all.size());
    ASSERT_EQ(neighbors.size(), expected);
    ASSERT_EQ(distances_sq.size(), expected);
    for (std::size_t j = 0; j < expected; ++j) {
      ASSERT_EQ(neighbors[j] % stride, 0u);
      const double distance_sq = all[neighbors[j] / stride];
      ASSERT_NEAR(distances_sq[j], distance_sq, slack(distance_sq));
      if (j == 0) continue;
      ASSERT_LE(distances_sq[j - 1], distances_sq[j]);
      const bool tie = distances_sq[j - 1] == distances_sq[j];
      ASSERT_TRUE(!tie || neighbors[j - 1] < neighbors[j]);
    }
    ASSERT_EQ(std::set<std::uint32_t>(neighbors.begin(), neighbors.end()).size(), expected);
    std::vector<std::uint32_t> set, sorted = neighbors;
    ASSERT_EQ(search.nearestSet(i, k, set), distances_sq.back());
    std::sort(sorted.begin(), sorted.end());
    ASSERT_EQ(set, sorted);
    // Whatever distance is expected, too little or too much, the points are the same.
    for (const float factor : {0.5f, 1.0f, 1.4f, 30.0f}) {
      const float about = factor * distances_sq.back();
      ASSERT_EQ(search.nearestSet(i, k, set, about), distances_sq.back());
      ASSERT_EQ(set, sorted);
      std::vector<std::uint32_t> same;
      std::vector<float> same_sq;
      search.nearest(i, k, same, same_sq, about);
      ASSERT_EQ(same, neighbors);
      ASSERT_EQ(same_sq, distances_sq);
    }
    if (i % stride == 0) {
      ASSERT_EQ(neighbors.front(), i);
    }
    std::sort(all.begin(), all.end());
    for (std::size_t j = 0; j < expected; ++j) {
      ASSERT_NEAR(distances_sq[j], all[j], slack(all[j])) << "point " << i << " rank " << j;
    }
  }
}

TEST(KthSmallest, IsWhatSortingFinds) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> exponent(-30, 5);
  for (const std::size_t n : {1u, 2u, 7u, 8u, 9u, 31u, 700u}) {
    std::vector<float> values(n);
    for (float& value : values) value = std::exp(exponent(random));
    if (n > 20) std::fill_n(values.begin(), 10, values[15]);  // ties
    values[n / 2] = 0;
    std::vector<float> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t k = 1; k <= n; ++k)
      ASSERT_EQ(detail::kernels::kthSmallest(values.data(), n, k), sorted[k - 1]) << n << " " << k;
  }
  std::vector<float> even(3000);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (float& value : even) value = uniform(random);
  std::vector<float> sorted = even;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t k = 1; k <= even.size(); k += 13)
    ASSERT_EQ(detail::kernels::kthSmallest(even.data(), even.size(), k), sorted[k - 1]) << k;
}

TEST(NeighborSearch, OnASurface) {
  const PointStore store =
      storeOf(pcl_slim_test::sceneCloud(measure::Shape::kTorus, 3000, 0.002).withoutNormals());
  for (const std::size_t k : {1, 2, 10, 16, 17, 100}) expectBruteForce(store, k, 17);
}

TEST(NeighborSearch, AmongSomeOfThePoints) {
  const PointStore store =
      storeOf(pcl_slim_test::sceneCloud(measure::Shape::kTorus, 3001, 0.01).withoutNormals());
  for (const std::size_t stride : {2, 3, 16, 64}) {
    for (const std::size_t k : {1, 17, 40, 2000}) expectBruteForce(store, k, 16, stride);
  }
}

TEST(NeighborSearch, OnALineAndOnAGridWithTies) {
  Cloud line, grid;
  for (int i = 0; i < 700; ++i) line.add(3.0 * i, -2.0 * i, 0.5 * i);
  for (int x = 0; x < 27; ++x) {
    for (int y = 0; y < 27; ++y) grid.add(0.125 * x, 0.125 * y, 0.0);
  }
  for (const std::size_t k : {1, 5, 20}) {
    expectBruteForce(storeOf(line), k, 7);
    expectBruteForce(storeOf(grid), k, 7);
  }
}

TEST(NeighborSearch, BetweenClustersFarApart) {
  Cloud cloud;
  std::mt19937_64 random(21);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 600; ++i) {
    const double shift = i % 2 == 0 ? 0.0 : 1e5;
    cloud.add(shift + normal(random), normal(random), normal(random));
  }
  // More than a cluster has, so that the answer spans both.
  for (const std::size_t k : {8, 299, 310, 600}) expectBruteForce(storeOf(cloud), k, 41);
}

TEST(NeighborSearch, AmongMergedCopiesAndTooFewPoints) {
  Cloud few, copies;
  for (int i = 0; i < 5; ++i) few.add(i, i * i, 1.0);
  std::mt19937_64 random(22);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int i = 0; i < 200; ++i) {
    const double x = u(random), y = u(random), z = u(random);
    for (int copy = 0; copy < 4; ++copy) copies.add(x, y, z);
  }
  for (const std::size_t k : {1, 4, 5, 20}) expectBruteForce(storeOf(few), k, 1);
  const PointStore store = storeOf(copies);
  ASSERT_EQ(store.size(), 200u);
  expectBruteForce(store, 10, 1);
}

TEST(NeighborSearch, OfOnePointAndOfNone) {
  Cloud cloud;
  cloud.add(1.0, 2.0, 3.0);
  expectBruteForce(storeOf(cloud), 5, 1);
  const PointStore store = storeOf(pcl_slim_test::sceneCloud(measure::Shape::kSphere, 100, 0.0));
  NeighborSearch search(store);
  std::vector<std::uint32_t> neighbors = {3};
  std::vector<float> distances_sq = {3.0f};
  search.nearest(50, 0, neighbors, distances_sq);
  EXPECT_TRUE(neighbors.empty());
  EXPECT_TRUE(distances_sq.empty());
}

}  // namespace
}  // namespace pcl_slim

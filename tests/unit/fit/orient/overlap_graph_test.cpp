// SPDX-License-Identifier: BSD-3-Clause
// Edges between overlapping leaves against all pairs.
#include "orient.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "support/clouds.h"

namespace pcl_slim {

using namespace detail;

namespace {

using measure::Shape;

/** Each leaf's eight nearest on every level up to its own, within .9 (r + r'). */
std::set<std::pair<std::uint32_t, std::uint32_t>> edgesOfAllPairs(
    const SLIMSurface& s, const std::vector<std::uint32_t>& leaves) {
  std::map<int, float> widest;
  for (const std::uint32_t i : leaves) {
    widest[s.level[i]] = std::max(widest[s.level[i]], s.radius[i]);
  }
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const std::uint32_t i : leaves) {
    std::map<int, std::vector<std::pair<float, std::uint32_t>>> near;
    for (const std::uint32_t j : leaves) {
      if (s.level[j] > s.level[i] || (s.level[j] == s.level[i] && j >= i)) continue;
      if (s.radius[i] > 2.0f * widest[s.level[j]]) continue;
      const float ex = s.cx[j] - s.cx[i], ey = s.cy[j] - s.cy[i], ez = s.cz[j] - s.cz[i];
      const float distance_sq = ex * ex + ey * ey + ez * ez;
      const double reach = 0.9 * (s.radius[i] + s.radius[j]);
      if (distance_sq < reach * reach) near[s.level[j]].emplace_back(distance_sq, j);
    }
    for (auto& [level, list] : near) {
      std::sort(list.begin(), list.end());
      if (list.size() > 8) list.resize(8);
      for (const auto& [distance_sq, j] : list) edges.emplace(j, i);
    }
  }
  return edges;
}

TEST(OverlapGraph, HoldsTheNearestOfAllPairsOnEachLevel) {
  for (const double noise : {0.0, 0.002}) {
    const auto cloud = pcl_slim_test::sceneCloud(Shape::kRelief, 20000, noise).withoutNormals();
    const SLIMSurface surface = pcl_slim_test::fitted(cloud).surface;
    const auto leaves = surface.leaves();
    const auto expected = edgesOfAllPairs(surface, leaves);
    for (const int threads : {1, 3}) {
      std::set<std::pair<std::uint32_t, std::uint32_t>> found;
      std::size_t count = 0, opposed = 0;
      for (const auto& list : overlapGraph(surface, leaves, threads)) {
        for (const OverlapEdge& edge : list) {
          found.emplace(edge.a, edge.b);
          ++count;
          opposed += edge.opposed && edge.weight < 0.1f;
          EXPECT_GE(edge.weight, -1e-6f);
          EXPECT_LT(edge.weight, 2.5f);
        }
      }
      EXPECT_EQ(found, expected);
      EXPECT_EQ(found.size(), count);
      EXPECT_EQ(opposed, 0u);  // the fit has given sides by these very edges
    }
  }
}

TEST(OverlapGraph, AFlippedLeafOpposesItsNeighboursAtTheSameWeight) {
  const auto cloud = pcl_slim_test::sceneCloud(Shape::kSphere, 5000, 0.0).withoutNormals();
  SLIMSurface surface = pcl_slim_test::fitted(cloud).surface;
  const auto leaves = surface.leaves();
  const auto before = overlapGraph(surface, leaves, 1);
  const std::uint32_t turned = leaves[leaves.size() / 2];
  surface.flip(turned);
  const auto after = overlapGraph(surface, leaves, 1);
  ASSERT_EQ(after.size(), before.size());
  std::size_t met = 0;
  for (std::size_t k = 0; k < after.size(); ++k) {
    ASSERT_EQ(after[k].size(), before[k].size());
    for (std::size_t e = 0; e < after[k].size(); ++e) {
      const OverlapEdge& edge = after[k][e];
      const bool of_turned = edge.a == turned || edge.b == turned;
      met += of_turned;
      EXPECT_EQ(edge.opposed, of_turned != before[k][e].opposed);
      EXPECT_NEAR(edge.weight, before[k][e].weight, 1e-5);
    }
  }
  EXPECT_GT(met, 3u);
}

}  // namespace
}  // namespace pcl_slim

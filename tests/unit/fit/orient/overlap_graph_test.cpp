// SPDX-License-Identifier: BSD-3-Clause
// Edges between overlapping leaves against all pairs.
#include "orient.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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
    const auto patches = patchesOf(surface, leaves);
    const auto expected = edgesOfAllPairs(surface, leaves);
    for (const int threads : {1, 3}) {
      std::set<std::pair<std::uint32_t, std::uint32_t>> found;
      const std::vector<SignedEdge> edges = overlapGraph(surface, leaves, patches, threads);
      std::size_t opposed = 0;
      for (const SignedEdge& edge : edges) {
        found.emplace(leaves[edge.a], leaves[edge.b]);
        opposed += edge.agreement < -0.9;
        EXPECT_LE(std::abs(edge.agreement), 1 + 1e-6);
        EXPECT_EQ(edge.agreement, edgeBetween(patches, edge.a, edge.b).agreement);
      }
      EXPECT_EQ(found, expected);
      EXPECT_EQ(found.size(), edges.size());
      EXPECT_EQ(opposed, 0u);  // the fit has given sides by these very edges
    }
  }
}

TEST(OverlapGraph, PatchesAreOnTheSurface) {
  const auto f = pcl_slim_test::fitted(pcl_slim_test::sceneCloud(Shape::kSphere, 5000, 0.0));
  const auto leaves = f.surface.leaves();
  const auto patches = patchesOf(f.surface, leaves);
  ASSERT_EQ(patches.size(), leaves.size());
  for (std::size_t k = 0; k < patches.size(); ++k) {
    const std::uint32_t i = leaves[k];
    // Leaves of a unit sphere follow it to a thousandth; the centres of their balls are off.
    EXPECT_NEAR(measure::truthAt(Shape::kSphere, f.world(patches[k].center)).distance, 0, 1e-3);
    EXPECT_EQ(patches[k].normal, (Vector3{f.surface.nx[i], f.surface.ny[i], f.surface.nz[i]}));
    EXPECT_FLOAT_EQ(static_cast<float>(patches[k].weight),
                    f.surface.radius[i] * f.surface.radius[i]);
  }
}

TEST(OverlapGraph, AFlippedLeafOpposesItsNeighboursAtTheSameWeight) {
  const auto cloud = pcl_slim_test::sceneCloud(Shape::kSphere, 5000, 0.0).withoutNormals();
  SLIMSurface surface = pcl_slim_test::fitted(cloud).surface;
  const auto leaves = surface.leaves();
  const auto before = overlapGraph(surface, leaves, patchesOf(surface, leaves), 1);
  const auto turned = static_cast<std::uint32_t>(leaves.size() / 2);
  surface.flip(leaves[turned]);
  const auto after = overlapGraph(surface, leaves, patchesOf(surface, leaves), 1);
  ASSERT_EQ(after.size(), before.size());
  std::size_t met = 0;
  for (std::size_t e = 0; e < after.size(); ++e) {
    const bool of_turned = after[e].a == turned || after[e].b == turned;
    met += of_turned;
    EXPECT_EQ(after[e].apart, before[e].apart);
    EXPECT_NEAR(after[e].agreement, (of_turned ? -1 : 1) * before[e].agreement, 1e-5);
  }
  EXPECT_GT(met, 3u);
}

}  // namespace
}  // namespace pcl_slim

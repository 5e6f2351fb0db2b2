// SPDX-License-Identifier: BSD-3-Clause
// Links between levels against all pairs.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "support/clouds.h"
#include "support/sphere_surface.h"

namespace pcl_slim {
namespace {

using measure::Shape;

double centerDistanceSq(const SLIMSurface& s, std::size_t a, std::size_t b) {
  return std::pow(double(s.cx[a]) - s.cx[b], 2) + std::pow(double(s.cy[a]) - s.cy[b], 2) +
         std::pow(double(s.cz[a]) - s.cz[b], 2);
}

/** Every pair of surfels that are one level apart, and nothing else, is linked where the parent's
 * ball contains the child's centre; surfels without a parent are roots; the root ball contains all. */
void expectLinks(const SLIMSurface& s) {
  ASSERT_EQ(s.child_begin.size(), s.size() + 1);
  ASSERT_EQ(s.child_begin.front(), 0u);
  ASSERT_EQ(s.child_begin.back(), s.children.size());
  std::vector<char> has_parent(s.size(), 0);
  for (std::size_t i = 0; i < s.size(); ++i) {
    ASSERT_LE(s.child_begin[i], s.child_begin[i + 1]);
    const std::set<std::uint32_t> linked(s.children.begin() + s.child_begin[i],
                                         s.children.begin() + s.child_begin[i + 1]);
    ASSERT_EQ(linked.size(), s.child_begin[i + 1] - s.child_begin[i]);
    for (std::uint32_t j = 0; j < s.size(); ++j) {
      const bool finer = !s.isLeaf(i) && s.level[j] == s.level[i] + 1;
      const double slack = centerDistanceSq(s, i, j) / (double(s.radius[i]) * s.radius[i]) - 1.0;
      if (finer && std::abs(slack) < 1e-5) continue;  // rounding decides
      ASSERT_EQ(linked.count(j), finer && slack < 0 ? 1u : 0u) << i << " -> " << j;
    }
    for (const std::uint32_t j : linked) has_parent[j] = 1;
  }
  std::vector<std::uint32_t> roots;
  for (std::uint32_t i = 0; i < s.size(); ++i) {
    if (!has_parent[i]) roots.push_back(i);
    const auto& ball = s.root_ball;
    const double reach =
        std::hypot(s.cx[i] - ball[0], s.cy[i] - ball[1], s.cz[i] - ball[2]) + s.radius[i];
    ASSERT_LE(reach, ball[3] * (1.0 + 1e-6));
  }
  EXPECT_EQ(s.roots, roots);
}

TEST(Links, OfFittedSurfaces) {
  for (const bool paper : {false, true}) {
    FitParams params;
    params.paper_mode = paper;
    params.degree = paper ? 2 : 4;
    if (paper) params.size = MDLThreshold{0.002};
    const auto f =
        pcl_slim_test::fitted(pcl_slim_test::sceneCloud(Shape::kRelief, 6000, 0.0), params);
    ASSERT_GT(f.statistics.internals, 5u);
    ASSERT_GT(f.surface.numLevels(), 1u);
    expectLinks(f.surface);
  }
}

TEST(Links, OfTwoLevelsByHand) {
  expectLinks(pcl_slim_test::sphereSurface(3, 300));
}

TEST(Links, OfNothingAndOfOne) {
  SLIMSurface s;
  s.buildLinks();
  EXPECT_EQ(s.child_begin.size(), 1u);
  EXPECT_TRUE(s.roots.empty());
  s = pcl_slim_test::sphereSurface(2, 1);
  expectLinks(s);
  EXPECT_EQ(s.roots, std::vector<std::uint32_t>{0});
}

TEST(Links, ReachTheLastLevel) {
  SLIMSurface s = pcl_slim_test::sphereSurface(2, 2);
  s.level = {254, 255};
  s.flags = {0, kSurfelLeaf};
  s.cx[1] = s.cx[0];
  s.cy[1] = s.cy[0];
  s.cz[1] = s.cz[0];
  s.buildLinks();
  expectLinks(s);
  EXPECT_EQ(s.children, std::vector<std::uint32_t>{1});
}

TEST(Links, OfPlacesAndRadiiOutOfTheOrdinary) {
  SLIMSurface s = pcl_slim_test::sphereSurface(2, 60);
  for (std::size_t i = 0; i < s.size(); i += 4) s.cx[i] = i % 8 == 0 ? -3e30f : 1e9f;
  for (std::size_t i = 1; i < s.size(); i += 4) s.radius[i] = 1e-12f;
  s.buildLinks();
  expectLinks(s);
}

TEST(Links, DoNotOutliveTheirSurfels) {
  SLIMSurface s = pcl_slim_test::sphereSurface(3, 200);
  s.buildLinks();
  const auto children = s.children;
  s.buildLinks();
  EXPECT_EQ(s.children, children);
  s.clear();
  EXPECT_TRUE(s.children.empty());
  EXPECT_TRUE(s.roots.empty());
  EXPECT_EQ(s.root_ball[3], 0.0f);
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Sizes that a level of detail is compared with.
#include "pcl_slim/surface/detail/detail_sizes.h"

#include <gtest/gtest.h>

namespace pcl_slim {
namespace {

using detail::DetailSizes;

/** \brief Surfels 0 over 1 and 2, those over the leaves 3 and 4, all about one place but 4, which
 * juts out of 2; surfel 5 has no parent. */
SLIMSurface smallTree() {
  SLIMSurface s;
  s.resize(6);
  s.cx[4] = 0.19f;
  s.nz.assign(6, 1.0f);
  s.degree.assign(6, 1);
  s.level = {1, 2, 2, 3, 3, 2};
  s.radius = {0.25f, 0.2f, 0.2f, 0.18f, 0.1f, 0.3f};
  s.error = {0.001f, 0.004f, 1.0f, 0.5f, 0.5f, 0.01f};
  s.flags = {0, 0, 0, kSurfelLeaf, kSurfelLeaf, 0};
  s.child_begin = {0, 2, 3, 5, 5, 5, 5};
  s.children = {1, 2, 3, 3, 4};
  return s;
}

TEST(DetailSizes, AreTheBallOrTheErrorWhicheverIsSmaller) {
  const DetailSizes sizes(smallTree());
  EXPECT_FLOAT_EQ(sizes.own[1], 0.5f * DetailSizes::kErrors * 0.004f);
  EXPECT_FLOAT_EQ(sizes.own[2], 0.2f);
  EXPECT_FLOAT_EQ(sizes.own[5], 0.5f * DetailSizes::kErrors * 0.01f);
  EXPECT_EQ(sizes.own[3], 0.0f);
}

TEST(DetailSizes, NeverGrowFromASurfelToItsDescendants) {
  const DetailSizes sizes(smallTree());
  EXPECT_FLOAT_EQ(sizes.own[0], 0.2f);  // its own error alone would make it smaller
  EXPECT_FLOAT_EQ(sizes.parent[1], 0.2f);
  EXPECT_FLOAT_EQ(sizes.parent[3], sizes.own[1]);  // the smaller of two parents
  EXPECT_EQ(sizes.parent[4], DetailSizes::kNoParent);
  EXPECT_EQ(sizes.parent[0], DetailSizes::kNoParent);
  EXPECT_EQ(sizes.parent[5], DetailSizes::kNoParent);
}

// Points of a horn end at its side, and the polynomial of a wide ball goes on.
TEST(DetailSizes, CountWhatReachesBeyondTheChildren) {
  SLIMSurface s = smallTree();
  s.radius[3] = 0.1f;  // alone in 1, whose plane is looked at up to .8 of its radius
  EXPECT_FLOAT_EQ(DetailSizes(s).own[1], 0.5f * DetailSizes::kOverhangs * (0.8f * 0.2f - 0.1f));
}

// Leaves alone know where a border runs.
TEST(DetailSizes, OfSurfelsWithABorderAreTheirBalls) {
  SLIMSurface s = smallTree();
  s.trim_begin = {0, 0, 0, 0, 9, 9, 9};
  s.trim_maps.assign(9, 0);
  const DetailSizes sizes(s);
  EXPECT_FLOAT_EQ(sizes.own[0], 0.25f);
  EXPECT_FLOAT_EQ(sizes.own[1], 0.2f);
  EXPECT_FLOAT_EQ(sizes.own[5], 0.5f * DetailSizes::kErrors * 0.01f);
}

TEST(DetailSizes, WithoutLinksNoSurfelHasAParent) {
  SLIMSurface s = smallTree();
  s.child_begin.clear();
  s.children.clear();
  const DetailSizes sizes(s);
  for (const float size : sizes.parent) EXPECT_EQ(size, DetailSizes::kNoParent);
  EXPECT_FLOAT_EQ(sizes.own[0], 0.5f * DetailSizes::kErrors * 0.001f);
}

}  // namespace
}  // namespace pcl_slim

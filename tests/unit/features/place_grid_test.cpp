// SPDX-License-Identifier: BSD-3-Clause
#include "lines/crest_tracer.h"

#include <gtest/gtest.h>

namespace {

using namespace pcl_slim;

TEST(PlaceGrid, FindsTheNearestWithinReach) {
  detail::PlaceGrid grid(0.1);
  const auto any = [](std::int64_t) { return true; };
  EXPECT_EQ(grid.nearest({0, 0, 0}, 1, any), detail::PlaceGrid::kNothing);
  // Many cells, so that the table grows.
  for (int i = 0; i < 2000; ++i) grid.add({0.1 * i, -0.03 * i, 5}, 0.06, i);
  for (int i = 0; i < 2000; i += 7) {
    EXPECT_EQ(grid.nearest({0.1 * i + 0.03, -0.03 * i, 5}, 1, any), i);
    EXPECT_EQ(grid.nearest({0.1 * i + 0.03, -0.03 * i, 5}, 0.4, any), detail::PlaceGrid::kNothing);
    EXPECT_EQ(grid.nearest({0.1 * i, -0.03 * i, 5}, 1, [&](std::int64_t n) { return n != i; }),
              detail::PlaceGrid::kNothing);
  }
  grid.add({0, 0, 5}, 0.06, 4000);
  EXPECT_EQ(grid.nearest({0, 0, 5}, 1, any), 0) << "the first of equals";
  grid.clear();
  EXPECT_FALSE(grid.holds({0, 0, 5}, 1));
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/core/extent.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace pcl_slim {
namespace {

TEST(Extent, OfAnyNumberOfValues) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> value(-1.0f, 1.0f);
  for (std::size_t count = 1; count <= 70; ++count) {
    std::vector<float> values(count);
    for (float& v : values) v = value(random);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const Extent extent = extentOf(values.data(), count);
    EXPECT_EQ(extent.low, *low) << count;
    EXPECT_EQ(extent.high, *high) << count;
  }
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Numbers on the scale of a colour bar: round, inside the range, enough and not too many.
#include "pcl_slim/render/detail/ticks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "pcl_slim/core/random.h"

namespace pcl_slim::detail {
namespace {

using Ticks = std::vector<double>;

std::string textOf(const Ticks& ticks) {
  std::string text;
  for (const double tick : ticks) text += (text.empty() ? "" : " ") + tickText(tick);
  return text;
}

TEST(RoundTicks, OfRangesAsPicturesHaveThem) {
  EXPECT_EQ(textOf(roundTicks(-94.9, 94.9, false)), "-50 0 50");
  EXPECT_EQ(textOf(roundTicks(-9.02e4, 9.02e4, false)), "-50000 0 50000");
  EXPECT_EQ(textOf(roundTicks(-0.0231, 0.0231, false)), "-0.02 -0.01 0 0.01 0.02");
  EXPECT_EQ(textOf(roundTicks(0.0, 3.4e-4, false)), "0 1e-4 2e-4 3e-4");
  EXPECT_EQ(textOf(roundTicks(0.0, 1.0, false)), "0 0.2 0.4 0.6 0.8 1");
  EXPECT_EQ(textOf(roundTicks(-3e6, 3e6, false)), "-2e6 0 2e6");
  EXPECT_EQ(textOf(roundTicks(0.012, 0.2, true)), "0.02 0.05 0.1 0.2");
  EXPECT_EQ(textOf(roundTicks(0.3, 4000.0, true)), "1 10 100 1000");
  EXPECT_EQ(textOf(roundTicks(1.01, 999.0, true)), "5 10 50 100 500");
  EXPECT_EQ(textOf(roundTicks(31.0, 47.0, true)), "35 40 45");
  EXPECT_EQ(textOf(roundTicks(1e-6, 1e6, true)), "1e-6 0.001 1 1000 1e6");
}

TEST(RoundTicks, EndsCountInAnyOrder) {
  EXPECT_EQ(roundTicks(0.3, 0.1, false), roundTicks(0.1, 0.3, false));
  EXPECT_EQ(roundTicks(0.1, 0.3, false), (Ticks{0.1, 0.15, 0.2, 0.25, 0.3}));
  EXPECT_EQ(roundTicks(1.0, 100.0, true), (Ticks{1.0, 10.0, 100.0}));
}

TEST(RoundTicks, OfNoRange) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::nan("");
  EXPECT_EQ(roundTicks(2.5, 2.5, false), Ticks{2.5});
  EXPECT_EQ(roundTicks(0.0, 0.0, false), Ticks{0.0});
  EXPECT_EQ(roundTicks(1e9, 1e9 + 1e-6, true), Ticks{1e9});
  for (const bool logarithmic : {false, true}) {
    EXPECT_TRUE(roundTicks(nan, 1.0, logarithmic).empty());
    EXPECT_TRUE(roundTicks(0.0, inf, logarithmic).empty());
    EXPECT_TRUE(roundTicks(-1e308, 1.7e308, logarithmic).empty());
  }
  EXPECT_TRUE(roundTicks(0.0, 1.0, true).empty());
  EXPECT_TRUE(roundTicks(-1.0, 1.0, true).empty());
}

/** Significant digits that a number has, by its shortest text. */
int digitsOf(double value) {
  char text[32];
  for (int digits = 1; digits < 17; ++digits) {
    std::snprintf(text, sizeof(text), "%.*e", digits - 1, value);
    if (std::stod(text) == value) return digits;
  }
  return 17;
}

TEST(RoundTicks, OfAnyRange) {
  SplitMix random{7};
  for (int i = 0; i < 20000; ++i) {
    const double size = std::pow(10.0, 12.0 * random.nextShare() - 6.0);
    const double low = size * (random.nextShare() - 0.5), high = low + size * random.nextShare();
    SCOPED_TRACE(std::to_string(low) + " " + std::to_string(high));
    const Ticks ticks = roundTicks(low, high, false);
    ASSERT_GE(ticks.size(), 3u);
    ASSERT_LE(ticks.size(), 7u);
    const double step = ticks[1] - ticks[0], slack = 2e-9 * (high - low);
    // 1, 2 or 5 times a power of ten.
    const double m = step / std::pow(10.0, std::floor(std::log10(step * (1.0 + 1e-6))));
    EXPECT_NEAR(std::min({std::abs(m - 1.0), std::abs(m - 2.0), std::abs(m - 5.0)}), 0.0, 1e-6);
    for (std::size_t k = 0; k < ticks.size(); ++k) {
      EXPECT_GE(ticks[k], low - slack);
      EXPECT_LE(ticks[k], high + slack);
      EXPECT_NEAR(ticks[k], ticks[0] + static_cast<double>(k) * step, slack);
    }
    // Nothing between the outermost ticks and the ends would take another one.
    EXPECT_LT(ticks.front() - low, step * (1.0 + 1e-6));
    EXPECT_LT(high - ticks.back(), step * (1.0 + 1e-6));
  }
}

TEST(RoundTicks, OfAnyRangeByTheLogarithm) {
  SplitMix random{8};
  for (int i = 0; i < 20000; ++i) {
    const double low = std::pow(10.0, 12.0 * random.nextShare() - 6.0);
    const double high = low * std::pow(10.0, 0.01 + 8.0 * random.nextShare());
    SCOPED_TRACE(std::to_string(low) + " " + std::to_string(high));
    const Ticks ticks = roundTicks(low, high, true);
    ASSERT_GE(ticks.size(), 3u);
    ASSERT_LE(ticks.size(), high < 10.0 * low ? 7u : 6u);
    for (std::size_t k = 0; k < ticks.size(); ++k) {
      EXPECT_GE(ticks[k], low * (1.0 - 1e-8));
      EXPECT_LE(ticks[k], high * (1.0 + 1e-8));
      if (high > 10.0 * low) {
        EXPECT_EQ(digitsOf(ticks[k]), 1);
      }
      EXPECT_TRUE(k == 0 || ticks[k] > ticks[k - 1]);
    }
  }
}

TEST(TickText, IsShort) {
  EXPECT_EQ(tickText(0.0), "0");
  EXPECT_EQ(tickText(-0.05), "-0.05");
  EXPECT_EQ(tickText(0.001), "0.001");
  EXPECT_EQ(tickText(0.0005), "5e-4");
  EXPECT_EQ(tickText(20000.0), "20000");
  EXPECT_EQ(tickText(2e5), "2e5");
  EXPECT_EQ(tickText(-1.5e7), "-1.5e7");
  EXPECT_EQ(tickText(1e-12), "1e-12");
}

}  // namespace
}  // namespace pcl_slim::detail

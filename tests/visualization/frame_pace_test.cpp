// SPDX-License-Identifier: BSD-3-Clause
#include "frame/frame_pace.h"

#include <gtest/gtest.h>

namespace pcl_slim::detail {
namespace {

constexpr std::size_t kPixels = 1000000;

FramePace
paceOf(std::initializer_list<double> seconds)
{
  FramePace pace;
  for (const double s : seconds) pace.add(s, kPixels);
  return pace;
}

TEST(FramePace, TheFastestFrameCountsAndSmallOnesDoNot)
{
  FramePace pace = paceOf({0.9, 0.02});
  EXPECT_FALSE(pace.isKnown());
  pace.add(1e-9, 1);
  EXPECT_FALSE(pace.isKnown());
  pace.add(0.03, kPixels);
  EXPECT_TRUE(pace.isKnown());
  EXPECT_DOUBLE_EQ(pace.secondsPerPixel(), 2e-8);
}

TEST(FramePace, ACardIsKeptWhileItIsFastOrUnknown)
{
  EXPECT_TRUE(prefersCard({}, {}));
  EXPECT_TRUE(prefersCard(paceOf({0.9, 0.9}), {}));
  EXPECT_TRUE(prefersCard(paceOf({0.9, 0.003, 0.004}), paceOf({0.001, 0.001, 0.001})));
}

TEST(FramePace, ASlowCardIsComparedWithTheCpu)
{
  const FramePace slow = paceOf({0.9, 0.05, 0.05});
  EXPECT_FALSE(prefersCard(slow, {})) << "the CPU's pace is to be found out";
  EXPECT_FALSE(prefersCard(slow, paceOf({0.9, 0.06})));
  EXPECT_FALSE(prefersCard(slow, paceOf({0.9, 0.02, 0.03})));
  EXPECT_TRUE(prefersCard(slow, paceOf({0.9, 0.06, 0.07})));
}

}  // namespace
}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "frame/frame.h"

#include <gtest/gtest.h>

namespace pcl_slim::detail {
namespace {

constexpr std::size_t kPixels = 1000000;

void add(FramePace& pace, std::initializer_list<double> seconds) {
  for (const double s : seconds) pace.add(s, kPixels);
}

void add(BackendChoice& choice, bool on_card, std::initializer_list<double> seconds) {
  for (const double s : seconds) choice.add(on_card, {}, s, kPixels);
}

TEST(FramePace, TheFastestOfTheLastThreeFramesCountsAndSmallOnesDoNot) {
  FramePace pace;
  add(pace, {0.9, 0.02});
  EXPECT_FALSE(pace.isKnown());
  pace.add(1e-9, 1);
  EXPECT_FALSE(pace.isKnown());
  add(pace, {0.03});
  EXPECT_TRUE(pace.isKnown());
  EXPECT_DOUBLE_EQ(pace.secondsPerPixel(), 2e-8);
  add(pace, {0.04, 0.05});
  EXPECT_DOUBLE_EQ(pace.secondsPerPixel(), 3e-8);
}

TEST(BackendChoice, ACardIsKeptWhileItIsFastOrUnknown) {
  BackendChoice choice;
  EXPECT_TRUE(choice.prefersCard());
  add(choice, true, {0.9, 0.9});
  EXPECT_TRUE(choice.prefersCard());
  add(choice, true, {0.003});
  add(choice, false, {0.001, 0.001, 0.001});
  EXPECT_TRUE(choice.prefersCard());
}

TEST(BackendChoice, ASlowCardIsComparedWithTheCpu) {
  BackendChoice choice;
  add(choice, true, {0.9, 0.05, 0.05});
  EXPECT_FALSE(choice.prefersCard()) << "the CPU's pace is to be found out";
  add(choice, false, {0.9, 0.06});
  EXPECT_FALSE(choice.prefersCard());
  BackendChoice slow_cpu = choice;
  add(slow_cpu, false, {0.07});
  EXPECT_TRUE(slow_cpu.prefersCard());
  add(choice, false, {0.02});
  EXPECT_FALSE(choice.prefersCard());
}

TEST(BackendChoice, ACardThatSlowsDownAsTheCameraComesNearerIsComparedThen) {
  BackendChoice choice;
  add(choice, true, {0.9, 0.004, 0.004});
  EXPECT_TRUE(choice.prefersCard());
  add(choice, true, {0.05, 0.05, 0.05});
  EXPECT_FALSE(choice.prefersCard());
  add(choice, false, {0.02, 0.02, 0.02});
  EXPECT_FALSE(choice.prefersCard());
}

TEST(BackendChoice, FramesThatAreCutOpenOrInHasteDoNotCount) {
  BackendChoice choice;
  add(choice, true, {0.05, 0.05, 0.05});
  FrameRequest cut, hasty;
  cut.clip_planes.resize(1);
  hasty.close_gaps = false;
  for (int i = 0; i < 3; ++i) {
    choice.add(false, cut, 0.09, kPixels);
    choice.add(false, hasty, 0.09, kPixels);
  }
  EXPECT_FALSE(choice.prefersCard()) << "the CPU's pace is still to be found out";
  add(choice, false, {0.06, 0.06, 0.06});
  EXPECT_TRUE(choice.prefersCard());
}

TEST(BackendChoice, OnceSettledItChangesForWhatIsMuchFasterAlone) {
  BackendChoice choice;
  add(choice, true, {0.050, 0.050, 0.050});
  EXPECT_FALSE(choice.prefersCard());
  add(choice, false, {0.053, 0.053, 0.053});
  EXPECT_TRUE(choice.prefersCard());
  add(choice, true, {0.065, 0.065, 0.065});
  EXPECT_TRUE(choice.prefersCard());
  add(choice, true, {0.075, 0.075, 0.075});
  EXPECT_FALSE(choice.prefersCard());
  add(choice, false, {0.090, 0.090, 0.090});
  EXPECT_FALSE(choice.prefersCard());
  add(choice, false, {0.110, 0.110, 0.110});
  EXPECT_TRUE(choice.prefersCard());
}

}  // namespace
}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
// What a radius costs.
#include "fit_plan.h"

#include <gtest/gtest.h>

#include "support/balls.h"

namespace pcl_slim {

using namespace detail;
using pcl_slim_test::TestBall;
using pcl_slim_test::wavyBall;

namespace {

/** Weights fall with height, by each kernel differently: the energy must not depend on which one.
 */
TEST(Energy, ShowsTheVarianceOfNoiseInAThinBallWhateverTheKernel) {
  constexpr double kThickness = 0.15;  // of the radius
  const Energy energy;                 // no noise known, no penalty: the corrected residual
  for (const WeightKernel kernel : {WeightKernel::kPower2, WeightKernel::kPower4}) {
    double mean = 0;
    constexpr int kBalls = 10;
    for (int b = 0; b < kBalls; ++b) {
      const TestBall ball =
          wavyBall(1, 20000, 0.0, 1.0, kThickness, 700u + static_cast<unsigned>(b), true, kernel);
      mean += energy(ball.fit, 1.0, 1.0) / kBalls;
    }
    // Terms of the fourth order in the thickness are left: about 1 %.
    EXPECT_NEAR(mean / (kThickness * kThickness), 1.0, 0.03) << static_cast<int>(kernel);
  }
}

}  // namespace
}  // namespace pcl_slim

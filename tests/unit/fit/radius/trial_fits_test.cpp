// SPDX-License-Identifier: BSD-3-Clause
// The trial fits of one ball, and the comparison of two of them.
#include "radius/radius.h"

#include <gtest/gtest.h>

#include "support/balls.h"

namespace pcl_slim {

using namespace detail;
using pcl_slim_test::TestBall;
using pcl_slim_test::wavyBall;

namespace {

constexpr double kBallNoise = 0.01;

FitPlan planOfNoise() {
  FitPlan plan;
  plan.energy.lambda = kBallNoise * kBallNoise;
  plan.energy.kappa = 3.0;
  return plan;
}

TEST(BallSamples, InnerPartsHoldAllPointsWithinARadius) {
  const TestBall ball = wavyBall(2, 2000, 0.0, 1.0, kBallNoise, 7);
  BallSamples samples;
  samples.begin(ball.points, 0.5, 1.0);
  std::size_t last = ball.points.count + 1;
  for (const double rho : {1.0, 0.61, 0.38}) {
    std::size_t inside = 0;
    for (std::size_t i = 0; i < ball.points.count; ++i) inside += ball.points.s_sq[i] < rho * rho;
    const BallBuffer& part = samples.within(rho);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < part.count; ++i) kept += part.s_sq[i] < rho * rho;
    EXPECT_EQ(kept, inside) << rho;
    EXPECT_LT(part.count, last) << rho;
    last = part.count;
  }
}

/** A single point more or less moves n_eff by some percent, so the mean over balls is tested. */
TEST(TrialFits, TheMinimumSupportRadiusJustHasTheSupport) {
  const FitPlan plan = planOfNoise();
  TrialFits trials(plan);
  constexpr unsigned kBalls = 20;
  for (const int degree : {3, 4}) {
    for (const WeightKernel kernel : {WeightKernel::kPower2, WeightKernel::kPower4}) {
      const double least = plan.support * numCoefficients(degree);
      double mean = 0;
      for (unsigned b = 0; b < kBalls; ++b) {
        const TestBall ball = wavyBall(2, 200, 0.0, 1.0, kBallNoise, 40 + b);
        trials.begin(ball.points, 1.0, 1.0);
        const auto rho = static_cast<float>(trials.minimumSupportRadius(1.0, degree, kernel));
        const double n_eff = kernels::effectiveCount(ball.points, rho, kernel);
        EXPECT_GE(n_eff, 0.9999 * least) << degree;
        mean += n_eff / least / kBalls;
      }
      EXPECT_LE(mean, 1.1) << degree;
    }
  }
  EXPECT_EQ(trials.counts().fits, 0u);
}

TEST(TrialFits, TheFitAtTheRightRadiusIsMadeOnce) {
  const TestBall ball = wavyBall(2, 500, 0.0, 1.0, kBallNoise, 9);
  const FitPlan plan = planOfNoise();
  TrialFits trials(plan);
  trials.begin(ball.points, 1.0, 1.0);
  EXPECT_TRUE(trials.right().supported);
  EXPECT_EQ(trials.right().rho, 1.0);
  EXPECT_EQ(trials.counts().fits, 1u);
}

/** On a noisy plane the wide fit is as good for the middle ball's points; over a wave it does not.
 */
TEST(FitComparison, AcceptsTheWideFitOfAPlaneButNotOfAWave) {
  const FitPlan plan = planOfNoise();
  for (const double amplitude : {0.0, 0.6 * kBallNoise}) {
    int accepted = 0;
    constexpr int kBalls = 20;
    for (int b = 0; b < kBalls; ++b) {
      const TestBall ball =
          wavyBall(4, 4000, amplitude, 0.9, kBallNoise, 500u + static_cast<unsigned>(b));
      TrialFits trials(plan);
      ResidualTests tests(trials);
      trials.begin(ball.points, 1.0, 1.0);
      accepted += FitComparison(trials, tests).acceptsSimpler(trials.right(), trials.middle());
    }
    if (amplitude == 0) {
      EXPECT_GE(accepted, kBalls / 2);
    } else {
      EXPECT_LE(accepted, kBalls / 4);
    }
  }
}

TEST(FitComparison, GoesByTheConstantsOfItsSettings) {
  const TestBall ball = wavyBall(4, 4000, 0.0, 1.0, kBallNoise, 10);
  const FitPlan plan = planOfNoise();
  RadiusConstants constants;
  constants.comparison_worth = 1e3;
  TrialFits trials(plan, constants);
  ResidualTests tests(trials);
  trials.begin(ball.points, 1.0, 1.0);
  const FitComparison comparison(trials, tests);
  const Trial middle = trials.middle();
  EXPECT_TRUE(comparison.acceptsSimpler(trials.right(), middle));
  constants.comparison_worth = 0.0;
  EXPECT_FALSE(comparison.acceptsSimpler(trials.right(), middle));
}

}  // namespace
}  // namespace pcl_slim

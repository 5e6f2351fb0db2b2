// SPDX-License-Identifier: BSD-3-Clause
// Noise against unresolved detail in the residuals of one ball.
#include "radius/radius.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/balls.h"

namespace pcl_slim {

using namespace detail;
using pcl_slim_test::TestBall;
using pcl_slim_test::wavyBall;

namespace {

constexpr double kInner = 0.6180339887498949;  // the part of a ball that is looked at
const RadiusConstants kConstants;

TEST(ResidualStructure, OfNoiseIsNothingButItsDeviation) {
  ResidualStructure structure(kConstants);
  for (const int degree : {2, 4}) {
    for (const std::size_t count : {400, 3000, 20000}) {
      double mean = 0, squares = 0;
      constexpr int kBalls = 60;
      for (int b = 0; b < kBalls; ++b) {
        const TestBall ball =
            wavyBall(degree, count, 0.0, 1.0, 0.01, 100u + static_cast<unsigned>(b));
        const auto found = structure.measure(ball.points, ball.fit, kInner);
        ASSERT_GT(found.deviation, 0.0);
        const double z = found.share / found.deviation;
        mean += z / kBalls;
        squares += z * z / kBalls;
      }
      EXPECT_NEAR(mean, 0.0, 0.5) << "degree " << degree << ", " << count << " points";
      EXPECT_NEAR(std::sqrt(squares), 1.0, 0.3)
          << "degree " << degree << ", " << count << " points";
    }
  }
}

TEST(ResidualStructure, IsTheShareOfAWaveBelowTheNoise) {
  // A wave of half the noise's deviation: an eighth of its variance, a ninth of the sum.
  ResidualStructure structure(kConstants);
  const double noise = 0.01, amplitude = 0.5 * noise;
  const double wave = 0.5 * amplitude * amplitude, share = wave / (wave + noise * noise);
  for (const int degree : {2, 4}) {
    const TestBall ball = wavyBall(degree, 20000, amplitude, 0.25, noise, 5);
    const auto found = structure.measure(ball.points, ball.fit, kInner);
    // A cell sees the mean of the wave across itself.
    EXPECT_NEAR(found.share / share, 0.85, 0.15) << "degree " << degree;
    EXPECT_GT(found.share, 4.0 * found.deviation);
  }
}

TEST(ResidualStructure, WiderCellsTellAFainterWave) {
  // A wave of a quarter of the noise, long beside the cells: more pairs in each, a smaller
  // deviation.
  ResidualStructure structure(kConstants);
  double fine = 0, wide = 0;
  constexpr int kBalls = 20;
  for (int b = 0; b < kBalls; ++b) {
    const TestBall ball = wavyBall(2, 4000, 0.0025, 0.7, 0.01, 300u + static_cast<unsigned>(b));
    const auto narrow = structure.measure(ball.points, ball.fit, kInner);
    const auto broad = structure.measure(ball.points, ball.fit, kInner, 0.2);
    fine += narrow.share / narrow.deviation / kBalls;
    wide += broad.share / broad.deviation / kBalls;
    // A width below that of the cells changes nothing.
    EXPECT_EQ(structure.measure(ball.points, ball.fit, kInner, 1e-3).share, narrow.share);
  }
  EXPECT_GT(wide, 3.0);
  EXPECT_GT(wide, 1.5 * fine);
}

TEST(ResidualStructure, SaysNothingAboutAHandfulOfPoints) {
  ResidualStructure structure(kConstants);
  const TestBall ball = wavyBall(1, 20, 0.1, 0.5, 0.01, 3);
  EXPECT_EQ(structure.measure(ball.points, ball.fit, kInner).deviation, 0.0);
}

TEST(ResidualStructure, OfAnExactFitIsUnknown) {
  ResidualStructure structure(kConstants);
  const TestBall ball = wavyBall(2, 1000, 0.0, 1.0, 0.0, 3);
  const auto found = structure.measure(ball.points, ball.fit, kInner);
  EXPECT_EQ(found.deviation, 0.0);
}

}  // namespace
}  // namespace pcl_slim

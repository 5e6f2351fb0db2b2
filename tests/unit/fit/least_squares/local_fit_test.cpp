// SPDX-License-Identifier: BSD-3-Clause
// Weighted least squares of one ball against Eigen in double.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "least_squares/dense.h"
#include "least_squares/least_squares.h"
#include "scan/ball_kernels.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr WeightKernel kFitKernels[] = {WeightKernel::kPower2, WeightKernel::kPower4,
                                        WeightKernel::kGaussian};

void addPoint(BallBuffer& ball, double u, double v, double w) {
  ball.reserve(ball.count + 1);
  const std::size_t i = ball.count++;
  ball.u[i] = static_cast<float>(u);
  ball.v[i] = static_cast<float>(v);
  ball.w[i] = static_cast<float>(w);
  ball.s_sq[i] = ball.u[i] * ball.u[i] + ball.v[i] * ball.v[i] + ball.w[i] * ball.w[i];
}

void pad(BallBuffer& ball) {
  for (std::size_t i = ball.count; i < ball.count + BallBuffer::kPadding; ++i) {
    ball.u[i] = ball.v[i] = ball.w[i] = 0.0f;
    ball.s_sq[i] = 2.0f;
  }
}

/** Points of a random polynomial of the degree over the unit disc, with noise along w. */
BallBuffer polynomialBall(int degree, std::size_t count, double noise, std::uint32_t seed,
                          std::array<double, kMaxCoefficients>& c) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  std::normal_distribution<double> normal;
  c.fill(0.0);
  for (int k = 0; k < numCoefficients(degree); ++k) {
    c[static_cast<std::size_t>(k)] = (k == 0 ? 0.02 : 0.15) * normal(random);
  }
  BallBuffer ball;
  while (ball.count < count) {
    const double u = place(random), v = place(random);
    if (u * u + v * v > 0.8) continue;

    double h = 0;
    int k = 0;
    for (int d = 0; d <= degree; ++d) {
      for (int j = 0; j <= d; ++j)
        h += c[static_cast<std::size_t>(k++)] * std::pow(u, d - j) * std::pow(v, j);
    }
    addPoint(ball, u, v, h + noise * normal(random));
  }
  pad(ball);
  return ball;
}

/** Weighted mean of |grad h|^2, point by point. */
double meanSlopeSq(const BallBuffer& ball, int degree, double rho, WeightKernel kernel,
                   const LocalFit& fit) {
  double weight = 0, sum = 0;
  for (std::size_t i = 0; i < ball.count; ++i) {
    double du = 0, dv = 0;
    for (int d = 1, k = 1; d <= degree; ++d) {
      for (int j = 0; j <= d; ++j, ++k) {
        const double c = fit.c[static_cast<std::size_t>(k)];
        if (j < d) du += c * (d - j) * std::pow(ball.u[i], d - j - 1) * std::pow(ball.v[i], j);
        if (j > 0) dv += c * j * std::pow(ball.u[i], d - j) * std::pow(ball.v[i], j - 1);
      }
    }
    const double w = evaluateKernel(kernel, ball.s_sq[i] / (rho * rho));
    weight += w;
    sum += w * (du * du + dv * dv);
  }
  return sum / weight;
}

/** The same fit in double by QR: coefficients, e^2 and n_eff. */
LocalFit referenceFit(const BallBuffer& ball, int degree, double rho, WeightKernel kernel) {
  const int terms = numCoefficients(degree);
  const auto n = static_cast<Eigen::Index>(ball.count);
  Eigen::MatrixXd rows(n, terms);
  Eigen::VectorXd heights(n);
  double sum = 0, squares = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto s = static_cast<std::size_t>(i);
    double weight = evaluateKernel(kernel, ball.s_sq[s] / (rho * rho));
    if (!ball.prior.empty()) weight *= ball.prior[s];
    sum += weight;
    squares += weight * weight;
    const double root = std::sqrt(weight);
    for (int d = 0, k = 0; d <= degree; ++d) {
      for (int j = 0; j <= d; ++j) {
        rows(i, k++) = root * std::pow(double(ball.u[s]), d - j) * std::pow(double(ball.v[s]), j);
      }
    }
    heights(i) = root * ball.w[s];
  }
  const Eigen::VectorXd c = solveLeastSquares(rows, heights);
  LocalFit fit;
  fit.degree = degree;
  for (int k = 0; k < terms; ++k) fit.c[static_cast<std::size_t>(k)] = c(k);
  fit.residual_sq = (heights - rows * c).squaredNorm() / sum;
  fit.n_eff = sum * sum / squares;
  return fit;
}

TEST(FitBall, RecoversPolynomials) {
  for (int degree = 1; degree <= kMaxDegree; ++degree) {
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
      std::array<double, kMaxCoefficients> truth;
      const BallBuffer ball = polynomialBall(degree, 80 * seed, 0.0, seed, truth);
      for (const WeightKernel kernel : kFitKernels) {
        const LocalFit fit = kernels::fitBall(ball, degree, 1.0f, kernel, 1.2, true);
        ASSERT_EQ(fit.degree, degree);
        for (int k = 0; k < numCoefficients(degree); ++k) {
          const auto i = static_cast<std::size_t>(k);
          ASSERT_NEAR(fit.c[i], truth[i], 3e-5) << "degree " << degree << " term " << k;
        }
        ASSERT_LT(std::sqrt(fit.residual_sq), 2e-7);
      }
    }
  }
}

TEST(FitBall, AgreesWithDoubleLeastSquares) {
  for (int degree = 1; degree <= kMaxDegree; ++degree) {
    for (const float rho : {1.0f, 0.8f, 0.62f}) {
      for (const WeightKernel kernel : kFitKernels) {
        std::array<double, kMaxCoefficients> truth;
        const BallBuffer ball = polynomialBall(degree, 400, 0.01, 77, truth);
        const LocalFit expected = referenceFit(ball, degree, rho, kernel);
        for (const bool refine : {false, true}) {
          const LocalFit fit = kernels::fitBall(ball, degree, rho, kernel, 1.2, refine);
          ASSERT_EQ(fit.degree, degree);
          const double slack = refine ? 1e-5 : 5e-4;
          for (std::size_t k = 0; k < kMaxCoefficients; ++k) {
            ASSERT_NEAR(fit.c[k], expected.c[k], slack);
          }
          ASSERT_NEAR(fit.residual_sq / expected.residual_sq, 1.0, 1e-3);
          ASSERT_NEAR(fit.n_eff / expected.n_eff, 1.0, 1e-5);
          ASSERT_NEAR(fit.slope_sq, meanSlopeSq(ball, degree, rho, kernel, fit), 1e-4);
        }
        ASSERT_NEAR(kernels::effectiveCount(ball, rho, kernel) / expected.n_eff, 1.0, 1e-5);
      }
    }
  }
}

TEST(FitBall, ItsMomentsHoldTheMeanSquareOfAPolynomial) {
  for (int degree = 1; degree <= kMaxDegree; ++degree) {
    std::array<double, kMaxCoefficients> h;
    const BallBuffer ball = polynomialBall(degree, 300, 0.01, 12, h);
    const LocalFit fit = kernels::fitBall(ball, degree, 0.9f, WeightKernel::kPower4, 1.2, false);
    std::array<float, kMaxCoefficients> c;
    for (std::size_t k = 0; k < kMaxCoefficients; ++k) c[k] = static_cast<float>(h[k]);
    double weight = 0, sum = 0;
    for (std::size_t i = 0; i < ball.count; ++i) {
      const double w = evaluateKernel(WeightKernel::kPower4, ball.s_sq[i] / 0.81);
      const double value = evaluateHeight(degree, c.data(), ball.u[i], ball.v[i]);
      weight += w;
      sum += w * value * value;
    }
    ASSERT_EQ(fit.moment_degree, degree);
    EXPECT_NEAR(kernels::meanSquare(degree, fit.moments.data(), h.data()) / (sum / weight), 1.0,
                1e-4);
  }
}

TEST(FitBall, OfALowerDegreeFollowsFromItsMoments) {
  for (int degree = 2; degree <= kMaxDegree; ++degree) {
    std::array<double, kMaxCoefficients> truth;
    const BallBuffer ball = polynomialBall(degree, 400, 0.01, 31, truth);
    const LocalFit fit = kernels::fitBall(ball, degree, 0.9f, WeightKernel::kPower4, 1.2, false);
    for (int low = 1; low < degree; ++low) {
      const LocalFit expected = kernels::fitBall(ball, low, 0.9f, WeightKernel::kPower4, 1.2, true);
      const LocalFit nested = nestedFit(fit, low);
      ASSERT_EQ(nested.degree, low);
      for (std::size_t k = 0; k < kMaxCoefficients; ++k) {
        ASSERT_NEAR(nested.c[k], expected.c[k], 5e-4) << "degree " << degree << " to " << low;
      }
      ASSERT_NEAR(nested.residual_sq / expected.residual_sq, 1.0, 1e-3);
      ASSERT_NEAR(nested.slope_sq, expected.slope_sq, 1e-4);
      ASSERT_NEAR(nested.n_eff / expected.n_eff, 1.0, 1e-6);
      ASSERT_EQ(nested.terms, numCoefficients(low));
    }
  }
}

TEST(FitBall, LowersTheDegreeAsPointsGetFew) {
  int last = 0;
  for (std::size_t count = 1; count <= 60; ++count) {
    std::array<double, kMaxCoefficients> truth;
    const BallBuffer ball = polynomialBall(4, count, 0.001, 5, truth);
    const LocalFit fit = kernels::fitBall(ball, 4, 1.0f, WeightKernel::kPower2, 1.2, true);
    ASSERT_TRUE(fit.degree == 0 || fit.n_eff >= 1.2 * numCoefficients(fit.degree)) << count;
    ASSERT_TRUE(fit.degree == 4 || fit.n_eff < 1.2 * numCoefficients(fit.degree + 1)) << count;
    for (int k = fit.degree > 0 ? numCoefficients(fit.degree) : 0; k < kMaxCoefficients; ++k) {
      ASSERT_EQ(fit.c[static_cast<std::size_t>(k)], 0.0);
    }
    last = fit.degree;
  }
  EXPECT_EQ(last, 4);
}

TEST(FitBall, AFallenDegreeIsTheBestOfThatDegree) {
  std::array<double, kMaxCoefficients> truth;
  const BallBuffer ball = polynomialBall(4, 14, 0.001, 9, truth);
  const LocalFit fit = kernels::fitBall(ball, 4, 1.0f, WeightKernel::kPower2, 1.2, true);
  ASSERT_GT(fit.degree, 0);
  ASSERT_LT(fit.degree, 4);
  const LocalFit expected = referenceFit(ball, fit.degree, 1.0, WeightKernel::kPower2);
  for (std::size_t k = 0; k < kMaxCoefficients; ++k) ASSERT_NEAR(fit.c[k], expected.c[k], 1e-5);
  EXPECT_NEAR(fit.residual_sq / expected.residual_sq, 1.0, 1e-3);
}

TEST(FitBall, MakesNoPolynomialOfALineOrOfOnePlace) {
  BallBuffer line, place;
  for (int i = 0; i < 100; ++i) {
    const double t = (i - 49.5) / 60.0;
    addPoint(line, 0.8 * t, 0.6 * t, 0.0);
    addPoint(place, 0.2, 0.1, 0.05);
  }
  pad(line);
  pad(place);
  for (int degree = 1; degree <= kMaxDegree; ++degree) {
    EXPECT_EQ(kernels::fitBall(line, degree, 1.0f, WeightKernel::kPower4, 1.2, true).degree, 0);
    EXPECT_EQ(kernels::fitBall(place, degree, 1.0f, WeightKernel::kPower4, 1.2, true).degree, 0);
  }
}

TEST(FitBall, MakesAtMostALowDegreeOfThreeRows) {
  // Three parallel rows of points determine nothing of third order across them.
  BallBuffer rows;
  for (int i = 0; i < 100; ++i) {
    for (int row = -1; row <= 1; ++row)
      addPoint(rows, (i - 49.5) / 60.0, 0.3 * row, 0.01 * row * row);
  }
  pad(rows);
  const LocalFit fit = kernels::fitBall(rows, 4, 1.0f, WeightKernel::kPower4, 1.2, true);
  EXPECT_GE(fit.degree, 1);
  EXPECT_LE(fit.degree, 2);
  for (const double value : fit.c) EXPECT_LT(std::abs(value), 1.0);
}

TEST(FitBall, OfNothingIsNothing) {
  BallBuffer ball;
  ball.reserve(1);
  pad(ball);
  const LocalFit fit = kernels::fitBall(ball, 4, 1.0f, WeightKernel::kPower4, 1.2, true);
  EXPECT_EQ(fit.degree, 0);
  EXPECT_EQ(kernels::effectiveCount(ball, 1.0f, WeightKernel::kPower4), 0.0);
}

TEST(FitBall, HonoursRobustWeights) {
  std::array<double, kMaxCoefficients> truth;
  BallBuffer ball = polynomialBall(2, 200, 0.0, 3, truth);
  const std::size_t clean = ball.count;
  for (int i = 0; i < 40; ++i) addPoint(ball, 0.4, -0.3 + 0.01 * i, 0.5);
  pad(ball);
  ball.prior.assign(ball.u.size(), 1.0f);
  std::fill(ball.prior.begin() + static_cast<std::ptrdiff_t>(clean), ball.prior.end(), 0.0f);
  const LocalFit fit = kernels::fitBall(ball, 2, 1.0f, WeightKernel::kPower4, 1.2, true);
  ASSERT_EQ(fit.degree, 2);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(fit.c[k], truth[k], 1e-5);
}

TEST(BallResiduals, AreHeightsAboveTheFit) {
  for (int degree = 1; degree <= kMaxDegree; ++degree) {
    std::array<double, kMaxCoefficients> truth;
    const BallBuffer ball = polynomialBall(degree, 123, 0.05, 4, truth);
    LocalFit fit;
    fit.degree = degree;
    fit.c = truth;
    std::array<float, kMaxCoefficients> c;
    for (std::size_t k = 0; k < kMaxCoefficients; ++k) c[k] = static_cast<float>(truth[k]);
    std::vector<float> residuals(ball.count + BallBuffer::kPadding);
    kernels::ballResiduals(ball, fit.degree, fit.c.data(), residuals.data());
    for (std::size_t i = 0; i < ball.count; ++i) {
      ASSERT_NEAR(residuals[i], ball.w[i] - evaluateHeight(degree, c.data(), ball.u[i], ball.v[i]),
                  1e-6);
    }
  }
}

TEST(SelectResiduals, KeepsARangeAndCompactKeepsABall) {
  std::array<double, kMaxCoefficients> truth;
  const BallBuffer ball = polynomialBall(2, 131, 0.1, 6, truth);
  std::vector<float> residuals(ball.w.begin(), ball.w.end());
  BallBuffer kept, inner;
  kernels::selectResiduals(ball, residuals.data(), -0.05f, 0.1f, kept);
  kernels::compactBall(ball, 0.25f, inner);
  std::vector<float> expected_kept, expected_inner;
  for (std::size_t i = 0; i < ball.count; ++i) {
    if (residuals[i] >= -0.05f && residuals[i] <= 0.1f) expected_kept.push_back(ball.u[i]);
    if (ball.s_sq[i] < 0.25f) expected_inner.push_back(ball.v[i]);
  }
  ASSERT_GT(expected_kept.size(), 20u);
  ASSERT_GT(expected_inner.size(), 20u);
  EXPECT_EQ(
      std::vector<float>(kept.u.begin(), kept.u.begin() + static_cast<std::ptrdiff_t>(kept.count)),
      expected_kept);
  EXPECT_EQ(std::vector<float>(inner.v.begin(),
                               inner.v.begin() + static_cast<std::ptrdiff_t>(inner.count)),
            expected_inner);
}

}  // namespace
}  // namespace pcl_slim

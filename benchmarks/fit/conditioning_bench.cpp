// SPDX-License-Identifier: BSD-3-Clause
// conditioning_bench: how the error of a local fit grows with the condition of its equations, for
// moments in float, in float with the refinement that leaves get, and in double.
#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "ball/ball_kernels.h"
#include "common/options.h"
#include "least_squares/local_fit.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::detail;

constexpr std::size_t kPoints = 400;
constexpr WeightKernel kKernel = WeightKernel::kPower4;

/** Places of a ball's points: an ellipse of some width, its middle off the ball's by offset, scaled so
 * that all of it lies in the ball. */
struct Layout {
  double width = 1, offset = 0;
};

/** A ball over a polynomial, and what the polynomial is. */
struct Sample {
  BallBuffer ball;
  Eigen::VectorXd truth;
};

Eigen::VectorXd
termsAt(int degree, double u, double v)
{
  Eigen::VectorXd terms(numCoefficients(degree));
  for (int d = 0, k = 0; d <= degree; ++d) {
    for (int j = 0; j <= d; ++j) terms[k++] = std::pow(u, d - j) * std::pow(v, j);
  }
  return terms;
}

Sample
makeSample(int degree, const Layout& layout, double noise, std::uint32_t seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  std::normal_distribution<double> normal;
  Sample sample{{}, Eigen::VectorXd(numCoefficients(degree))};
  for (double& c : sample.truth) c = 0.15 * normal(random);
  sample.ball.reserve(kPoints);
  const double size = 0.9 * (1 - layout.offset), turn = 0.4;
  while (sample.ball.count < kPoints) {
    const double a = place(random), b = layout.width * place(random);
    if (a * a + b * b / (layout.width * layout.width) > 1) continue;
    const double u = layout.offset * 0.9 + size * (std::cos(turn) * a - std::sin(turn) * b);
    const double v = size * (std::sin(turn) * a + std::cos(turn) * b);
    const double w = sample.truth.dot(termsAt(degree, u, v)) + noise * normal(random);
    const std::size_t i = sample.ball.count++;
    sample.ball.u[i] = static_cast<float>(u);
    sample.ball.v[i] = static_cast<float>(v);
    sample.ball.w[i] = static_cast<float>(w);
    sample.ball.s_sq[i] = static_cast<float>(u * u + v * v);
  }
  for (std::size_t i = kPoints; i < kPoints + BallBuffer::kPadding; ++i) {
    sample.ball.u[i] = sample.ball.v[i] = sample.ball.w[i] = 0.0f;
    sample.ball.s_sq[i] = 2.0f;
  }
  return sample;
}

/** The same fit with every sum in double, by an orthogonal factorisation. */
Eigen::VectorXd
fitInDouble(const BallBuffer& ball, int degree)
{
  Eigen::MatrixXd rows(kPoints, numCoefficients(degree));
  Eigen::VectorXd heights(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double weight = std::sqrt(evaluateKernel(kKernel, ball.s_sq[i]));
    const auto row = static_cast<Eigen::Index>(i);
    rows.row(row) = weight * termsAt(degree, ball.u[i], ball.v[i]).transpose();
    heights[row] = weight * ball.w[i];
  }
  return rows.colPivHouseholderQr().solve(heights);
}

/** RMS difference of two polynomials over a ball's points. */
double
difference(const BallBuffer& ball, int degree, const Eigen::VectorXd& a, const Eigen::VectorXd& b)
{
  double sum = 0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    sum += std::pow((a - b).dot(termsAt(degree, ball.u[i], ball.v[i])), 2);
  }
  return std::sqrt(sum / static_cast<double>(kPoints));
}

Eigen::VectorXd
coefficientsOf(const LocalFit& fit, int degree)
{
  Eigen::VectorXd c = Eigen::VectorXd::Zero(numCoefficients(degree));
  for (int k = 0; k < numCoefficients(fit.degree) && fit.degree > 0; ++k) {
    c[k] = fit.c[static_cast<std::size_t>(k)];
  }
  return c;
}

/** One row: means over some samples. */
void
printRow(int degree, const Layout& layout, double noise, int samples)
{
  double pivot = 0, reached = 0, in_float = 0, refined = 0, in_double = 0, apart = 0;
  for (int s = 0; s < samples; ++s) {
    const Sample sample = makeSample(degree, layout, noise, static_cast<std::uint32_t>(s + 1));
    const LocalFit bare = kernels::fitBall(sample.ball, degree, 1.0f, kKernel, 1.15, false);
    const LocalFit best = kernels::fitBall(sample.ball, degree, 1.0f, kKernel, 1.15, true);
    const Eigen::VectorXd exact = fitInDouble(sample.ball, degree);
    pivot += best.least_pivot;
    reached += best.degree;
    in_float += difference(sample.ball, degree, coefficientsOf(bare, degree), sample.truth);
    refined += difference(sample.ball, degree, coefficientsOf(best, degree), sample.truth);
    in_double += difference(sample.ball, degree, exact, sample.truth);
    apart += difference(sample.ball, degree, coefficientsOf(best, degree), exact);
  }
  const double n = samples;
  std::printf("| %d | %.3g | %.3g | %.1g | %.1f | %.1e | %.1e | %.1e | %.1e |\n", degree,
              layout.width, layout.offset, pivot / n, reached / n, in_float / n, refined / n,
              in_double / n, apart / n);
}

}  // namespace

int
main(int argc, char** argv)
{
  int samples = 50;
  double noise = 0;
  OptionTable options("conditioning_bench", "1",
                      "Measures how errors of local fits grow with their condition.");
  options.integer("samples", &samples, 1, 100000, "balls whose mean a row is");
  options.number("noise", &noise, 0, 1, "standard deviation of heights, in radii");
  if (const auto status = options.parse(argc, argv)) return *status;
  std::printf(
      "| degree | width | offset | least pivot | degree fitted | float | float, refined | double | "
      "refined less double |\n|---|---|---|---|---|---|---|---|---|\n");
  for (int degree = 1; degree <= 4; ++degree) {
    for (const double width : {1.0, 0.3, 0.1, 0.03, 0.01, 0.003}) {
      printRow(degree, {width, 0}, noise, samples);
    }
    for (const double offset : {0.3, 0.6, 0.8, 0.9, 0.95}) {
      printRow(degree, {1, offset}, noise, samples);
    }
  }
  return 0;
}

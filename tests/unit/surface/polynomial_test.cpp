// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/polynomial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace pcl_slim {
namespace {

std::array<float, kMaxCoefficients> randomCoefficients(std::mt19937& random) {
  std::normal_distribution<float> normal;
  std::array<float, kMaxCoefficients> c;
  for (float& value : c) value = normal(random);
  return c;
}

/** Sum over terms in order of degree, straight from the definition. */
double termByTerm(int degree, const float* c, double u, double v) {
  double h = 0;
  int k = 0;
  for (int d = 0; d <= degree; ++d) {
    for (int j = 0; j <= d; ++j) h += c[k++] * std::pow(u, d - j) * std::pow(v, j);
  }
  return h;
}

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

TEST(Polynomial, CountsItsCoefficients) {
  EXPECT_EQ(numCoefficients(1), 3);
  EXPECT_EQ(numCoefficients(2), 6);
  EXPECT_EQ(numCoefficients(3), 10);
  EXPECT_EQ(numCoefficients(4), kMaxCoefficients);
}

/** Calls check(degree, coefficients, u, v) for every degree of some random polynomials. */
template <typename Check>
void forRandomPolynomials(unsigned seed, int trials, const Check& check) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  for (int trial = 0; trial < trials; ++trial) {
    const auto c = randomCoefficients(random);
    const double u = place(random), v = place(random);
    for (int degree = 1; degree <= kMaxDegree; ++degree) check(degree, c.data(), u, v);
  }
}

TEST(Polynomial, HeightIsTheSumOfItsTerms) {
  forRandomPolynomials(41, 200, [](int degree, const float* c, double u, double v) {
    const double expected = termByTerm(degree, c, u, v);
    ASSERT_NEAR(evaluateHeight(degree, c, u, v), expected, 1e-12);
    ASSERT_NEAR(evaluateJet(degree, c, u, v).h, expected, 1e-12);
  });
}

/** Central difference of one of the jet's members along u or v. */
template <typename Member>
double slope(int degree, const float* c, double u, double v, bool along_u, Member member) {
  const double step = 1e-5;
  const HeightJet ahead =
      evaluateJet(degree, c, u + (along_u ? step : 0), v + (along_u ? 0 : step));
  const HeightJet behind =
      evaluateJet(degree, c, u - (along_u ? step : 0), v - (along_u ? 0 : step));
  return (ahead.*member - behind.*member) / (2 * step);
}

TEST(Polynomial, JetHoldsTheDerivatives) {
  forRandomPolynomials(42, 100, [](int degree, const float* c, double u, double v) {
    const HeightJet j = evaluateJet(degree, c, u, v);
    const auto along = [&](bool along_u, double HeightJet::*member) {
      return slope(degree, c, u, v, along_u, member);
    };
    ASSERT_NEAR(j.hu, along(true, &HeightJet::h), 1e-7);
    ASSERT_NEAR(j.hv, along(false, &HeightJet::h), 1e-7);
    ASSERT_NEAR(j.huu, along(true, &HeightJet::hu), 1e-7);
    ASSERT_NEAR(j.huv, along(false, &HeightJet::hu), 1e-7);
    ASSERT_NEAR(j.huv, along(true, &HeightJet::hv), 1e-7);
    ASSERT_NEAR(j.hvv, along(false, &HeightJet::hv), 1e-7);
    ASSERT_NEAR(j.huuu, along(true, &HeightJet::huu), 1e-7);
    ASSERT_NEAR(j.huuv, along(false, &HeightJet::huu), 1e-7);
    ASSERT_NEAR(j.huvv, along(true, &HeightJet::hvv), 1e-7);
    ASSERT_NEAR(j.hvvv, along(false, &HeightJet::hvv), 1e-7);
  });
}

TEST(Polynomial, TurnsRound) {
  std::mt19937 random(43);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  for (int degree = 1; degree <= kMaxDegree; ++degree) {
    const auto c = randomCoefficients(random);
    auto turned = c;
    flipCoefficients(degree, turned.data());
    for (int trial = 0; trial < 50; ++trial) {
      // The opposite normal's frame is (u, -v, -w), so w - h(u, v) becomes its negative.
      const double u = place(random), v = place(random);
      ASSERT_EQ(evaluateHeight(degree, turned.data(), u, -v),
                -evaluateHeight(degree, c.data(), u, v));
    }
    flipCoefficients(degree, turned.data());
    EXPECT_EQ(turned, c);
  }
}

TEST(LocalFrame, IsOrthonormalAndRightHandedForAnyNormal) {
  std::mt19937 random(44);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 5000; ++trial) {
    std::array<double, 3> n = {normal(random), normal(random), normal(random)};
    if (trial % 5 == 0) n[static_cast<std::size_t>(trial / 5 % 3)] *= 1e-9;
    if (trial < 6)
      n = {0.0, 0.0, 0.0}, n[static_cast<std::size_t>(trial / 2)] = trial % 2 ? -1.0 : 1.0;
    const double length = std::sqrt(dot(n, n));
    for (double& value : n) value /= length;
    const LocalFrame f(n);
    ASSERT_EQ(f.w, n);
    ASSERT_NEAR(dot(f.u, f.u), 1.0, 1e-12);
    ASSERT_NEAR(dot(f.v, f.v), 1.0, 1e-12);
    ASSERT_NEAR(dot(f.u, f.v), 0.0, 1e-12);
    ASSERT_NEAR(dot(f.u, f.w), 0.0, 1e-12);
    ASSERT_NEAR(dot(f.v, f.w), 0.0, 1e-12);
    const double volume = f.u[0] * (f.v[1] * f.w[2] - f.v[2] * f.w[1]) -
                          f.u[1] * (f.v[0] * f.w[2] - f.v[2] * f.w[0]) +
                          f.u[2] * (f.v[0] * f.w[1] - f.v[1] * f.w[0]);
    ASSERT_NEAR(volume, 1.0, 1e-12);
    const LocalFrame turned({-n[0], -n[1], -n[2]});
    ASSERT_EQ(turned.u, f.u);
    for (std::size_t a = 0; a < 3; ++a) ASSERT_EQ(turned.v[a], -f.v[a]);
  }
}

}  // namespace
}  // namespace pcl_slim

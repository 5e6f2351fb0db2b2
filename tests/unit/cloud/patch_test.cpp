// SPDX-License-Identifier: BSD-3-Clause
// Patches of the noise estimate beside Eigen's own algebra.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "noise/patch.h"

namespace pcl_slim {

using namespace detail;

namespace {

/** A bent and noisy sheet about the origin, turned. */
Patch bentPatch(std::size_t count, double noise, double bend = 1) {
  std::mt19937_64 random(count);
  std::uniform_real_distribution<double> u(-1, 1);
  std::normal_distribution<double> gauss(0, noise);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  Patch patch;
  patch.points.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double x = u(random), y = u(random);
    const double z = bend * (0.2 * x * x - 0.1 * x * y + 0.15 * y * y * y) + gauss(random);
    const Eigen::Vector3d p = turn * Eigen::Vector3d(x, y, z);
    patch.points.set(i, p);
    patch.radius = std::max(patch.radius, p.norm());
  }
  return patch;
}

TEST(Patch, AxesAreThoseOfTheCovariance) {
  for (const std::size_t count : {4u, 7u, 8u, 33u, 320u}) {
    const Patch patch = bentPatch(count, 0.01);
    Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(count));
    for (std::size_t i = 0; i < count; ++i)
      points.col(static_cast<Eigen::Index>(i)) = patch.points.at(i);
    points.colwise() -= points.rowwise().mean().eval();
    const Eigen::Matrix3d covariance = points * points.transpose() / static_cast<double>(count);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> expected(covariance);
    EXPECT_LT((principalAxes(patch.points).eigenvalues() - expected.eigenvalues()).norm(), 1e-12);
  }
}

TEST(Patch, ACubicLeavesWhatAnOrthogonalFactorisationLeaves) {
  for (const std::size_t count : {12u, 20u, 45u, 320u}) {
    const Patch patch = bentPatch(count, 0.02);
    PatchCubic cubic;
    ASSERT_TRUE(fitCubic(patch, cubic));
    const auto n = static_cast<Eigen::Index>(count);
    Eigen::MatrixXd terms(n, kCubicTerms);
    Eigen::VectorXd heights(n);
    for (std::size_t i = 0; i < count; ++i) {
      const double u = cubic.places[2][i], v = cubic.places[1][i];
      terms.row(static_cast<Eigen::Index>(i)) << 1, u, v, u * u, u * v, v * v, u * u * u, u * u * v,
          u * v * v, v * v * v;
      heights[static_cast<Eigen::Index>(i)] = cubic.places[0][i];
    }
    const Eigen::VectorXd left = heights - terms * terms.colPivHouseholderQr().solve(heights);
    const double scale = patch.radius * patch.radius / static_cast<double>(n - kCubicTerms);
    EXPECT_NEAR(cubic.variance, left.squaredNorm() * scale, 1e-8 * cubic.variance + 1e-14);
    for (std::size_t i = 0; i < count; ++i)
      ASSERT_NEAR(cubic.residuals[i], left[static_cast<Eigen::Index>(i)], 1e-7) << i;
  }
}

/** Variance of heights of a plane's noise, 1, in a ball about a point of it: the mean over the
 * point's own height, and at each height as many points as the ball's disc there is wide. */
double varianceInBall(double radius) {
  constexpr double kStep = 0.01, kFar = 6;
  double all = 0, weights = 0;
  for (double own = -4; own <= 4; own += 0.05) {
    double sum[3] = {0, 0, 0};
    for (double h = -kFar; h <= kFar; h += kStep) {
      const double points =
          std::exp(-0.5 * h * h) * std::max(0.0, radius * radius - (h - own) * (h - own));
      for (int i = 0; i < 3; ++i) sum[i] += points * std::pow(h, i);
    }
    const double mean = sum[1] / sum[0], weight = std::exp(-0.5 * own * own);
    all += weight * (sum[2] / sum[0] - mean * mean);
    weights += weight;
  }
  return all / weights;
}

TEST(Patch, WhatABallCutsOffIsPutBack) {
  for (const double radius : {2.2, 2.5, 3.0, 4.0, 6.0, 10.0}) {
    const double left = varianceInBall(radius);
    EXPECT_LT(left, 1 - 1 / (radius * radius));
    EXPECT_NEAR(std::sqrt(uncutVariance(left, radius)), 1, 0.01) << radius;
  }
  // Of many places alike each gets the same.
  std::vector<double> variances(40, varianceInBall(3));
  restoreCutVariances(std::vector<double>(40, 3.0), {}, 1, variances);
  for (const double variance : variances) EXPECT_NEAR(std::sqrt(variance), 1, 0.01);
}

TEST(Patch, KeepsTheSheetOfItsSample) {
  Patch patch = bentPatch(100, 0.001, 0.1);
  const std::size_t own = patch.points.size();
  const Eigen::Vector3d apart = 0.5 * principalAxes(patch.points).eigenvectors().col(0);
  Patch both = patch;
  both.points.resize(2 * own);
  for (std::size_t i = 0; i < own; ++i) {
    both.points.set(i, patch.points.at(i));
    both.points.set(own + i, patch.points.at(i) + apart);
  }
  both.radius = 2;
  ASSERT_TRUE(keepOwnSheet({}, both));
  ASSERT_EQ(both.points.size(), own);
  for (std::size_t i = 0; i < own; ++i) EXPECT_EQ(both.points.at(i), patch.points.at(i));
  EXPECT_NEAR(both.radius, patch.radius, 1e-12);
  EXPECT_FALSE(keepOwnSheet({}, patch));
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Positions and normals fitted together.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "least_squares/dense.h"
#include "least_squares/least_squares.h"
#include "scan/ball_kernels.h"
#include "support/clouds.h"
#include "support/plane_normals.h"

namespace pcl_slim {

using namespace detail;

namespace {

using measure::Shape;
using namespace pcl_slim_test;

/** Random heights, slopes and weights of slopes over the unit disc: nothing fits them exactly. */
BallBuffer randomBall(std::size_t count, double slope_weight) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-1.0f, 1.0f);
  BallBuffer ball;
  ball.reserve(count);
  ball.reserveNormals();
  ball.slope_weight = slope_weight;
  while (ball.count < count) {
    const float u = place(random), v = place(random), w = 0.1f * place(random);
    if (u * u + v * v + w * w >= 1.0f) continue;
    const std::size_t i = ball.count++;
    ball.u[i] = u;
    ball.v[i] = v;
    ball.w[i] = w;
    ball.s_sq[i] = u * u + v * v + w * w;
    ball.n_u[i] = 0.3f * place(random);
    ball.n_v[i] = 0.3f * place(random);
    ball.n_w[i] = 0.6f + 0.4f * place(random);
  }
  for (std::size_t i = count; i < count + BallBuffer::kPadding; ++i) {
    ball.u[i] = ball.v[i] = ball.w[i] = ball.n_u[i] = ball.n_v[i] = ball.n_w[i] = 0.0f;
    ball.s_sq[i] = 2.0f;
  }
  return ball;
}

struct Reference {
  Eigen::VectorXd c;
  double residual_sq, slope_misfit, terms;
};

/** The same problem in double: three rows a point, solved by QR; terms by the matrices themselves.
 */
Reference reference(const BallBuffer& ball, int degree, double rho, WeightKernel kernel) {
  const int terms = numCoefficients(degree);
  const auto n = static_cast<Eigen::Index>(ball.count);
  Eigen::MatrixXd heights(n, terms), slopes(2 * n, terms);
  Eigen::VectorXd z(n), s(2 * n);
  double weight = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto p = static_cast<std::size_t>(i);
    const double u = ball.u[p], v = ball.v[p];
    const double w = evaluateKernel(kernel, ball.s_sq[p] / (rho * rho));
    const double root = std::sqrt(w), slope_root = std::sqrt(w * ball.slope_weight * ball.n_w[p]);
    weight += w;
    for (int d = 0, k = 0; d <= degree; ++d) {
      for (int j = 0; j <= d; ++j, ++k) {
        heights(i, k) = root * std::pow(u, d - j) * std::pow(v, j);
        slopes(2 * i, k) =
            d - j > 0 ? slope_root * (d - j) * std::pow(u, d - j - 1) * std::pow(v, j) : 0;
        slopes(2 * i + 1, k) = j > 0 ? slope_root * j * std::pow(u, d - j) * std::pow(v, j - 1) : 0;
      }
    }
    z(i) = root * ball.w[p];
    s(2 * i) = slope_root * ball.n_u[p];
    s(2 * i + 1) = slope_root * ball.n_v[p];
  }
  Eigen::MatrixXd all(3 * n, terms);
  all << heights, slopes;
  Eigen::VectorXd values(3 * n);
  values << z, s;
  Reference r;
  r.c = solveLeastSquares(all, values);
  r.residual_sq = (z - heights * r.c).squaredNorm() / weight;
  r.slope_misfit = (s - slopes * r.c).squaredNorm() / weight;
  r.terms = solveLeastSquares(all.transpose() * all, heights.transpose() * heights).trace();
  return r;
}

TEST(NormalsAsData, FitBallAgreesWithDoubleLeastSquares) {
  for (int degree = 1; degree <= kMaxDegree; ++degree) {
    for (const double slope_weight : {0.01, 1.0, 50.0}) {
      for (const WeightKernel kernel : {WeightKernel::kPower2, WeightKernel::kPower4}) {
        const BallBuffer ball = randomBall(300, slope_weight);
        const Reference expected = reference(ball, degree, 0.9, kernel);
        for (const bool refine : {false, true}) {
          const LocalFit fit = kernels::fitBall(ball, degree, 0.9f, kernel, 1.2, refine);
          ASSERT_EQ(fit.degree, degree);
          for (int k = 0; k < numCoefficients(degree); ++k) {
            ASSERT_NEAR(fit.c[static_cast<std::size_t>(k)], expected.c[k], refine ? 2e-6 : 2e-5);
          }
          ASSERT_NEAR(fit.residual_sq / expected.residual_sq, 1.0, 1e-4);
          ASSERT_NEAR(fit.slope_misfit / expected.slope_misfit, 1.0, 1e-4);
          ASSERT_NEAR(fit.terms / expected.terms, 1.0, 1e-4);
        }
      }
    }
  }
}

TEST(NormalsAsData, SlopesAreThoseOfThePolynomialTheNormalsBelongTo) {
  // h = .3 u - .2 v + .5 u v in a tilted frame, normals (-h_u, -h_v, 1) turned into the world.
  const LocalFrame frame({0.36, -0.48, 0.8});
  BallBuffer ball;
  ball.reserve(50);
  ball.reserveNormals();
  ball.slope_weight = 1.0;
  std::vector<std::array<double, 2>> slopes;
  const double radius = 2.0;
  for (int i = 0; i < 50; ++i) {
    const double u = 0.6 * std::cos(i), v = 0.6 * std::sin(2.0 * i);
    const double hu = 0.3 + 0.5 * v, hv = -0.2 + 0.5 * u, h = 0.3 * u - 0.2 * v + 0.5 * u * v;
    const double length = std::sqrt(1 + hu * hu + hv * hv);
    const std::size_t p = ball.count++;
    AlignedVector<float>*places[] = {&ball.u, &ball.v, &ball.w},
    *normals[] = {&ball.n_u, &ball.n_v, &ball.n_w};
    for (std::size_t a = 0; a < 3; ++a) {
      (*places[a])[p] =
          static_cast<float>(radius * (u * frame.u[a] + v * frame.v[a] + h * frame.w[a]));
      (*normals[a])[p] =
          static_cast<float>((-hu * frame.u[a] - hv * frame.v[a] + frame.w[a]) / length);
    }
    ball.s_sq[p] = 0.5f;
    slopes.push_back({hu, hv});
  }
  kernels::toFrame(frame, static_cast<float>(radius), ball);
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    const auto [hu, hv] = slopes[i];
    EXPECT_NEAR(ball.n_u[i], hu, 1e-5);
    EXPECT_NEAR(ball.n_v[i], hv, 1e-5);
    EXPECT_NEAR(ball.n_w[i], std::pow(1 + hu * hu + hv * hv, -1.5), 1e-5);
  }
}

/** Errors of a fit to 30,000 noisy points whose normals are off by so much an axis. */
pcl_slim_test::Errors errorsWith(Shape shape, double noise, double per_axis, bool data) {
  FitParams params;
  params.normals_as_data = data;
  const auto f = fitted(sceneCloud(shape, 30000, noise, per_axis), params, true);
  expectSound(f);
  EXPECT_EQ(f.statistics.noise.normal_error > 0, data);
  return errorsOf(shape, f);
}

TEST(NormalsAsData, GoodOnesHelpAndBadOnesDoNoHarm) {
  for (const Shape shape : {Shape::kTorus, Shape::kBumpy, Shape::kRelief}) {
    const auto without = errorsWith(shape, 0.005, 0.05, false);
    const auto with = errorsWith(shape, 0.005, 0.05, true);
    EXPECT_LT(with.position, 0.6 * without.position);
    EXPECT_LT(with.normal, 0.5 * without.normal);
    EXPECT_LT(with.curvature, 0.6 * without.curvature);
    const auto bad = errorsWith(shape, 0.001, 0.3, false),
               used = errorsWith(shape, 0.001, 0.3, true);
    EXPECT_LT(used.position, 1.03 * bad.position);
    EXPECT_LT(used.normal, 1.05 * bad.normal);
  }
}

TEST(NormalsAsData, ThoseThatRepeatThePointsAreLeftAside) {
  const Cloud cloud = withPlaneNormals(sceneCloud(Shape::kTorus, 20000, 0.002), 15);
  FitParams params;
  const auto plain = fitted(cloud, params);
  params.normals_as_data = true;
  const auto asked = fitted(cloud, params);
  EXPECT_TRUE(asked.statistics.noise.normals_follow_points);
  EXPECT_EQ(asked.statistics.noise.normal_error, 0.0);
  EXPECT_EQ(asked.surface.coefficients, plain.surface.coefficients);
  params.normal_error = 0.1;
  const auto insisted = fitted(cloud, params);
  EXPECT_FALSE(insisted.statistics.noise.normals_follow_points);
  EXPECT_EQ(insisted.statistics.noise.normal_error, 0.1);
  EXPECT_NE(insisted.surface.coefficients, plain.surface.coefficients);
}

TEST(NormalsAsData, AsksForWhatMakesSense) {
  const auto messageOf = [](const Cloud& cloud, const FitParams& params) {
    SLIMSurface surface;
    return fitSurface(storeOf(cloud), params, surface).message;
  };
  const Cloud cloud = sceneCloud(Shape::kSphere, 2000, 0.001, 0.05);
  FitParams params;
  params.normals_as_data = true;
  EXPECT_EQ(messageOf(cloud, params), "");
  EXPECT_NE(messageOf(cloud.withoutNormals(), params).find("no normals"), std::string::npos);
  FitParams with_t = params, paper = params, stray, wild = params;
  with_t.size = MDLThreshold{0.01};
  paper.paper_mode = true;
  stray.normal_error = 0.1;
  wild.normal_error = 2.0;
  for (const FitParams& bad : {with_t, paper, stray, wild}) EXPECT_TRUE(bad.validate());
  wild.normal_error = std::nan("");
  EXPECT_TRUE(wild.validate());
}

}  // namespace
}  // namespace pcl_slim

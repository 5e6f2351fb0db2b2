// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of the principal curvatures along their own directions, on a spheroid.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/clouds.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

constexpr double kA = 1.0, kB = 1.6;  // semi-axes: across and along z

Cloud spheroid(std::size_t count) {
  std::mt19937_64 rng(5);
  std::normal_distribution<double> gauss;
  Cloud cloud;
  while (cloud.size() < count) {
    const double x = gauss(rng), y = gauss(rng), z = gauss(rng);
    const double r = std::sqrt(x * x + y * y + z * z);
    const std::array<double, 3> p = {kA * x / r, kA * y / r, kB * z / r};
    const std::array<double, 3> g = {p[0] / (kA * kA), p[1] / (kA * kA), p[2] / (kB * kB)};
    const double length = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    cloud.add(p, {g[0] / length, g[1] / length, g[2] / length});
  }
  return cloud;
}

/** Of the meridian through height z: curvature a b / m^3, derivative 3 a b (b^2 - a^2) s c / m^6.
 */
double meridianDerivative(double z) {
  const double s = z / kB, c = std::sqrt(std::max(0.0, 1.0 - s * s));
  const double m_sq = kA * kA * s * s + kB * kB * c * c;
  return 3 * kA * kB * (kB * kB - kA * kA) * s * c / (m_sq * m_sq * m_sq);
}

Projection projected(const Fitted& f, const ProjectionParams& params) {
  Projection projection;
  const Error error = projectPoints(f.store, f.surface, params, projection);
  EXPECT_FALSE(error) << error.message;
  return projection;
}

TEST(Extremality, OfASpheroidIsItsMeridiansAndNoneAlongParallels) {
  const Fitted f = fitted(spheroid(20000));
  ProjectionParams params;
  params.extremality = true;
  const Projection projection = projected(f, params);
  ASSERT_EQ(projection.principal.size(), f.store.size()) << "extremality implies directions";
  double error_sq = 0, truth_sq = 0, parallel_sq = 0;
  for (std::size_t i = 0; i < f.store.size(); ++i) {
    const double z = f.store.origin()[2] + f.store.scale() * projection.position[i][2];
    if (std::abs(z) > 0.9 * kB) continue;  // near the poles both curvatures are equal
    const double per_length_sq = 1.0 / (f.store.scale() * f.store.scale());
    const double truth = std::abs(meridianDerivative(z));
    const double found = std::abs(projection.principal[i].extremality2) * per_length_sq;
    error_sq += (found - truth) * (found - truth);
    truth_sq += truth * truth;
    parallel_sq += std::pow(projection.principal[i].extremality1 * per_length_sq, 2);
  }
  EXPECT_LT(std::sqrt(error_sq / truth_sq), 0.02);
  EXPECT_LT(std::sqrt(parallel_sq / truth_sq), 0.02);
}

TEST(Extremality, IsAbsentUnlessAsked) {
  const Fitted f = fitted(spheroid(3000));
  ProjectionParams params;
  params.directions = true;
  const Projection projection = projected(f, params);
  for (const PrincipalFrame& frame : projection.principal) {
    ASSERT_EQ(frame.extremality1, 0.0f);
    ASSERT_EQ(frame.extremality2, 0.0f);
  }
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Equation (8): blended derivatives against those of the partition of unity.
#include <gtest/gtest.h>

#include <cmath>

#include "pcl_slim/core/vector3.h"
#include "support/clouds.h"
#include "support/lab/reference/partition_of_unity.h"

namespace pcl_slim {
namespace {

using measure::Shape;
using namespace pcl_slim_test;
using lab::ImplicitJet;
using lab::PartitionOfUnity;

class PartitionOfUnityKernels : public testing::TestWithParam<WeightKernel> {};

TEST_P(PartitionOfUnityKernels, DerivativesAreThoseOfItsValue) {
  Fitted f = fitted(sceneCloud(Shape::kTorus, 4000, 0.001));
  f.surface.info.blend_kernel = GetParam();
  const PartitionOfUnity unity(f.surface);
  const double step = 1e-6;
  int compared = 0;
  for (std::size_t i = 0; i < f.store.size(); i += 97) {
    const auto x = f.store.position(i);
    ImplicitJet jet;
    if (!unity.evaluate(x, jet)) continue;
    for (int a = 0; a < 3; ++a) {
      auto above = x, below = x;
      above[a] += step;
      below[a] -= step;
      ImplicitJet up, down;
      ASSERT_TRUE(unity.evaluate(above, up));
      ASSERT_TRUE(unity.evaluate(below, down));
      EXPECT_NEAR(jet.gradient[a], (up.value - down.value) / (2 * step), 1e-5);
      const SymmetricEntry diagonal[3] = {kXX, kYY, kZZ};
      const double second = (up.gradient[a] - down.gradient[a]) / (2 * step);
      EXPECT_NEAR(jet.hessian[diagonal[a]], second, 1e-3 * (1 + std::abs(second)));
    }
    ++compared;
  }
  EXPECT_GT(compared, 30);
}

INSTANTIATE_TEST_SUITE_P(All, PartitionOfUnityKernels,
                         testing::Values(WeightKernel::kPower2, WeightKernel::kPower4,
                                         WeightKernel::kPower7, WeightKernel::kGaussian));

TEST(PartitionOfUnity, LosesToBlendedDerivativesAtLowNoise) {
  const Fitted f = fitted(sceneCloud(Shape::kBumpy, 20000, 0.0001));
  ProjectionParams params;
  params.curvature = true;
  Projection projection;
  const Error error = projectPoints(f.store, f.surface, params, projection);
  ASSERT_FALSE(error) << error.message;
  const PartitionOfUnity unity(f.surface);
  double blended_normal = 0, unity_normal = 0, blended_curvature = 0, unity_curvature = 0;
  for (std::size_t i = 0; i < f.store.size(); ++i) {
    ImplicitJet jet;
    if (!projection.supported[i] || !unity.evaluate(projection.position[i], jet)) continue;
    std::array<double, 3> world;
    for (int a = 0; a < 3; ++a) {
      world[a] = f.store.origin()[a] + f.store.scale() * projection.position[i][a];
    }
    const measure::Truth truth = measure::truthAt(Shape::kBumpy, world);
    const auto& g = jet.gradient;
    const double length = std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
    double unity_dot = 0, blended_dot = 0;
    for (int a = 0; a < 3; ++a) {
      unity_dot += g[a] / length * truth.normal[a];
      blended_dot += projection.normal[i][a] * truth.normal[a];
    }
    unity_normal += 1 - unity_dot;
    blended_normal += 1 - blended_dot;
    const auto& h = jet.hessian;
    const double ghg = dot(g, multiplied(h, g));
    const double mean =
        (h[kXX] + h[kYY] + h[kZZ] - ghg / (length * length)) / (2 * length) / f.store.scale();
    const double blended = projection.curvature[i][0] / f.store.scale();
    unity_curvature += (mean - truth.mean_curvature) * (mean - truth.mean_curvature);
    blended_curvature += (blended - truth.mean_curvature) * (blended - truth.mean_curvature);
  }
  EXPECT_LT(blended_normal, unity_normal);
  EXPECT_LT(blended_curvature, unity_curvature);
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Two leaves disagree about a point: how much each counts.
#include <gtest/gtest.h>

#include <cmath>

#include "support/clouds.h"
#include "support/lab/reference/partition_of_unity.h"

namespace pcl_slim {
namespace {

constexpr float kSurfelRadius = 0.125f,
                kSurfelOffset = 0.0125f;  // local units; a tenth of the radius

/** Two level leaves about the store's origin, the second kSurfelOffset above the first. */
SLIMSurface twoLeaves(const PointStore& store, float error, float other_error, double noise) {
  SLIMSurface surface;
  surface.info.degree = 1;
  surface.info.oriented = true;
  surface.info.origin = store.origin();
  surface.info.scale = store.scale();
  surface.info.diagonal = store.diagonal();
  surface.info.lambda = std::pow(noise / store.diagonal(), 2);
  surface.resize(2);
  for (std::size_t i = 0; i < 2; ++i) {
    surface.cx[i] = surface.cy[i] = surface.cz[i] = surface.nx[i] = surface.ny[i] = 0;
    surface.nz[i] = 1;
    surface.radius[i] = kSurfelRadius;
    surface.degree[i] = 1;
    surface.flags[i] = kSurfelLeaf;
  }
  surface.error = {error, other_error};
  surface.coefficients[static_cast<std::size_t>(surface.stride())] = kSurfelOffset / kSurfelRadius;
  return surface;
}

/** How far the point nearest to the leaves' centre is lifted, local units. */
double lift(const PointStore& store, SLIMSurface surface, bool paper) {
  surface.info.paper_mode = paper;
  Projection projection;
  EXPECT_FALSE(projectPoints(store, surface, {}, projection));
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < store.size(); ++i) {
    const auto p = store.position(i), q = store.position(nearest);
    if (std::hypot(p[0], p[1]) < std::hypot(q[0], q[1])) nearest = i;
  }
  EXPECT_LT(std::hypot(store.position(nearest)[0], store.position(nearest)[1]),
            0.1 * kSurfelRadius);
  return projection.position[nearest][2] - store.position(nearest)[2];
}

class ProjectionVarianceWeight : public testing::Test {
 protected:
  PointStore store_ = pcl_slim_test::storeOf(
      pcl_slim_test::heightField(4000, 5, [](double, double) { return 0.0; }));
};

TEST_F(ProjectionVarianceWeight, LeavesThatFitDownToTheNoiseCountAlike) {
  const double share = lift(store_, twoLeaves(store_, 0.02f, 0.02f, 0.02), false) / kSurfelOffset;
  EXPECT_NEAR(share, 0.49, 0.01);  // the second's root is a little farther from its centre
}

TEST_F(ProjectionVarianceWeight, ALeafThatDoesNotFitCountsByItsVariance) {
  const double noise = 0.004, good = 0.004, bad = 0.02;
  const double variance = noise * noise + std::pow(1e-3 * kSurfelRadius, 2);
  const double first = variance / (variance + good * good);
  const double second = 0.97 * variance / (variance + bad * bad);  // 0.97: as above
  const auto surface = twoLeaves(store_, static_cast<float>(good), static_cast<float>(bad), noise);
  EXPECT_NEAR(lift(store_, surface, false) / kSurfelOffset, second / (first + second), 0.005);
  EXPECT_NEAR(lift(store_, surface, true) / kSurfelOffset, 0.49, 0.01)
      << "as printed, it counts in full";
}

TEST_F(ProjectionVarianceWeight, ThePartitionOfUnityWeighsAlike) {
  const double noise = 0.004, good = 0.004, bad = 0.02;
  SLIMSurface surface = twoLeaves(store_, static_cast<float>(good), static_cast<float>(bad), noise);
  // Both weigh alike at their common centre but for what they leave: f is 0 and -kSurfelOffset there.
  const auto share = [&] {
    lab::ImplicitJet jet;
    EXPECT_TRUE(lab::PartitionOfUnity(surface).evaluate({0, 0, 0}, jet));
    return -jet.value / kSurfelOffset;
  };
  const double variance = noise * noise + std::pow(1e-3 * kSurfelRadius, 2);
  const double first = variance / (variance + good * good);
  const double second = variance / (variance + bad * bad);
  EXPECT_NEAR(share(), second / (first + second), 1e-4);
  surface.info.paper_mode = true;
  EXPECT_NEAR(share(), 0.5, 1e-4);
}

TEST_F(ProjectionVarianceWeight, ExactFitsAreNotToldApartByRounding) {
  const double share = lift(store_, twoLeaves(store_, 0.02f, 0.02f, 0), false) / kSurfelOffset;
  EXPECT_NEAR(share, 0.49, 0.01);
  // Both far below a thousandth of the radius, a hundred times apart.
  SLIMSurface exact = twoLeaves(store_, 1e-6f, 1e-8f, 0);
  exact.coefficients[static_cast<std::size_t>(exact.stride())] = 1e-5f;
  EXPECT_NEAR(lift(store_, exact, false) / (1e-5 * kSurfelRadius), 0.5, 0.01);
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Equation (8), left against right, in pictures.
#include <gtest/gtest.h>

#include "support/lab/reference/partition_of_unity.h"
#include "unit/render/sphere_view.h"

namespace pcl_slim::test {
namespace {

/** \brief A sphere whose leaves are planes or quadrics that miss it by a little. */
SLIMSurface roughSphere(int degree) {
  return sphereSurface(degree, kSphere, 600, 0.07);
}

/** \brief A frame with the derivatives of the surface's partition of unity. */
GBuffer inSpace(const SLIMSurface& surface, GBuffer frame) {
  const Error error = lab::differentiateInSpace(surface, 0, frame);
  EXPECT_FALSE(error) << error.message;
  return frame;
}

TEST(SpaceDerivatives, BothSidesTellASphere) {
  const SLIMSurface surface = roughSphere(4);
  const GBuffer frame = rendered(surface, frontCamera());
  const auto left = compareWithSphere(frame, frontCamera(), kSphere);
  const auto right = compareWithSphere(inSpace(surface, frame), frontCamera(), kSphere);
  EXPECT_EQ(left.covered, right.covered);
  EXPECT_LT(right.normal, 2e-3);
  EXPECT_LT(right.mean, 0.05);
}

TEST(SpaceDerivatives, OnlyTheRightSideHoldsTheWeights) {
  // Planes have no curvature of their own: what the right side shows is the weights' doing.
  const SLIMSurface planes = roughSphere(1);
  const GBuffer left = rendered(planes, frontCamera());
  const GBuffer right = inSpace(planes, left);
  const std::size_t middle = left.index(40, 30);
  ASSERT_TRUE(left.covered(middle));
  EXPECT_NEAR(left.mean_curvature[middle], 0.0, 1e-3);
  EXPECT_GT(std::abs(right.mean_curvature[middle]), 0.5);
  EXPECT_EQ(left.depth, right.depth);
  EXPECT_EQ(left.surfel, right.surfel);
}

TEST(SpaceDerivatives, TheReferenceHasThemAsWell) {
  const SLIMSurface surface = roughSphere(2);
  const GBuffer fast = inSpace(surface, rendered(surface, frontCamera()));
  const GBuffer slow = inSpace(surface, referenceFrame(surface, frontCamera()));
  const std::size_t middle = fast.index(40, 30);
  EXPECT_NEAR(fast.mean_curvature[middle], slow.mean_curvature[middle], 0.02);
}

TEST(SpaceDerivatives, LeavesWithoutACommonSideAreRefused) {
  SLIMSurface surface = roughSphere(2);
  surface.info.oriented = false;
  GBuffer buffer = rendered(surface, frontCamera());
  EXPECT_EQ(lab::differentiateInSpace(surface, 0, buffer).code, ErrorCode::kBadArgument);
}

TEST(Residuals, AreThoseOfTheLeaves) {
  SLIMSurface surface = roughSphere(2);
  for (std::size_t i = 0; i < surface.size(); ++i) surface.error[i] = 1e-4f * (1.0f + i % 5);
  RenderParams params;
  params.columns = kResidualColumn;
  const GBuffer buffer = rendered(surface, frontCamera(), params);
  EXPECT_TRUE(buffer.radius.empty());
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    ASSERT_EQ(buffer.residual[i], buffer.covered(i) ? surface.error[buffer.surfel[i]] : 0.0f);
  }
}

}  // namespace
}  // namespace pcl_slim::test

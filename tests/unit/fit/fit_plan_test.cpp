// SPDX-License-Identifier: BSD-3-Clause
// How the plans that a user's parameters name differ from the default.
#include "fit_plan.h"

#include <gtest/gtest.h>

#include "measures/measures.h"
#include "support/clouds.h"

namespace pcl_slim {

using namespace detail;

namespace {

using measure::Shape;

FitPlan planOf(const FitParams& params) {
  const PointStore store =
      pcl_slim_test::storeOf(pcl_slim_test::sceneCloud(Shape::kSphere, 200, 0.0));
  const CloudMeasures measures = measureCloud(store, params.resolved(), FitConstants(), 1);
  return planFor(store, params.resolved(), FitConstants(), measures);
}

TEST(FitPlan, AGivenTLeavesFewerReasonsToStop) {
  FitParams params;
  params.size = MDLThreshold{0.02};
  const FitPlan t = planOf(params), plain = planOf(FitParams());
  EXPECT_LT(t.lenience, plain.lenience);
  EXPECT_GT(t.lack_of_fit, plain.lack_of_fit);
  EXPECT_LT(t.energy.thick, plain.energy.thick);
  EXPECT_FALSE(t.find_detail || t.compare_nested || t.paper);
  EXPECT_DOUBLE_EQ(t.first_radius, 0.1);
  params.paper_mode = true;
  const FitPlan paper = planOf(params);
  EXPECT_TRUE(paper.paper);
  EXPECT_EQ(paper.lack_of_fit, 0.0);
  EXPECT_EQ(paper.lenience, 1.0);
  EXPECT_DOUBLE_EQ(paper.energy.t_mdl, 0.02 * paper.diagonal);
}

TEST(FitPlan, SharpFeaturesNarrowTheStartAndTheNormalBound) {
  FitParams params;
  params.sharp_features = true;
  const FitPlan s = planOf(params), plain = planOf(FitParams());
  EXPECT_LT(s.degree, plain.degree);
  EXPECT_LT(s.energy.kappa, plain.energy.kappa);
  EXPECT_LT(s.start_share, plain.start_share);
  EXPECT_LE(plain.min_dot, 0.0f);
  EXPECT_FLOAT_EQ(s.min_dot, 0.5f);  // 60 degrees
}

TEST(FitPlan, ASurfaceStatesTheFitsOwnPenaltyByDefault) {
  EXPECT_EQ(SurfaceInfo().penalty, std::get<PenaltyWeight>(FitParams().resolved().size).kappa);
}

TEST(FitPlan, ATargetOfSurfelsTakesThePapersAlpha) {
  FitParams sized;
  sized.size = MaxSurfels{100};
  const FitPlan few = planOf(sized), plain = planOf(FitParams());
  EXPECT_EQ(few.supported_alpha, few.alpha);
  EXPECT_LT(plain.supported_alpha, plain.alpha);
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Which of the named presets a user's parameters give, and what each is.
#include "presets.h"

#include <gtest/gtest.h>

#include "support/clouds.h"

namespace pcl_slim {

using namespace detail;

namespace {

using measure::Shape;

FitSettings
settingsOf(const FitParams& params)
{
  const PointStore store =
      pcl_slim_test::storeOf(pcl_slim_test::sceneCloud(Shape::kSphere, 200, 0.0));
  return makeSettings(store, params.resolved(), FitConstants());
}

TEST(Presets, ThePaperSetsNothingRight)
{
  FitParams params;
  params.paper_mode = true;
  const FitSettings s = settingsOf(params);
  EXPECT_TRUE(s.paper);
  EXPECT_FALSE(s.energy.corrected || s.find_detail || s.compare_nested || s.skip_lone_normals);
  EXPECT_EQ(s.fit_kernel, WeightKernel::kGaussian);
  EXPECT_EQ(s.lack_of_fit, 0.0);
  EXPECT_EQ(s.residual_bound, 0.0);
  EXPECT_DOUBLE_EQ(s.energy.t_mdl, 0.01 * s.diagonal);
  EXPECT_DOUBLE_EQ(s.first_radius, 0.1);
  EXPECT_EQ(s.supported_alpha, s.alpha);
}

TEST(Presets, TheDefaultBeginsTwoLevelsWider)
{
  const FitSettings s = settingsOf(FitParams());
  EXPECT_DOUBLE_EQ(s.levelRadius(3), 0.1 * s.diagonal);
  EXPECT_TRUE(s.energy.corrected && s.find_detail && s.compare_nested && s.skip_lone_normals);
  EXPECT_EQ(s.degree, 4);
  EXPECT_EQ(s.energy.kappa, 3.0);
  EXPECT_LT(s.supported_alpha, s.alpha);
}

TEST(Presets, AGivenTLeavesFewerReasonsToStop)
{
  FitParams params;
  params.t_mdl = 0.02;
  const FitSettings t = settingsOf(params), plain = settingsOf(FitParams());
  EXPECT_LT(t.lenience, plain.lenience);
  EXPECT_GT(t.lack_of_fit, plain.lack_of_fit);
  EXPECT_LT(t.energy.thick, plain.energy.thick);
  EXPECT_FALSE(t.find_detail || t.compare_nested || t.paper);
  EXPECT_DOUBLE_EQ(t.first_radius, 0.1);
  params.paper_mode = true;
  const FitSettings paper = settingsOf(params);
  EXPECT_TRUE(paper.paper);
  EXPECT_EQ(paper.lack_of_fit, 0.0);
  EXPECT_EQ(paper.lenience, 1.0);
  EXPECT_DOUBLE_EQ(paper.energy.t_mdl, 0.02 * paper.diagonal);
}

TEST(Presets, SharpFeaturesNarrowTheStartAndTheNormalBound)
{
  FitParams params;
  params.sharp_features = true;
  const FitSettings s = settingsOf(params), plain = settingsOf(FitParams());
  EXPECT_EQ(s.degree, 2);
  EXPECT_EQ(s.energy.kappa, 1.0);
  EXPECT_EQ(s.min_dot, 0.5f);
  EXPECT_LT(s.start_share, plain.start_share);
  EXPECT_LE(plain.min_dot, 0.0f);
}

TEST(Presets, ASurfaceStatesTheFitsOwnPenaltyByDefault)
{
  EXPECT_EQ(SurfaceInfo().penalty, FitParams().resolved().penalty);
}

TEST(Presets, WhatTheUserSetsStands)
{
  FitParams params;
  params.cover_radius = 0.9;
  params.degree = 3;
  params.penalty = 5;
  const FitSettings s = settingsOf(params);
  EXPECT_EQ(s.alpha, 0.9);
  EXPECT_EQ(s.supported_alpha, 0.9);
  EXPECT_EQ(s.degree, 3);
  EXPECT_EQ(s.energy.kappa, 5.0);
  FitParams sized;
  sized.max_surfels = 100;
  const FitSettings few = settingsOf(sized);
  EXPECT_EQ(few.supported_alpha, few.alpha);
}

}  // namespace
}  // namespace pcl_slim

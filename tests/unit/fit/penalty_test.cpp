// SPDX-License-Identifier: BSD-3-Clause
// Penalties solved for: a residual or a number of leaves that the caller asked for.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "pcl_slim/surface/surface_io.h"
#include "support/clouds.h"

namespace pcl_slim {
namespace {

using measure::Shape;
using namespace pcl_slim_test;

TEST(Penalty, ReachesATargetError) {
  for (const bool normals : {true, false}) {
    for (const double noise : {0.0, 0.0003}) {
      Cloud cloud = sceneCloud(Shape::kBumpy, 10000, noise);
      if (!normals) cloud = cloud.withoutNormals();
      for (const double target : {0.0004, 0.0006}) {
        FitParams params;
        params.size = TargetError{target};
        const auto f = fitted(cloud, params);
        expectSound(f);
        EXPECT_NEAR(f.statistics.rms_error / target, 1.0, 0.05)
            << noise << (normals ? " with" : " without");
      }
    }
  }
}

TEST(Penalty, ATargetDistanceIsATargetErrorInTheCloudsUnit) {
  Cloud cloud = sceneCloud(Shape::kBumpy, 6000, 0.0003);
  for (double& value : cloud.points) value *= 1000;
  const PointStore store = storeOf(cloud);
  const double diagonal = store.diagonal() * store.scale(), target = 2;
  FitParams share, distance;
  share.size = TargetError{target / diagonal};
  distance.size = TargetDistance{target};
  const auto f = fitted(cloud, distance);
  EXPECT_NEAR(f.statistics.rms_error * diagonal, target, 0.05 * target);
  EXPECT_EQ(encodeSlim(f.surface), encodeSlim(fitted(cloud, share).surface));

  distance.size = TargetDistance{1e-6 * diagonal};
  SLIMSurface surface;
  const Error error = fitSurface(store, distance, surface);
  EXPECT_EQ(error.code, ErrorCode::kBadArgument);
  EXPECT_EQ(error.message.find("the target distance 0.00"), 0u) << error.message;
}

TEST(Penalty, ATargetBeyondTheLargestBallsIsMetByThem) {
  const Cloud cloud = sceneCloud(Shape::kBumpy, 10000, 0.0);
  FitParams params;
  params.size = TargetError{0.1};
  const auto f = fitted(cloud, params);
  expectSound(f);
  EXPECT_LT(f.statistics.rms_error, 0.1);
  EXPECT_LT(f.statistics.leaves, 400u);
}

TEST(Penalty, ALargerTargetNeedsFewerLeaves) {
  const Cloud cloud = sceneCloud(Shape::kBumpy, 10000, 0.0);
  std::uint64_t last = ~0ull;
  for (const double target : {1e-5, 1e-4, 1e-3}) {
    FitParams params;
    params.size = TargetError{target};
    const auto f = fitted(cloud, params);
    EXPECT_LT(f.statistics.leaves, last) << target;
    last = f.statistics.leaves;
  }
}

TEST(Penalty, TheFactorSolvedForRepeatsTheFit) {
  for (const double noise : {0.0, 0.0003}) {
    const Cloud cloud = sceneCloud(Shape::kBumpy, 6000, noise).withoutNormals();
    for (const bool error : {true, false}) {
      FitParams params;
      if (error)
        params.size = TargetError{0.001};
      else
        params.size = MaxSurfels{fitted(cloud).statistics.leaves / 3};
      const auto solved = fitted(cloud, params);
      EXPECT_GT(solved.statistics.noise_factor, 1.0);
      char printed[32];
      std::snprintf(printed, sizeof(printed), "%.6g", solved.statistics.noise_factor);
      FitParams again;
      again.size = NoiseFactor{std::strtod(printed, nullptr)};
      const auto repeated = fitted(cloud, again);
      EXPECT_EQ(encodeSlim(repeated.surface), encodeSlim(solved.surface)) << printed;
      EXPECT_EQ(repeated.statistics.penalty, solved.statistics.penalty);
      // The penalty alone is another fit: it does not allow larger residuals.
      FitParams penalty;
      penalty.size = PenaltyWeight{solved.statistics.penalty};
      EXPECT_NE(encodeSlim(fitted(cloud, penalty).surface), encodeSlim(solved.surface));
    }
  }
}

TEST(Penalty, SaysWhenATargetLiesBelowTheNoise) {
  const PointStore store = storeOf(sceneCloud(Shape::kBumpy, 8000, 0.002));
  FitParams params;
  params.size = TargetError{2e-4};
  SLIMSurface surface;
  const Error error = fitSurface(store, params, surface);
  EXPECT_EQ(error.code, ErrorCode::kBadArgument);
  EXPECT_NE(error.message.find("0.0002"), std::string::npos) << error.message;
  EXPECT_NE(error.message.find("noise"), std::string::npos) << error.message;
  EXPECT_TRUE(surface.empty());
}

TEST(Penalty, KeepsALimitOnSurfels) {
  for (const bool normals : {true, false}) {
    Cloud cloud = sceneCloud(Shape::kBumpy, 10000, 0.00002);
    if (!normals) cloud = cloud.withoutNormals();
    const std::uint64_t free = fitted(cloud).statistics.leaves;
    for (const std::uint64_t most : {free * 3 / 4, free / 2, free / 4}) {
      FitParams params;
      params.size = MaxSurfels{most};
      const auto f = fitted(cloud, params);
      expectSound(f);
      EXPECT_LE(f.statistics.leaves, most);
      EXPECT_GE(f.statistics.leaves, most / 2);
    }
    FitParams params;
    params.size = MaxSurfels{free};
    EXPECT_EQ(fitted(cloud, params).statistics.leaves, free);
  }
}

TEST(Penalty, SaysWhenALimitIsTooLow) {
  const PointStore store = storeOf(sceneCloud(Shape::kBumpy, 4000, 0.0));
  FitParams params;
  params.size = MaxSurfels{1};
  SLIMSurface surface;
  const Error error = fitSurface(store, params, surface);
  EXPECT_EQ(error.code, ErrorCode::kBadArgument);
  EXPECT_GT(error.message.size(), 20u);
  EXPECT_TRUE(surface.empty());
}

TEST(Penalty, SolvedForIsTheSameForAnyNumberOfThreads) {
  const PointStore store = storeOf(sceneCloud(Shape::kTorus, 6000, 0.00002));
  FitParams params;
  params.size = MaxSurfels{500};
  SLIMSurface one, four;
  params.threads = 1;
  ASSERT_FALSE(fitSurface(store, params, one));
  params.threads = 4;
  ASSERT_FALSE(fitSurface(store, params, four));
  EXPECT_EQ(one.cx, four.cx);
  EXPECT_EQ(one.coefficients, four.coefficients);
}

}  // namespace
}  // namespace pcl_slim

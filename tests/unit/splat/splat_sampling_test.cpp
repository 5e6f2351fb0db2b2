// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/splat/splat_sampling.h"

#include <limits>

#include "painted_clouds.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

TEST(SplatSampling, CoversThePaintedObject) {
  const PaintedCloud cloud = painted(60000);
  for (const RadiusRule rule :
       {RadiusRule::kDensity, RadiusRule::kNeighbors, RadiusRule::kCorner}) {
    SplatParams params = oneThread();
    params.radius = rule;
    const SplatSet splats = sampled(cloud, params);
    expectSound(splats, cloud.size());
    const HoleCheck check = holesSeen(cloud, splats, 40000);
    EXPECT_LT(check.holes(), 1e-4);
    if (rule == RadiusRule::kCorner) {
      EXPECT_GT(check.overlap, 5.0);
    } else {
      EXPECT_LT(check.overlap, 3.0);
    }
  }
}

TEST(SplatSampling, CountsRiseAsTolerancesFall) {
  const PaintedCloud cloud = painted(40000, 4.0);
  for (const bool paper : {false, true}) {
    SplatParams params = oneThread();
    params.paper_mode = paper;
    params.initial_resolution = 12;
    std::size_t last = 0;
    for (const double error : {0.3, 0.2, 0.1, 0.08, 0.04, 0.0}) {
      params.geometric_error = error;
      const std::size_t count = countOf(cloud, params);
      EXPECT_GE(count, last) << error;
      last = count;
    }
    params.geometric_error = 0.2;
    last = 0;
    for (const double error : {1.0, 0.15, 0.1, 0.05, 0.02, 0.0}) {
      params.color_error = error;
      const std::size_t count = countOf(cloud, params);
      EXPECT_GT(count, last == 0 ? 0 : last - 1) << error;
      last = count;
    }
    if (paper) {  // no tolerance and no guard: every point, but for equal neighbours
      EXPECT_GT(last, cloud.size() - 40);
    }
  }
}

TEST(SplatSampling, ColourErrorOneIsGeometryOnly) {
  const PaintedCloud cloud = painted(20000);
  SplatParams params = oneThread();
  params.color_error = 1.0;
  SplatSet with, without;
  ASSERT_FALSE(sampleSplats(cloud.view(), cloud.colors(), params, with));
  ASSERT_FALSE(sampleSplats(cloud.view(), {}, params, without));
  EXPECT_EQ(with.x, without.x);
  EXPECT_EQ(with.radius, without.radius);
  EXPECT_EQ(without.rgb, std::vector<std::uint32_t>(without.size(), 0xffffffu));
  params.color_error = 0.1;
  EXPECT_GT(countOf(cloud, params), with.size());
}

TEST(SplatSampling, TheEyeGetsMoreThanItsShare) {
  const PaintedCloud cloud = painted(60000);
  const auto eyeShare = [&](const SplatParams& params) {
    const SplatSet s = sampled(cloud, params);
    double rim = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const std::array<double, 3> p = {s.origin[0] + s.x[i], s.origin[1] + s.y[i],
                                       s.origin[2] + s.z[i]};
      const double d = std::hypot(p[0] - 0.7, p[1] - 0.4);
      rim += p[2] > 0 && std::abs(d - 0.12) < 0.02;
    }
    return rim / static_cast<double>(s.size());
  };
  SplatParams uniform = oneThread(), budget = oneThread();
  uniform.max_depth = 0;
  budget.max_splats = countOf(cloud, uniform);
  EXPECT_GT(eyeShare(budget), 1.4 * eyeShare(uniform));
}

TEST(SplatSampling, SignsOfNormalsChangeNothingButInPaperMode) {
  PaintedCloud cloud = painted(20000);
  SplatParams params = oneThread();
  params.color_error = 1.0;
  params.geometric_error = 0.1;
  const std::size_t straight = countOf(cloud, params);
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) {
    if (i / 3 % 2 == 0) cloud.normals[i] = -cloud.normals[i];
  }
  EXPECT_EQ(countOf(cloud, params), straight);
  params.paper_mode = true;
  EXPECT_GT(countOf(cloud, params), 2 * straight);
}

TEST(SplatSampling, NoisyColourDoesNotShatter) {
  const PaintedCloud noisy = painted(40000, 20.0);
  SplatParams guarded = oneThread(), bare = oneThread();
  guarded.color_error = bare.color_error = 0.05;
  bare.remove_noise = false;
  bare.min_points = 2;
  SplatStatistics statistics;
  const SplatSet splats = sampled(noisy, guarded, &statistics);
  EXPECT_LT(splats.size(), 12000u);
  EXPECT_GT(countOf(noisy, bare), 30000u);
  EXPECT_GT(statistics.color_noise, 5.0);
  // Mean colours: nearer to the paint than any point's own.
  double worst_free = 0;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    if (splats.confidence[i] < 30) continue;
    const int red = static_cast<int>(splats.rgb[i] >> 16);
    const double paint =
        std::min({std::abs(red - 240.0), std::abs(red - 220.0), std::abs(red - 20.0)});
    worst_free = std::max(worst_free, paint);
  }
  EXPECT_LT(worst_free, 16.0);
}

TEST(SplatSampling, NoiseIsMeasured) {
  PaintedCloud cloud = painted(30000);
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  const double sigma = 0.08;  // of each of a normal's two angles
  for (float& value : cloud.normals) value += static_cast<float>(sigma * normal(random));
  SplatStatistics statistics;
  sampled(cloud, oneThread(), &statistics);
  EXPECT_NEAR(statistics.normal_noise, std::sqrt(2.0) * sigma, 0.02);
  EXPECT_LT(statistics.color_noise, 0.01);
}

TEST(SplatSampling, BudgetsAreKept) {
  const PaintedCloud cloud = painted(40000);
  for (const std::uint64_t most : {1u, 50u, 1000u, 2000u, 4000u, 10000u}) {
    SplatParams params = oneThread();
    params.max_splats = most;
    SplatStatistics statistics;
    const SplatSet splats = sampled(cloud, params, &statistics);
    EXPECT_LE(splats.size(), most);
    if (most >= 1000) {
      EXPECT_GE(splats.size(), most * 98 / 100);
    }
    EXPECT_GT(statistics.tree_cells, splats.size() - 1);
  }
}

TEST(SplatSampling, MoreSplatsLowerTheError) {
  const PaintedCloud cloud = painted(40000);
  double last = 1e9;
  for (const std::uint64_t most : {500u, 1000u, 2000u, 4000u}) {
    SplatParams params = oneThread();
    params.max_splats = most;
    SplatStatistics statistics;
    sampled(cloud, params, &statistics);
    EXPECT_LT(statistics.error, last);
    last = statistics.error;
  }
}

TEST(SplatSampling, TargetErrorIsMet) {
  const PaintedCloud cloud = painted(40000);
  std::size_t last = 0;
  for (const double target : {8.0, 4.0, 2.0, 1.0}) {
    SplatParams params = oneThread();
    params.target_error = target;
    SplatStatistics statistics;
    const SplatSet splats = sampled(cloud, params, &statistics);
    EXPECT_LE(statistics.error, target);
    EXPECT_GE(statistics.error, 0.9 * target) << "more splats than needed";
    EXPECT_GT(splats.size(), last);
    last = splats.size();
  }
}

TEST(SplatSampling, NormalsAreEstimatedWhereThereAreNone) {
  const PaintedCloud cloud = painted(20000);
  SplatParams params = oneThread();
  params.viewpoint = {{0, 0, 100}};
  SplatStatistics statistics;
  const SplatSet splats = sampled(cloud, params, &statistics, false);
  EXPECT_TRUE(statistics.normals_estimated);
  expectSound(splats, cloud.size());
  EXPECT_LT(holesSeen(cloud, splats, 20000).holes(), 1e-3);
  double worst = 1.0;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const double x = splats.x[i] + splats.origin[0], y = splats.y[i] + splats.origin[1],
                 z = splats.z[i] + splats.origin[2];
    const double n[3] = {x, y / 0.64, z / 0.36};
    const double dot = n[0] * splats.nx[i] + n[1] * splats.ny[i] + n[2] * splats.nz[i];
    worst = std::min(worst, std::abs(dot) / std::hypot(n[0], n[1], n[2]));
    if (z > 0.3) {
      EXPECT_GT(splats.nz[i], 0.0f) << "faces the viewpoint";
    }
  }
  EXPECT_GT(worst, 0.9);
}

TEST(SplatSampling, PointsWithoutNormalAmongOthersStay) {
  PaintedCloud cloud = painted(20000);
  for (std::size_t i = 0; i < 3 * 4000; ++i) {
    cloud.normals[i] = i % 2 ? 0.0f : std::numeric_limits<float>::quiet_NaN();
  }
  const SplatSet splats = sampled(cloud, oneThread());
  expectSound(splats, cloud.size());
}

TEST(SplatSampling, FarCoordinatesLoseNothing) {
  SplatParams params = oneThread();
  params.initial_resolution = 20;
  const SplatSet near = sampled(painted(20000), params);
  const SplatSet far = sampled(painted(20000, 0.0, {637080.0, 4918340.0, -415.0}), params);
  ASSERT_NEAR(static_cast<double>(far.size()), static_cast<double>(near.size()), 5.0);
  EXPECT_NEAR(far.origin[1] - near.origin[1], 4918340.0, 1e-6);
  if (far.size() == near.size()) {
    for (std::size_t i = 0; i < near.size(); ++i) EXPECT_NEAR(far.x[i], near.x[i], 1e-5);
  }
}

TEST(SplatSampling, GradientFollowsTheColour) {
  PaintedCloud cloud;
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  for (int i = 0; i < 20000; ++i) {
    const double x = u(random), y = u(random);
    const int grey = static_cast<int>(std::lround(80 + 100 * x));
    cloud.add({x, y, 0.0}, {0, 0, 1}, {grey, grey, grey});
  }
  SplatParams params = oneThread();
  params.color = SplatColor::kGradient;
  params.initial_resolution = 8;
  params.color_error = 1.0;
  const SplatSet splats = sampled(cloud, params);
  ASSERT_EQ(splats.gradient.size(), splats.size());
  for (std::size_t i = 0; i < splats.size(); ++i) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      EXPECT_NEAR(splats.gradient[i][3 * channel], 100.0f, 6.0f);
      EXPECT_NEAR(splats.gradient[i][3 * channel + 1], 0.0f, 6.0f);
      EXPECT_NEAR(splats.gradient[i][3 * channel + 2], 0.0f, 1e-3f);
    }
    const int grey = static_cast<int>(splats.rgb[i] >> 16);
    EXPECT_NEAR(grey, 80 + 100 * (splats.x[i] + splats.origin[0]), 3);
  }
}

TEST(SplatSampling, PaperModeKeepsPointsAndTheirColours) {
  const PaintedCloud cloud = painted(20000, 6.0);
  SplatParams params = oneThread();
  params.paper_mode = true;
  const SplatSet splats = sampled(cloud, params);
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const std::size_t k = splats.kept[i];
    EXPECT_NEAR(splats.origin[0] + splats.x[i], cloud.points[3 * k], 1e-6);
    EXPECT_EQ(splats.rgb[i] >> 16, cloud.bgr[3 * k + 2]);
    EXPECT_EQ(splats.rgb[i] & 0xffu, cloud.bgr[3 * k]);
    EXPECT_NEAR(splats.nx[i], cloud.normals[3 * k], 1e-6f);
  }
}

}  // namespace
}  // namespace pcl_slim

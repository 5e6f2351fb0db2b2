// SPDX-License-Identifier: BSD-3-Clause
// What a fit does with clouds too small, too thin or too odd to be a surface, and with bad wishes.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "support/clouds.h"

namespace pcl_slim {
namespace {

using measure::Shape;
using namespace pcl_slim_test;

/** Fits a cloud in every mode: no crash, no NaN, and every point is covered or reported. */
void expectSurvived(const Cloud& cloud) {
  for (int mode = 0; mode < 5; ++mode) {
    for (const int degree : {1, 4}) {
      SCOPED_TRACE("mode " + std::to_string(mode) + " degree " + std::to_string(degree));
      FitParams params;
      params.degree = degree;
      params.paper_mode = mode == 1;
      if (mode == 2) params.size = MDLThreshold{0.01};
      params.robust = mode == 3;
      params.sharp_features = mode == 4;
      Error none;
      const auto f = fitted(cloud, params, true, &none);
      expectSound(f);
      EXPECT_EQ(f.statistics.leaves == 0, none.code == ErrorCode::kNoSurface);
      EXPECT_EQ(f.surface.empty(), f.statistics.leaves == 0);
      EXPECT_EQ(f.statistics.points + f.statistics.outliers, f.store.size());
      EXPECT_LE(f.statistics.uncovered, f.store.size());
      EXPECT_GE(f.statistics.unsupported, f.statistics.leaves == 0 ? f.store.size() : 0);
    }
  }
}

TEST(FitInput, SurvivesAFewPoints) {
  Cloud cloud;
  std::mt19937_64 random(61);
  std::normal_distribution<double> normal;
  for (int count = 1; count <= 24; ++count) {
    cloud.add(normal(random), normal(random), 0.1 * normal(random));
    if (count > 3 && count % 3 != 0) continue;
    SCOPED_TRACE(std::to_string(count) + " points");
    expectSurvived(cloud);
    Cloud with_normals = cloud;
    for (int i = 0; i < count; ++i) {
      with_normals.normals.insert(with_normals.normals.end(),
                                  {0.0f, 0.0f, i % 5 == 4 ? -1.0f : 1.0f});
    }
    expectSurvived(with_normals);
  }
}

TEST(FitInput, SurvivesALine) {
  Cloud line;
  for (int i = 0; i < 400; ++i) line.add(0.1 * i, 0.2 * i, -0.05 * i);
  expectSurvived(line);
  line.normals.clear();
  for (int i = 0; i < 400; ++i) line.normals.insert(line.normals.end(), {0.0f, 0.0f, 1.0f});
  expectSurvived(line);
}

std::string noSurfaceIn(const Cloud& cloud) {
  Error none;
  fitted(cloud, {}, false, &none);
  return none.message;
}

TEST(FitInput, SaysWhyPointsAreNoSurface) {
  const auto says = [](const Cloud& cloud, const char* word) {
    const std::string message = noSurfaceIn(cloud);
    EXPECT_NE(message.find(word), std::string::npos) << message;
  };
  Cloud same, line, bare;
  for (int i = 0; i < 100; ++i) same.add(3.0, 4.0, 5.0);
  for (int i = 0; i < 500; ++i) line.add(0.1 * i, 0.2 * i, -0.05 * i);
  for (int i = 0; i < 900; ++i) {
    bare.add({0.1 * (i % 30), 0.1 * (i / 30), 0.0}, {0.0, 0.0, i == 70 ? 1.0 : 0.0});
  }
  says(same, "1 distinct point is too few");
  says(line, "along lines");
  says(bare, "only 1 of the points have a usable normal");
}

/** How many points the balls of a line of count points gather, all balls together. */
std::uint64_t gatheredOnALine(int count, bool normals) {
  Cloud line;
  for (int i = 0; i < count; ++i) line.add(1.0 * i, 2.0 * i, -0.5 * i);
  for (int i = 0; i < count && normals; ++i)
    line.normals.insert(line.normals.end(), {0.0f, 0.0f, 1.0f});
  Error none;
  const auto f = fitted(line, {}, false, &none);
  EXPECT_EQ(none.code, ErrorCode::kNoSurface);
  return f.statistics.gathered;
}

TEST(FitInput, WorkOnALineGrowsLikeItsPoints) {
  for (const bool normals : {false, true}) {
    const std::uint64_t few = gatheredOnALine(2000, normals);
    const std::uint64_t many = gatheredOnALine(16000, normals);
    EXPECT_LT(many, 16 * few) << "eight times the points, a little more than eight times the work";
  }
}

TEST(FitInput, FindsANarrowBandBelowItsLength) {
  Cloud band;
  std::mt19937_64 random(63);
  std::uniform_real_distribution<double> uniform;
  for (int i = 0; i < 40000; ++i) band.add(uniform(random), 5e-4 * uniform(random), 0.0);
  const auto f = fitted(band);
  expectSound(f);
  EXPECT_LT(f.statistics.uncovered, 2000u);
}

TEST(FitInput, SurvivesEqualPoints) {
  Cloud cloud;
  for (int i = 0; i < 100; ++i) cloud.add(3.0, 4.0, 5.0);
  expectSurvived(cloud);
}

TEST(FitInput, SurvivesRegularGridsAndAnOutlierFarAway) {
  Cloud grid, solid;
  for (int i = 0; i < 900; ++i) grid.add(i % 30, i / 30, 0.0);
  for (int i = 0; i < 729; ++i) solid.add(i % 9, i / 9 % 9, i / 81);
  expectSurvived(grid);
  expectSurvived(solid);
  grid.add(1e7, 1e7, 1e7);
  expectSurvived(grid);
}

TEST(FitInput, SurvivesPureNoise) {
  Cloud cloud;
  std::mt19937_64 random(62);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 1500; ++i) {
    const double n[3] = {normal(random), normal(random), normal(random)};
    const double length = std::hypot(n[0], n[1], n[2]);
    cloud.add({normal(random), normal(random), normal(random)},
              {n[0] / length, n[1] / length, n[2] / length});
  }
  expectSurvived(cloud);
  expectSurvived(cloud.withoutNormals());
}

TEST(FitInput, AcceptsStripesAndUnevenDensity) {
  // Scan lines: dense along x, forty times sparser along y, on a gentle wave.
  Cloud stripes;
  for (int line = 0; line < 40; ++line) {
    for (int i = 0; i < 200; ++i) {
      const double x = 0.01 * i, y = 0.05 * line;
      stripes.add(x, y, 0.1 * std::sin(2.0 * x) * std::cos(1.5 * y));
    }
  }
  const auto f = fitted(stripes);
  expectSound(f);
  EXPECT_EQ(f.statistics.uncovered, 0u);
  double worst = 0;
  for (const auto& p : f.projection.position) {
    const auto q = f.world(p);
    worst = std::max(worst, std::abs(q[2] - 0.1 * std::sin(2.0 * q[0]) * std::cos(1.5 * q[1])));
  }
  EXPECT_LT(worst, 1e-3);
}

void expectRefused(const FitParams& params) {
  static const PointStore store = storeOf(sceneCloud(Shape::kSphere, 500, 0.0));
  SLIMSurface surface;
  surface.resize(3);
  const Error error = fitSurface(store, params, surface);
  EXPECT_EQ(error.code, ErrorCode::kBadArgument);
  EXPECT_GT(error.message.size(), 10u);
  EXPECT_EQ(error.message, params.validate().message);
  EXPECT_TRUE(surface.empty());
}

TEST(FitInput, RefusesBadParameters) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const auto with = [](auto FitParams::*member, auto value) {
    FitParams params;
    params.*member = static_cast<std::decay_t<decltype(params.*member)>>(value);
    expectRefused(params);
  };
  const auto sized = [](const SizeRule& size) {
    FitParams params;
    params.size = size;
    expectRefused(params);
  };
  for (const int degree : {-1, 0, 5, 400}) with(&FitParams::degree, degree);
  for (const double value : {-1.0, 0.0, nan, inf}) sized(PenaltyWeight{value});
  for (const double value : {-0.01, 0.0, nan, inf}) sized(MDLThreshold{value});
  for (const double value : {-0.01, 0.0, 1.5, 3.0, nan, inf}) sized(TargetError{value});
  for (const double value : {-0.01, 0.0, nan, inf}) sized(NoiseFactor{value});
  for (const double value : {-0.01, 0.0, nan, inf}) sized(TargetDistance{value});
  sized(MaxSurfels{0});
  for (const double value : {-1e-9, 0.0, nan, inf}) with(&FitParams::lambda, value);
  for (const double value : {-1e-9, 0.0, nan, inf}) with(&FitParams::noise, value);
  FitParams twice;
  twice.noise = 0.001;
  twice.lambda = 1e-6;
  expectRefused(twice);
  twice.lambda.reset();
  EXPECT_FALSE(twice.validate());
  twice.noise_model = {{0.001, 0, 0}};
  expectRefused(twice);
  for (const double value : {-0.5, 0.0, 1.01, nan}) with(&FitParams::cover_radius, value);
  for (const double value : {0.0, -0.1, nan, inf}) with(&FitParams::cover_threshold, value);
  for (const double value : {-1.0, 0.0, nan, inf}) with(&FitParams::least_radius, value);
  for (const double value : {-1.0, 0.0, 0.5, nan, inf}) with(&FitParams::noise_correlation, value);
  EXPECT_FALSE(FitParams().validate());
}

TEST(FitInput, RefusesAViewpointThatIsNowhere) {
  FitParams params;
  params.viewpoint = {{0, std::numeric_limits<double>::quiet_NaN(), 0}};
  expectRefused(params);
}

TEST(FitInput, RefusesAStoreWithoutPoints) {
  SLIMSurface surface;
  surface.resize(2);
  const Error error = fitSurface(PointStore(), FitParams(), surface);
  EXPECT_TRUE(error);
  EXPECT_FALSE(error.message.empty());
  EXPECT_TRUE(surface.empty());
}

TEST(FitInput, StopsWhenAsked) {
  const PointStore store = storeOf(sceneCloud(Shape::kBumpy, 8000, 0.0));
  for (int stop_at = 0; stop_at < 4; ++stop_at) {
    int reports = 0;
    Progress* self = nullptr;
    Progress progress([&](float fraction, const char* stage) {
      EXPECT_GE(fraction, 0.0f);
      EXPECT_LE(fraction, 1.0f);
      EXPECT_NE(stage, nullptr);
      if (reports++ == stop_at) self->cancel();
    });
    self = &progress;
    SLIMSurface surface;
    const Error error = fitSurface(store, FitParams(), surface, nullptr, &progress);
    if (stop_at >= reports) break;  // the fit was done before
    EXPECT_EQ(error.code, ErrorCode::kCancelled) << stop_at;
    EXPECT_TRUE(surface.empty());
    EXPECT_TRUE(surface.children.empty());
    ASSERT_EQ(reports, stop_at + 1);
  }
  Progress cancelled;
  cancelled.cancel();
  SLIMSurface surface;
  EXPECT_EQ(fitSurface(store, FitParams(), surface, nullptr, &cancelled).code,
            ErrorCode::kCancelled);
  cancelled.reset();
  EXPECT_FALSE(fitSurface(store, FitParams(), surface, nullptr, &cancelled));
  EXPECT_FALSE(surface.empty());
}

TEST(FitInput, StopsASearchForAPenaltyToo) {
  const PointStore store = storeOf(sceneCloud(Shape::kBumpy, 4000, 0.001));
  FitParams params;
  params.size = MaxSurfels{60};
  Progress progress;
  progress.cancel();
  SLIMSurface surface;
  EXPECT_EQ(fitSurface(store, params, surface, nullptr, &progress).code, ErrorCode::kCancelled);
  EXPECT_TRUE(surface.empty());
}

}  // namespace
}  // namespace pcl_slim

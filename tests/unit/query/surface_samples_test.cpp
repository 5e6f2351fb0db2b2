// SPDX-License-Identifier: BSD-3-Clause
// Samples of a surface: where they are, how far apart, how many, and where there are none.
#include "pcl_slim/query/surface_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/clouds.h"

namespace pcl_slim {
namespace {

using measure::Shape;
using pcl_slim_test::Cloud;

/** A fitted sphere of radius 2 about (10, 0, 0), without what is above z = top. */
SLIMSurface sphere(double top, bool trim) {
  Cloud cloud;
  for (int i = 0; i < 8000; ++i) {
    const double z = 1 - (2 * i + 1) / 8000.0, r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
    if (2 * z <= top) cloud.add(10 + 2 * r * std::cos(a), 2 * r * std::sin(a), 2 * z);
  }
  FitParams params;
  params.trim = trim;
  return pcl_slim_test::fitted(cloud, params).surface;
}

SurfaceSamples sampled(const SLIMSurface& surface, double spacing, std::uint64_t count,
                       int threads = 0) {
  SurfaceSampleParams params;
  params.spacing = spacing;
  params.count = count;
  params.threads = threads;
  SurfaceSamples samples;
  const Error error = sampleSurface(surface, params, samples);
  EXPECT_FALSE(error) << error.message;
  return samples;
}

double distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

double nearest(const SurfaceSamples& samples, const std::array<double, 3>& p, std::size_t but) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < samples.size(); ++j) {
    if (j != but) least = std::min(least, distance(samples.position[j], p));
  }
  return least;
}

TEST(SurfaceSamples, AreOnTheSurfaceNoNearerThanTheSpacingAndLeaveNoGap) {
  const SurfaceSamples samples = sampled(sphere(2, false), 0.2, 0);
  // Discs laid at random jam at .547 of the area (Feder, J. Theor. Biol. 1980): 870; a grid of
  // candidates leaves out some.
  ASSERT_GT(samples.size(), 700u);
  ASSERT_LT(samples.size(), 900u);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto& p = samples.position[i];
    const auto& n = samples.normal[i];
    ASSERT_NEAR(std::hypot(p[0] - 10, p[1], p[2]), 2, 1e-3);
    ASSERT_NEAR(std::abs((p[0] - 10) * n[0] + p[1] * n[1] + p[2] * n[2]), 2, 1e-2);
    ASSERT_NEAR(std::abs(samples.curvature[i][0]), 0.5, 0.02);
    ASSERT_NEAR(samples.curvature[i][1], 0.25, 0.02);
    ASSERT_GE(nearest(samples, p, i), 0.2);
  }
  // Any place has a sample within the spacing and the width of the candidates' grid.
  for (int i = 0; i < 500; ++i) {
    const double z = 1 - (2 * i + 1) / 500.0, r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
    const std::array<double, 3> p = {10 + 2 * r * std::cos(a), 2 * r * std::sin(a), 2 * z};
    ASSERT_LE(nearest(samples, p, samples.size()), 0.2 + 0.1);
  }
}

TEST(SurfaceSamples, AreAsManyAsAskedFor) {
  const SLIMSurface surface = sphere(2, false);
  for (const std::uint64_t count : {1u, 2u, 10u, 500u, 5000u}) {
    const SurfaceSamples samples = sampled(surface, 0, count);
    ASSERT_EQ(samples.size(), count);
    for (std::size_t i = 0; i < samples.size(); i += 7)
      ASSERT_GE(nearest(samples, samples.position[i], i), samples.spacing);
    if (count == 5000) {
      EXPECT_NEAR(samples.spacing, 2 * std::sqrt(4 * M_PI / (0.82 * 5000 * M_PI)), 0.1);
    }
  }
}

/** Where the number of samples varies more than the surplus that is thinned, as the seed shows. */
TEST(SurfaceSamples, AreAsManyForEverySeed) {
  Cloud cloud;
  for (int i = 0; i < 20000; ++i) {
    const double z = (i + 0.5) / 20000, r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
    const auto rounded = [](double value) { return 1e-6 * std::round(1e6 * value); };
    cloud.add(rounded(5 * r * std::cos(a)), rounded(5 * r * std::sin(a)), rounded(5 * z));
  }
  const SLIMSurface surface = pcl_slim_test::fitted(cloud.withoutNormals(), {}).surface;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SurfaceSampleParams params;
    params.count = 400;
    params.seed = seed;
    SurfaceSamples samples;
    const Error error = sampleSurface(surface, params, samples);
    EXPECT_FALSE(error) << error.message << " seed " << seed;
    EXPECT_EQ(samples.size(), params.count);
  }
}

TEST(SurfaceSamples, EndWhereTheDataEnd) {
  const SLIMSurface open = sphere(1, true);
  const SurfaceSamples samples = sampled(open, 0.1, 0);
  ASSERT_GT(samples.size(), 1000u);
  double highest = -2;
  for (const auto& p : samples.position) highest = std::max(highest, p[2]);
  EXPECT_LT(highest, 1.1);
  EXPECT_GT(highest, 0.9);
}

TEST(SurfaceSamples, AreTheSameForAnyNumberOfThreadsAndOtherForAnotherSeed) {
  const SLIMSurface surface = sphere(2, false);
  const SurfaceSamples one = sampled(surface, 0.3, 0, 1), four = sampled(surface, 0.3, 0, 4);
  EXPECT_EQ(one.position, four.position);
  EXPECT_EQ(one.normal, four.normal);
  SurfaceSampleParams params;
  params.spacing = 0.3;
  params.seed = 9;
  SurfaceSamples other;
  ASSERT_FALSE(sampleSurface(surface, params, other));
  EXPECT_NE(other.position, one.position);
}

/** The two sides of a sheet thinner than the spacing have samples each, as if there were one. */
TEST(SurfaceSamples, SheetsThatFaceApartDoNotHinderEachOther) {
  Cloud cloud;
  for (int k = 0; k < 60 * 60; ++k) {
    for (const double side : {-1.0, 1.0}) {
      cloud.add(0.02 * (k % 60), 0.02 * (k / 60), 0.03 * side);
      cloud.normals.insert(cloud.normals.end(), {0, 0, static_cast<float>(side)});
    }
  }
  const SLIMSurface surface = pcl_slim_test::fitted(cloud, {}).surface;
  const SurfaceSamples samples = sampled(surface, 0.1, 0);
  std::size_t above = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    above += samples.position[i][2] > 0;
    for (std::size_t j = 0; j < i; ++j) {
      if ((samples.normal[i][2] > 0) == (samples.normal[j][2] > 0)) {
        ASSERT_GE(distance(samples.position[i], samples.position[j]), 0.1);
      }
    }
  }
  // Of 1.18 x 1.18, at .547 of the area in discs of .05.
  EXPECT_NEAR(above, 97, 20);
  EXPECT_NEAR(samples.size() - above, 97, 20);
}

TEST(SurfaceSamples, CanBeCancelled) {
  Progress progress;
  progress.cancel();
  SurfaceSampleParams params;
  params.count = 100;
  SurfaceSamples samples;
  const Error error = sampleSurface(sphere(2, false), params, samples, &progress);
  EXPECT_EQ(error.code, ErrorCode::kCancelled);
  EXPECT_EQ(samples.size(), 0u);
}

TEST(SurfaceSamples, BadInputIsAnError) {
  const SLIMSurface surface = sphere(2, false);
  const auto expect = [&](const SLIMSurface& of, const SurfaceSampleParams& params) {
    SurfaceSamples samples;
    samples.position.resize(3);
    const Error error = sampleSurface(of, params, samples);
    EXPECT_TRUE(error);
    EXPECT_EQ(samples.size(), 0u);
    EXPECT_FALSE(error.message.empty());
  };
  SurfaceSampleParams params;
  expect(surface, params);
  params.spacing = 0.1;
  params.count = 5;
  expect(surface, params);
  params.count = 0;
  expect(SLIMSurface(), params);
  params.spacing = std::nan("");
  expect(surface, params);
  params.spacing = 1e-9;
  expect(surface, params);
  params.spacing = 0.1;
  params.threads = -1;
  expect(surface, params);
}

}  // namespace
}  // namespace pcl_slim

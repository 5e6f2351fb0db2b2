// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/features/crest_lines.h"

#include <numeric>

#include "crest_fit.h"

namespace {

using namespace pcl_slim;
using pcl_slim_test::CrestFit;

/** Every offset, count and number of lines fits together. */
void expectSound(const CrestLines& lines) {
  const std::size_t n = lines.numVertices();
  for (const std::size_t size :
       {lines.normal.size(), lines.tangent.size(), lines.k1.size(), lines.k2.size(),
        lines.prominence.size(), lines.significance.size(), lines.radius.size()}) {
    ASSERT_EQ(size, n);
  }
  ASSERT_EQ(lines.line_begin.size(), lines.numLines() + 1);
  ASSERT_EQ(lines.line_begin.back(), n);
  for (std::size_t i = 0; i < lines.numLines(); ++i) {
    ASSERT_GE(lines.line_begin[i + 1], lines.line_begin[i] + 2);
    ASSERT_GT(lines.length[i], 0);
    if (i > 0) {
      ASSERT_LE(lines.strength[i], lines.strength[i - 1]);
    }
  }
  for (std::size_t v = 0; v < n; ++v) {
    ASSERT_GE(lines.k1[v], lines.k2[v]);
    for (const double value : lines.position[v]) ASSERT_TRUE(std::isfinite(value));
  }
}

bool sameLines(const CrestLines& a, const CrestLines& b) {
  return a.position == b.position && a.normal == b.normal && a.tangent == b.tangent &&
         a.k1 == b.k1 && a.k2 == b.k2 && a.prominence == b.prominence &&
         a.significance == b.significance && a.radius == b.radius && a.line_begin == b.line_begin &&
         a.type == b.type && a.closed == b.closed && a.length == b.length &&
         a.strength == b.strength;
}

TEST(CrestLines, AnEllipsoidHasOneThatClosesOnce) {
  const CrestFit fit("ellipsoid", 20000, 0);
  const CrestLines lines = fit.trace();
  expectSound(lines);
  ASSERT_EQ(lines.numLines(), 1u);
  EXPECT_EQ(lines.type[0], CrestType::kRidge);
  EXPECT_EQ(lines.closed[0], 1);
  // Circumference of the ellipse with axes 1 and .8, to the chords' own shortfall.
  EXPECT_NEAR(lines.length[0], 5.6723, 2e-3);
  for (std::size_t v = 0; v < lines.numVertices(); ++v) {
    // A tenth of a spacing from the ellipse's plane, and curvature as on the ellipsoid there.
    EXPECT_LT(std::abs(lines.position[v][2]), 0.1 * fit.spacing);
    EXPECT_NEAR(lines.tangent[v][2], 0, 0.05);
  }
}

TEST(CrestLines, AreFoundOnABumpySphere) {
  const CrestFit fit("bumpy", 20000, 0);
  const CrestLines lines = fit.trace();
  expectSound(lines);
  const auto score = fit.score(lines, 300);
  EXPECT_GT(score.found1, 0.98);
  EXPECT_GT(score.found3, 0.985);
  EXPECT_LT(score.off1, 0.01);
  EXPECT_LT(score.rms, 0.1);
}

TEST(CrestLines, AreFoundOnANoisyRoundedBox) {
  const CrestFit fit("box", 20000, 0.001);
  const auto score = fit.score(fit.trace(), 300);
  EXPECT_GT(score.found3, 0.98);
  EXPECT_LT(score.off3, 0.01);
  EXPECT_LT(score.rms, 0.35);
}

TEST(CrestLines, NoiseOnASphereMakesNone) {
  const CrestFit fit("sphere", 20000, 0.005);
  CrestStatistics statistics;
  EXPECT_EQ(fit.trace({}, &statistics).numLines(), 0u);
  EXPECT_GT(statistics.seeds_insignificant + statistics.insignificant, 0u);
  CrestParams all;
  all.significance = all.peak_significance = 0;
  EXPECT_GT(fit.trace(all).numLines(), 0u) << "nothing was left out";
}

TEST(CrestLines, NoiseOnATorusMakesNone) {
  // Half a radius aside k is noisy too: the larger of both sides once let this cloud's noise pass.
  EXPECT_EQ(CrestFit("torus", 20000, 0.002, 31).trace().numLines(), 0u);
}

TEST(CrestLines, AreTheSameForAnyNumberOfThreads) {
  const CrestFit fit("bumpy", 10000, 0.0005);
  CrestParams params;
  params.threads = 1;
  const CrestLines one = fit.trace(params);
  ASSERT_GT(one.numLines(), 0u);
  for (const int threads : {2, 3}) {
    params.threads = threads;
    EXPECT_TRUE(sameLines(one, fit.trace(params))) << threads;
  }
}

TEST(CrestLines, RidgesAndRavinesAreTracedApart) {
  const CrestFit fit("bumpy", 10000, 0);
  CrestParams params;
  params.ravines = false;
  const CrestLines ridges = fit.trace(params);
  params.ravines = true;
  params.ridges = false;
  const CrestLines ravines = fit.trace(params);
  for (const CrestType type : ridges.type) EXPECT_EQ(type, CrestType::kRidge);
  for (const CrestType type : ravines.type) EXPECT_EQ(type, CrestType::kRavine);
  EXPECT_EQ(fit.trace().numLines(), ridges.numLines() + ravines.numLines());
  for (const float k1 : ridges.k1) EXPECT_GT(k1, 0);
  for (const float k2 : ravines.k2) EXPECT_LT(k2, 0);
}

TEST(CrestLines, StrengthAndLengthLeaveLinesOut) {
  const CrestFit fit("bumpy", 10000, 0);
  const CrestLines all = fit.trace();
  CrestParams params;
  params.min_strength = 1;
  CrestStatistics statistics;
  const CrestLines strong = fit.trace(params, &statistics);
  EXPECT_LT(strong.numLines(), all.numLines());
  EXPECT_EQ(strong.numLines() + statistics.weak_lines, all.numLines());
  for (const double strength : strong.strength) EXPECT_GE(strength, 1);
  params = {};
  params.min_length = 5;
  const CrestLines longer = fit.trace(params, &statistics);
  EXPECT_LT(longer.numLines(), all.numLines());
  EXPECT_GT(statistics.short_lines, 0u);
}

TEST(CrestLines, TurnWithTheSurface) {
  // The normals turned round: every ridge becomes a ravine at the same place.
  CrestFit fit("bumpy", 10000, 0);
  const CrestLines before = fit.trace();
  for (std::size_t i = 0; i < fit.fit.surface.size(); ++i) fit.fit.surface.flip(i);
  pcl_slim_test::Cloud turned;
  const auto scene = measure::sampleSurface(fit.surface, 10000, 0, 0.05, 7);
  turned.points = scene.points;
  for (const float value : scene.normals) turned.normals.push_back(-value);
  fit.fit.store = pcl_slim_test::storeOf(turned);
  fit.project();
  const CrestLines after = fit.trace();
  const auto a = CrestFit::segments(before), b = CrestFit::segments(after);
  const auto score = measure::scoreLines({a[1], a[0]}, {b[0], b[1]}, fit.spacing);
  EXPECT_GT(score.found1, 0.97);
  EXPECT_LT(score.off1, 0.03);
}

TEST(CrestLines, BadArgumentsAreNamed) {
  const CrestFit fit("sphere", 2000, 0);
  CrestLines lines;
  CrestParams params;
  params.ridges = params.ravines = false;
  EXPECT_EQ(traceCrestLines(fit.fit.store, fit.fit.projection, fit.fit.surface, params, lines).code,
            ErrorCode::kBadArgument);
  for (const double step : {0.0, 0.6, std::nan("")}) {
    params = {};
    params.step = step;
    EXPECT_TRUE(params.validate());
  }
  params = {};
  params.peak_significance = 1;
  EXPECT_TRUE(params.validate());
  Projection without = fit.fit.projection;
  without.principal.clear();
  const Error error = traceCrestLines(fit.fit.store, without, fit.fit.surface, {}, lines);
  EXPECT_NE(error.message.find("extremality"), std::string::npos);
}

TEST(CrestLines, CancellingLeavesNone) {
  const CrestFit fit("bumpy", 5000, 0);
  float last = -1;
  Progress* running = nullptr;
  Progress progress([&](float fraction, const char*) {
    EXPECT_GE(fraction, last);
    last = fraction;
    if (fraction > 0.3f) running->cancel();
  });
  running = &progress;
  CrestLines lines;
  const Error error = traceCrestLines(fit.fit.store, fit.fit.projection, fit.fit.surface, {}, lines,
                                      nullptr, &progress);
  EXPECT_EQ(error.code, ErrorCode::kCancelled);
  EXPECT_EQ(lines.numLines(), 0u);
  EXPECT_LT(last, 1.0f);
}

}  // namespace

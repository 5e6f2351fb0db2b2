// SPDX-License-Identifier: BSD-3-Clause
// The constants decide: a fit made with another one is another fit, in every room of the house.
#include "fit_constants.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "pcl_slim/surface/surface_io.h"
#include "support/clouds.h"

namespace pcl_slim {

using namespace detail;

namespace {

using measure::Shape;
using pcl_slim_test::Cloud;
using pcl_slim_test::sceneCloud;

/** The surface's bytes, or why there is none: some constants leave no surface. */
std::string bytesOf(const PointStore& store, const FitParams& params,
                    const FitConstants& constants) {
  SLIMSurface surface;
  const Error error = fitWithConstants(constants, store, params, surface);
  if (error) return error.message;
  const auto bytes = encodeSlim(surface);
  return {bytes.begin(), bytes.end()};
}

struct Change {
  const char* what;
  std::function<void(FitConstants&)> apply;
};

void expectEachChanges(const Cloud& cloud, const FitParams& params,
                       const std::vector<Change>& changes) {
  const PointStore store = pcl_slim_test::storeOf(cloud);
  SLIMSurface surface;
  ASSERT_FALSE(fitSurface(store, params, surface));
  const auto encoded = encodeSlim(surface);
  const std::string usual(encoded.begin(), encoded.end());
  EXPECT_EQ(bytesOf(store, params, FitConstants()), usual) << "the library's constants";
  for (const Change& change : changes) {
    FitConstants constants;
    change.apply(constants);
    EXPECT_NE(bytesOf(store, params, constants), usual) << change.what;
  }
}

TEST(FitConstants, DecideANoisyFit) {
  expectEachChanges(
      sceneCloud(Shape::kBumpy, 6000, 0.003, 0.1), FitParams(),
      {{"degree", [](FitConstants& c) { c.preset.degree = 3; }},
       {"kappa", [](FitConstants& c) { c.preset.kappa = 2; }},
       {"lenience", [](FitConstants& c) { c.preset.lenience = 1.2; }},
       {"first neighbours", [](FitConstants& c) { c.noise.first_neighbors = 40; }},
       {"trim", [](FitConstants& c) { c.noise.trim = 0.3; }},
       {"normal bound", [](FitConstants& c) { c.normal_bound.deviations = 0; }},
       {"lone normals", [](FitConstants& c) { c.ball.lone_cosine = 0.95; }},
       {"recentring", [](FitConstants& c) { c.ball.off_center = 0.001; }},
       {"bias", [](FitConstants& c) { c.ball.bias.most_share = 0; }},
       {"first radius", [](FitConstants& c) { c.cover.first_radius = 0.2; }},
       {"start share", [](FitConstants& c) { c.cover.start_share = 0.01; }},
       {"alpha", [](FitConstants& c) { c.cover.alpha = c.cover.supported_alpha = 0.8; }},
       {"residual bound", [](FitConstants& c) { c.cover.residual_bound = 1.5; }}});
}

TEST(FitConstants, DecideACleanFit) {
  expectEachChanges(sceneCloud(Shape::kTorus, 4000, 0.0), FitParams(),
                    {{"support", [](FitConstants& c) { c.preset.support = 1.4; }},
                     {"last level", [](FitConstants& c) { c.cover.last_level = 2; }}});
}

TEST(FitConstants, DecideAFitOfTwoSheetsWithoutNormals) {
  // Two noisy planes, ten deviations apart: within one ball, and to be given a side each.
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  Cloud cloud =
      pcl_slim_test::heightField(6000, 12, [&](double, double) { return 0.002 * normal(random); });
  for (std::size_t i = 0; i < cloud.points.size(); i += 6) cloud.points[i + 2] += 0.03;
  expectEachChanges(cloud, FitParams(),
                    {{"valley", [](FitConstants& c) { c.ball.sheets.valley = 0; }},
                     {"sheets apart", [](FitConstants& c) { c.ball.sheets.apart = 1e3; }},
                     {"sheets of a patch", [](FitConstants& c) { c.noise.sheets.gap = 1e3; }}});
}

TEST(FitConstants, DecideSidesAndSizes) {
  const Cloud cloud = sceneCloud(Shape::kSphere, 4000, 0.001).withoutNormals();
  expectEachChanges(cloud, FitParams(),
                    {{"overlaps", [](FitConstants& c) { c.orient.reach = 0.01; }}});
  // No cover of a sphere leaves as much: the largest error decides.
  FitParams sized;
  sized.size = TargetError{0.01};
  expectEachChanges(
      cloud, sized,
      {{"largest error", [](FitConstants& c) { c.penalty_search.largest_error = 0.005; }}});
  sized.size = TargetError{0.003};
  expectEachChanges(sceneCloud(Shape::kBumpy, 4000, 0.0005).withoutNormals(), sized,
                    {{"covers", [](FitConstants& c) { c.penalty_search.most_covers = 1; }}});
}

}  // namespace
}  // namespace pcl_slim

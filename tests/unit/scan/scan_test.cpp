// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/scan/scan.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "pcl_slim/fit/fit_colors.h"
#include "support/clouds.h"

namespace {

using namespace pcl_slim;
using pcl_slim_test::Cloud;

Cloud bumps(double shift = 0) {
  Cloud cloud = pcl_slim_test::sceneCloud(measure::Shape::kBumpy, 4000, 1e-3);
  cloud.normals.clear();
  for (double& value : cloud.points) value += shift;
  return cloud;
}

TEST(Scan, AFitIsItsSteps) {
  const Cloud cloud = bumps();
  std::vector<std::uint8_t> bgr(3 * cloud.size());
  for (std::size_t i = 0; i < bgr.size(); ++i) bgr[i] = static_cast<std::uint8_t>(i % 251);
  const ScanView scan{cloud.view(), {bgr.data(), 3}};
  FittedScan fitted;
  ASSERT_FALSE(fitScan(scan, {}, fitted));

  PointStore store = pcl_slim_test::storeOf(cloud);
  SLIMSurface surface;
  ASSERT_FALSE(fitSurface(store, {}, surface));
  EXPECT_TRUE(surface.colors.empty());
  ASSERT_FALSE(fitColors(store, scan.points, scan.colors, 1, surface));
  EXPECT_EQ(fitted.surface.coefficients, surface.coefficients);
  EXPECT_EQ(fitted.surface.colors, surface.colors);
  EXPECT_FALSE(surface.colors.empty());
  EXPECT_EQ(fitted.store.size(), store.size());
  EXPECT_EQ(fitted.statistics.points, store.size());
}

TEST(Scan, PointsThatAreNoSurfaceKeepTheirStore) {
  Cloud line;
  for (int i = 0; i < 200; ++i) line.add(i, 2 * i, 0);
  FittedScan fitted;
  EXPECT_EQ(fitScan({line.view(), {}}, {}, fitted).code, ErrorCode::kNoSurface);
  EXPECT_EQ(fitted.store.size(), 200u);
  EXPECT_TRUE(fitted.surface.empty());
  const auto projection = projectScan(line.view(), fitted.surface, SurfaceOrigin::kFitted, {}, {},
                                      nullptr, &fitted.store);
  ASSERT_TRUE(projection) << projection.error().message;
  EXPECT_EQ(projection->statistics().unsupported, 200u);
}

TEST(Scan, BadParametersAreNamedBeforeThePoints) {
  FitParams params;
  params.degree = 9;
  FittedScan fitted;
  EXPECT_EQ(fitScan({}, params, fitted).message, params.validate().message);
  EXPECT_NE(fitScan({}, {}, fitted).message, "");
}

TEST(Scan, AGivenSurfaceMustSupportATenthOfThePoints) {
  const Cloud cloud = bumps(), other = bumps(1.9);
  FittedScan fitted;
  ASSERT_FALSE(fitScan({cloud.view(), {}}, {}, fitted));
  const auto project = [&](const Cloud& points, SurfaceOrigin origin) {
    return projectScan(points.view(), fitted.surface, origin, {}, {});
  };
  EXPECT_TRUE(project(cloud, SurfaceOrigin::kGiven));
  EXPECT_EQ(project(other, SurfaceOrigin::kGiven).error().code, ErrorCode::kBadInput);
  EXPECT_TRUE(project(other, SurfaceOrigin::kFitted));
}

TEST(Scan, LinesOfAGivenSurfaceAreThoseOfItsFit) {
  const Cloud cloud = bumps();
  TracedScan traced, again;
  ASSERT_FALSE(traceScanLines(cloud.view(), nullptr, {}, {}, traced));
  EXPECT_FALSE(traced.fitted.surface.empty());
  ASSERT_FALSE(traceScanLines(cloud.view(), &traced.fitted.surface, {}, {}, again));
  EXPECT_EQ(traced.lines.position, again.lines.position);
  EXPECT_TRUE(again.fitted.surface.empty());
  EXPECT_EQ(again.fitted.store.size(), traced.fitted.store.size());

  const Error error = traceScanLines(bumps(1.9).view(), &traced.fitted.surface, {}, {}, again);
  EXPECT_EQ(error.code, ErrorCode::kBadArgument);
  EXPECT_EQ(again.lines.numLines(), 0u);
}

}  // namespace

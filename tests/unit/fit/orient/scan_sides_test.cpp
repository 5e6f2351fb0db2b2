// SPDX-License-Identifier: BSD-3-Clause
// Sides of fitted scans whose sensor is not given, and of given normals that contradict each other.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "pcl_slim/surface/surface_io.h"
#include "support/side_scans.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

FitParams oneThreadFit() {
  FitParams params;
  params.threads = 1;
  params.trim = false;
  return params;
}

/** The share of the leaves that face a place. */
double shareFacing(const SLIMSurface& surface, const Vector3& eye) {
  double facing = 0;
  const auto leaves = surface.leaves();
  for (const std::uint32_t i : leaves) {
    const Vector3 p = along(surface.info.origin, surface.info.scale,
                            {surface.cx[i], surface.cy[i], surface.cz[i]});
    facing += dot(subtract(eye, p), {surface.nx[i], surface.ny[i], surface.nz[i]}) > 0;
  }
  return facing / static_cast<double>(leaves.size());
}

struct ScanFit {
  SLIMSurface surface;
  FitStatistics statistics;
};

ScanFit fitOf(const CloudView& view, const FitParams& params = oneThreadFit()) {
  ScanFit fit;
  const auto store = PointStore::build(view, 1);
  EXPECT_TRUE(store) << store.error().message;
  const Error error = fitSurface(*store, params, fit.surface, &fit.statistics);
  EXPECT_FALSE(error) << error.message;
  return fit;
}

Cloud movedBy(Cloud cloud, double x) {
  for (std::size_t i = 0; i < cloud.points.size(); i += 3) cloud.points[i] += x;
  return cloud;
}

TEST(ScanSides, ARoomFacesTheOriginThatItWasScannedFrom) {
  const ScanFit fit = fitOf(scannedRoom().view());
  EXPECT_EQ(fit.statistics.sides.source, SideSource::kOrigin);
  EXPECT_GT(fit.statistics.sides.overlap_edges, 0u);
  EXPECT_EQ(shareFacing(fit.surface, {0, 0, 0}), 1);
  ASSERT_TRUE(fit.statistics.sides.facing.has_value());
  EXPECT_EQ(*fit.statistics.sides.facing, 1);
  EXPECT_EQ(fit.statistics.sides.facing_origin, 1);
  EXPECT_LT(fit.statistics.sides.facing_outward, 0.01);
}

TEST(ScanSides, ARoomThatWasMovedFacesOutward) {
  for (const double shift : {3.0, 30.0}) {
    const ScanFit fit = fitOf(movedBy(scannedRoom(), shift).view());
    EXPECT_EQ(fit.statistics.sides.source, SideSource::kOutward) << shift;
    EXPECT_EQ(shareFacing(fit.surface, {shift, 0, 0}), 0) << shift;
    EXPECT_FALSE(fit.statistics.sides.facing.has_value());
    EXPECT_EQ(fit.statistics.sides.facing_outward, 1);
  }
}

TEST(ScanSides, AViewpointAndTheCloudsSensorComeBeforeTheOrigin) {
  const Cloud room = scannedRoom();
  CloudView view = room.view();
  view.sensor = std::array<double, 3>{-2, 1, 0.5};
  const ScanFit sensor = fitOf(view);
  EXPECT_EQ(sensor.statistics.sides.source, SideSource::kViewpoint);
  EXPECT_EQ(shareFacing(sensor.surface, {-2, 1, 0.5}), 1);
  FitParams params = oneThreadFit();
  params.viewpoint = {{0.5, 0, 0}};
  const ScanFit given = fitOf(view, params);
  EXPECT_EQ(given.statistics.sides.source, SideSource::kViewpoint);
  EXPECT_EQ(shareFacing(given.surface, {0.5, 0, 0}), 1);
}

TEST(ScanSides, WithoutOrientNothingDecides) {
  FitParams params = oneThreadFit();
  params.orient = false;
  const ScanFit fit = fitOf(scannedRoom().view(), params);
  EXPECT_EQ(fit.statistics.sides.source, SideSource::kNone);
  EXPECT_EQ(fit.statistics.sides.overlap_edges, 0u);
}

TEST(ScanSides, LeavesAtGrazingAnglesFollowTheirNeighbours) {
  // A floor up to 150 m away, seen from .5 m above it: beams are .2 degrees above the far end, where
  // noise tilts leaves by more.
  Cloud floor;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> gauss(0, 0.03);
  for (int i = 0; i < 30000; ++i)
    floor.addNoisy({150 * unit(random), 20 * unit(random) - 10, 0}, gauss, random);
  FitParams params = oneThreadFit();
  params.viewpoint = {{0, 0, 0.5}};
  params.lambda = 1e-10;  // leaves follow the noise
  const ScanFit fit = fitOf(floor.view(), params);
  EXPECT_EQ(fit.statistics.sides.source, SideSource::kViewpoint);
  std::size_t down = 0;
  for (const std::uint32_t i : fit.surface.leaves()) down += fit.surface.nz[i] < 0;
  EXPECT_EQ(down, 0u) << "of " << fit.surface.numLeaves();
}

TEST(ScanSides, AComponentBehindFollowsItsNeighbours) {
  // The back of a rounded edge that the scanner at the origin saw along: a wall across the view, and
  // its end, which bends away by 100 degrees. Of the end, beams show nothing or the wrong side.
  Cloud wall;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> gauss(0, 0.002);
  constexpr double kRadius = 0.5;
  for (int i = 0; i < 20000; ++i) {
    const double z = 3 * unit(random), s = 5 * unit(random);  // length along the profile
    const double bend = std::max(0.0, s - 4) / kRadius;       // up to 2 rad
    if (bend > 100 * M_PI / 180) continue;
    const double x = std::min(s, 4.0) - 4 + kRadius * std::sin(bend);
    wall.addNoisy({x, 5 + kRadius * (1 - std::cos(bend)), z - 1.5}, gauss, random);
  }
  FitParams params = oneThreadFit();
  params.viewpoint = {{0, 0, 0}};
  const ScanFit fit = fitOf(wall.view(), params);
  std::size_t wrong = 0;
  for (const std::uint32_t i : fit.surface.leaves()) {
    const Vector3 p = along(fit.surface.info.origin, fit.surface.info.scale,
                            {fit.surface.cx[i], fit.surface.cy[i], fit.surface.cz[i]});
    // The wall faces -y, its end away from the cylinder's axis.
    const Vector3 out = p[0] < 0 ? Vector3{0, -1, 0} : Vector3{p[0], p[1] - 5 - kRadius, 0};
    wrong += dot(out, {fit.surface.nx[i], fit.surface.ny[i], fit.surface.nz[i]}) < 0;
  }
  EXPECT_EQ(wrong, 0u) << "of " << fit.surface.numLeaves();
}

TEST(ScanSides, FlippedNormalsGiveTheSurfaceOfTheRightOnes) {
  const Cloud truth = sceneCloud(measure::Shape::kTorus, 8000, 0.0, 0.02);
  const auto right = encodeSlim(fitOf(truth.view()).surface);
  for (const double share : {0.01, 0.15}) {
    Cloud cloud = truth;
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    for (std::size_t i = 0; i < cloud.normals.size(); i += 3) {
      const float sign = unit(random) < share ? -1 : 1;
      for (std::size_t a = 0; a < 3; ++a) cloud.normals[i + a] *= sign;
    }
    const ScanFit fit = fitOf(cloud.view());
    EXPECT_EQ(fit.statistics.sides.source, SideSource::kNormals);
    EXPECT_TRUE(fit.statistics.sides.normals.contradicts());
    EXPECT_TRUE(encodeSlim(fit.surface) == right) << share;
  }
}

TEST(ScanSides, NormalsWithoutAxesAreNotUsed) {
  Cloud cloud = sceneCloud(measure::Shape::kSphere, 8000, 0.0005);
  std::mt19937_64 random(7);
  std::normal_distribution<double> gauss;
  for (std::size_t i = 0; i < cloud.normals.size(); i += 3) {
    const Vector3 n = normalized({gauss(random), gauss(random), gauss(random)});
    for (std::size_t a = 0; a < 3; ++a) cloud.normals[i + a] = static_cast<float>(n[a]);
  }
  const ScanFit fit = fitOf(cloud.view());
  EXPECT_EQ(fit.statistics.sides.source, SideSource::kOutward);
  EXPECT_FALSE(fit.statistics.sides.normals.hasAxes());
  EXPECT_TRUE(encodeSlim(fit.surface) == encodeSlim(fitOf(cloud.withoutNormals().view()).surface));
  EXPECT_EQ(shareFacing(fit.surface, {0, 0, 0}), 0);
}

TEST(ScanSides, OfARoomAreTheSameForAnyNumberOfThreads) {
  FitParams params = oneThreadFit();
  const auto one = encodeSlim(fitOf(scannedRoom().view(), params).surface);
  params.threads = 3;
  EXPECT_TRUE(encodeSlim(fitOf(scannedRoom().view(), params).surface) == one);
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
// Fits of scans as sensors make them: docs/sensors.md.
#include <gtest/gtest.h>

#include <cmath>

#include "support/clouds.h"
#include "support/lab/sensor.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using measure::SensorScan;

/** RMS distance of the projected points from their surfaces [m], and RMS angle [degrees]. */
struct Errors {
  double position = 0, normal = 0;
  FitStatistics fit;
};

Errors errorsOf(const SensorScan& scan, const FitParams& params = {}) {
  CloudView view;
  view.xyz = scan.points.data();
  view.xyz_stride = 3 * sizeof(float);
  view.size = scan.size();
  const auto store = PointStore::build(view);
  SLIMSurface surface;
  Projection projection;
  Errors errors;
  EXPECT_FALSE(fitSurface(*store, params, surface, &errors.fit));
  EXPECT_FALSE(projectPoints(*store, surface, {}, projection));
  double distance_sq = 0, angle_sq = 0;
  for (std::size_t i = 0; i < store->size(); ++i) {
    const int solid = scan.solid[store->orderOfStore()[i]];
    const Vector3 place = along(store->origin(), store->scale(), projection.position[i]);
    const auto foot = footOn(scan.solids[static_cast<std::size_t>(solid)], place);
    const auto& n = projection.normal[i];
    const double angle = std::acos(std::min(1.0, std::abs(dot({n[0], n[1], n[2]}, foot.normal))));
    distance_sq += foot.distance * foot.distance;
    angle_sq += angle * angle;
  }
  const auto count = static_cast<double>(store->size());
  errors.position = std::sqrt(distance_sq / count);
  errors.normal = std::sqrt(angle_sq / count) * 180 / M_PI;
  return errors;
}

measure::DepthCamera camera(int box, double step, double sigma = 0.06) {
  measure::DepthCamera camera;
  camera.correlated_x = camera.correlated_y = box;
  camera.step = step;
  camera.sigma = sigma;
  return camera;
}

FitParams withoutRecognition() {
  FitParams params;
  params.noise_correlation = 1;
  return params;
}

TEST(SensorNoise, OfDepthCamerasIsTakenOff) {
  for (const auto& made : {camera(3, 0.125), camera(1, 0.125, 0), camera(5, 0)}) {
    const SensorScan scan = scanByCamera(measure::namedSolids("wave40"), made, 3);
    const Errors on = errorsOf(scan), off = errorsOf(scan, withoutRecognition());
    EXPECT_GT(on.fit.noise.correlation, 1.0);
    EXPECT_EQ(off.fit.noise.correlation, 1.0);
    EXPECT_LT(on.position, 0.7 * off.position);
    EXPECT_LT(on.normal, 0.4 * off.normal);
  }
}

TEST(SensorNoise, StepsThatDitherCostNothing) {
  // Steps crossed within a few pixels of fine waves: taken for wide terraces they would flatten
  // these.
  const SensorScan scan = scanByCamera(measure::namedSolids("wave6"), camera(1, 0.125, 0), 3);
  const Errors on = errorsOf(scan), off = errorsOf(scan, withoutRecognition());
  EXPECT_GT(on.fit.noise.step, 0.0);
  EXPECT_LT(on.position, off.position);
  EXPECT_LT(on.normal, off.normal);
}

TEST(SensorNoise, WhiteNoiseIsRecognized) {
  const SensorScan scan = scanByCamera(measure::namedSolids("wave15"), camera(1, 0), 3);
  FitParams params;
  params.local_noise = false;
  FitParams white = withoutRecognition();
  white.local_noise = false;
  const Errors on = errorsOf(scan, params), off = errorsOf(scan, white);
  EXPECT_EQ(on.position, off.position);
  EXPECT_EQ(on.fit.lambda, off.fit.lambda);
  EXPECT_EQ(on.fit.leaves, off.fit.leaves);
}

/** A depth camera's noise grows with the square of the range. */
TEST(SensorNoise, OfWhiteCamerasIsTakenByRange) {
  for (const char* solids : {"room", "hall"}) {
    const SensorScan scan = scanByCamera(measure::namedSolids(solids), camera(1, 0), 3);
    FitParams once;
    once.local_noise = false;
    const Errors local = errorsOf(scan), global = errorsOf(scan, once);
    EXPECT_LT(local.position, 0.97 * global.position) << solids;
    EXPECT_LT(local.normal, 1.03 * global.normal) << solids;
  }
}

TEST(SensorNoise, CorrelationCanBeGiven) {
  // Noise over 9 pixels on waves cannot be separated from relief; where it is given, it is smoothed.
  const SensorScan scan = scanByCamera(measure::namedSolids("wave40"), camera(9, 0), 3);
  FitParams told;
  told.noise_correlation = 81;
  const Errors on = errorsOf(scan, told), off = errorsOf(scan, withoutRecognition());
  EXPECT_EQ(on.fit.noise.correlation, 81.0);
  EXPECT_LT(on.position, 0.8 * off.position);
}

TEST(SensorNoise, TerracesOfACameraAreNoSheets) {
  for (const char* solids : {"room", "frontal hall"}) {
    const Errors e = errorsOf(scanByCamera(measure::namedSolids(solids), camera(3, 0.125), 1));
    EXPECT_EQ(e.fit.sides.points, 0u) << solids;
    EXPECT_LT(e.fit.leaves, 500u) << solids;
  }
}

TEST(SensorNoise, ALidarsWallsAreNoDetail) {
  const SensorScan scan = scanByLidar(measure::namedSolids("street"), {}, 3);
  const Errors on = errorsOf(scan), off = errorsOf(scan, withoutRecognition());
  EXPECT_LT(on.normal, 0.75 * off.normal);
}

TEST(SensorNoise, AlongALidarsRingsIsNoDetail) {
  // Twenty neighbours are on one ring, along which no noise shows.
  measure::TurningLidar lidar;
  lidar.rings = 32;
  lidar.lowest = -30;
  lidar.highest = 10;
  const SensorScan scan = scanByLidar(measure::namedSolids("street"), lidar, 3);
  const Errors on = errorsOf(scan), off = errorsOf(scan, withoutRecognition());
  EXPECT_EQ(on.fit.noise.line, 20u);
  EXPECT_EQ(on.fit.noise.correlation, 1.0);
  EXPECT_LT(on.normal, 0.45 * off.normal);
  EXPECT_LT(on.position, 0.6 * off.position);
}

/** Where two walls meet, few points show either: balls with the support of a quartic contain both,
 * and a quartic through both would move points by up to a metre. */
TEST(SensorNoise, WallsOfFewRingsThatMeetAreKeptApart) {
  measure::TurningLidar lidar;
  lidar.rings = 16;
  lidar.steps = 900;
  lidar.lowest = -15;
  lidar.highest = 15;
  lidar.sigma = 0.01;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5})
    EXPECT_LT(errorsOf(scanByLidar(measure::namedSolids("street"), lidar, seed)).position, 0.0042);
}

TEST(SensorNoise, AlongRingsIsNoShape) {
  // Many of the smallest patches are on one ring and show nothing, so that wider ones seem to grow
  // by shape.
  measure::TurningLidar lidar;
  lidar.rings = 40;
  lidar.lowest = -16;
  lidar.highest = 7;
  lidar.sigma = 0.01;
  for (const std::uint64_t seed : {1, 2}) {
    const Errors errors = errorsOf(scanByLidar(measure::namedSolids("street"), lidar, seed));
    EXPECT_GT(errors.fit.noise.correlation, 1.0) << seed;
    EXPECT_LT(errors.normal, 12.0) << seed;
  }
}

TEST(SensorNoise, CreasesAreNoNoise) {
  // Patches wide enough for several rings contain a pole or a crease in more than a tenth of all
  // places.
  measure::TurningLidar lidar;
  lidar.rings = 32;
  lidar.lowest = -16;
  lidar.highest = 15;
  lidar.steps = 1080;
  lidar.sigma = 0.01;
  const SensorScan scan = scanByLidar(measure::namedSolids("street"), lidar, 41);
  const Errors errors = errorsOf(scan);
  EXPECT_LT(errors.position, 0.004);
  EXPECT_LT(errors.normal, 11.0);
}

TEST(SensorNoise, IsLimitedWhereRingsAreFarApart) {
  // Patches of the far facade contain the ground before it, whose distance is no noise.
  measure::TurningLidar lidar;
  lidar.rings = 24;
  lidar.lowest = -25;
  lidar.highest = 3;
  lidar.steps = 1200;
  lidar.sigma = 0.01;
  const SensorScan scan = scanByLidar(measure::namedSolids("street"), lidar, 3);
  EXPECT_LT(errorsOf(scan).position, 0.0025);
}

TEST(SensorNoise, VariesWhereTheDataAskUnlessSwitchedOff) {
  const SensorScan scan = scanByCamera(measure::namedSolids("wave40"), camera(3, 0.125), 3);
  FitParams params;
  const FitStatistics automatic = errorsOf(scan).fit;
  params.local_noise = false;
  const FitStatistics off = errorsOf(scan, params).fit;
  params.local_noise = true;
  const FitStatistics on = errorsOf(scan, params).fit;
  EXPECT_TRUE(automatic.noise.varies);
  EXPECT_TRUE(on.noise.varies);
  EXPECT_FALSE(off.noise.varies);
  EXPECT_EQ(off.lambda, automatic.lambda);
  EXPECT_NE(off.leaves, automatic.leaves);
}

TEST(SensorNoise, AModelStandsInItsPlace) {
  const SensorScan scan = scanByLidar(measure::namedSolids("street"), {}, 3);
  FitParams params;
  params.noise_model = {{0.02, 0, 0}};
  Errors errors;
  SLIMSurface surface;
  CloudView view;
  view.xyz = scan.points.data();
  view.xyz_stride = 3 * sizeof(float);
  view.size = scan.size();
  // Errors along rays need to know where rays come from.
  EXPECT_TRUE(fitSurface(*PointStore::build(view), params, surface));
  params.viewpoint = scan.sensor;
  const Errors on = errorsOf(scan, params), off = errorsOf(scan, withoutRecognition());
  EXPECT_TRUE(on.fit.noise.varies);
  EXPECT_LT(on.normal, 0.7 * off.normal);
  params.lambda = 1e-6;
  EXPECT_TRUE(params.validate());
}

TEST(SensorNoise, TheSensorIsTheSide) {
  SensorScan scan = scanByCamera(measure::namedSolids("balls"), camera(1, 0), 3);
  CloudView view;
  view.xyz = scan.points.data();
  view.xyz_stride = 3 * sizeof(float);
  view.size = scan.size();
  view.sensor = scan.sensor;
  const auto store = PointStore::build(view);
  SLIMSurface surface;
  ASSERT_FALSE(fitSurface(*store, {}, surface));
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!surface.isLeaf(i)) continue;
    const Vector3 center = along(surface.info.origin, surface.info.scale,
                                 {surface.cx[i], surface.cy[i], surface.cz[i]});
    const Vector3 normal = {surface.nx[i], surface.ny[i], surface.nz[i]};
    EXPECT_GE(dot(normal, subtract(scan.sensor, center)), 0);
  }
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Sides of surfels by the sensor of each point.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "support/clouds.h"
#include "support/drive.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

constexpr double kScanNoise = 0.01;
constexpr double kNear = 5 * kScanNoise;  ///< points are no farther from their surface

/** A view with the places that points were seen from. */
CloudView seenFrom(const std::vector<double>& sensors, CloudView view) {
  view.sensors = sensors.data();
  view.sensors_stride = 3 * sizeof(double);
  return view;
}

CloudView viewOf(const DrivenScan& scan) {
  return seenFrom(scan.sensors, pcl_slim_test::viewOf(scan.points, {}));
}

/** A fit, and the share of the points brought onto it whose normal faces out. */
struct Outcome {
  FitStatistics fit;
  SLIMSurface surface;
  double right = 0;
};

Outcome outcomeOf(const CloudView& view, const DrivenScan& scan, int threads = 2) {
  Outcome outcome;
  auto store = PointStore::build(view, threads);
  EXPECT_TRUE(store) << store.error().message;
  FitParams params;
  params.threads = threads;
  params.trim = false;
  const Error error = fitSurface(*store, params, outcome.surface, &outcome.fit);
  EXPECT_FALSE(error) << error.message;
  Projection projection;
  ProjectionParams how;
  how.threads = threads;
  EXPECT_FALSE(projectPoints(*store, outcome.surface, how, projection));
  double right = 0, known = 0;
  for (std::size_t i = 0; i < store->size(); ++i) {
    if (!projection.supported[i]) continue;
    const auto& n = projection.normal[i];
    const Vector3 place = along(store->origin(), store->scale(), projection.position[i]);
    const int out = scan.facesOut(place, {n[0], n[1], n[2]}, kNear);
    known += out >= 0;
    right += out > 0;
  }
  EXPECT_GT(known, 0.98 * static_cast<double>(store->size()));
  outcome.right = right / known;
  return outcome;
}

const DrivenScan& drive() {
  static const DrivenScan scan = scanByDrive(120000, kScanNoise, 5);
  return scan;
}

TEST(SensorSigns, OrientADriveThroughAStreet) {
  const DrivenScan& scan = drive();
  const Outcome own = outcomeOf(viewOf(scan), scan);
  EXPECT_EQ(own.fit.sides.source, SideSource::kSensors);
  EXPECT_GT(own.fit.sides.overlap_edges, 0u);
  EXPECT_GT(own.fit.points, 90000u);
  EXPECT_GT(own.right, 0.999);
  // No single place orients all of it, and neither does the graph of leaves.
  CloudView view = viewOf(scan);
  view.sensors = nullptr;
  view.sensor = std::array<double, 3>{0, 0, 2};
  const Outcome one = outcomeOf(view, scan);
  EXPECT_EQ(one.fit.sides.source, SideSource::kViewpoint);
  EXPECT_LT(one.right, 0.95);
  view.sensor.reset();
  const Outcome graph = outcomeOf(view, scan);
  EXPECT_EQ(graph.fit.sides.source, SideSource::kOutward);
  EXPECT_GT(graph.fit.sides.overlap_edges, 0u);
  EXPECT_LT(graph.right, 0.999);
}

/** A shorter drive, for what does not need so many points. */
const DrivenScan& shortDrive() {
  static const DrivenScan scan = scanByDrive(40000, kScanNoise, 7);
  return scan;
}

TEST(SensorSigns, AreTheSameForAnyNumberOfThreads) {
  const Outcome one = outcomeOf(viewOf(shortDrive()), shortDrive(), 1);
  const Outcome three = outcomeOf(viewOf(shortDrive()), shortDrive(), 3);
  EXPECT_EQ(one.surface.nz, three.surface.nz);
  EXPECT_EQ(one.surface.coefficients, three.surface.coefficients);
}

TEST(SensorSigns, FollowPointsThroughIndicesNaNAndOutliers) {
  DrivenScan scan = shortDrive();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::size_t seen = scan.size();
  for (int k = 0; k < 400; ++k) {  // pixels without a return, which have no sensor either
    for (int a = 0; a < 3; ++a) {
      scan.points.push_back(nan);
      scan.sensors.push_back(nan);
    }
    scan.times.push_back(0);
  }
  for (int k = 0; k < 20; ++k) {  // strays in the air
    const Vector3 p = {-30.0 + 3 * k, 0, 30.0 + k}, from = {0, 0, 60};
    scan.points.insert(scan.points.end(), p.begin(), p.end());
    scan.sensors.insert(scan.sensors.end(), from.begin(), from.end());
    scan.times.push_back(0);
  }
  // Four fifths of the points, in an order of their own.
  std::vector<std::int32_t> indices;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const std::size_t at = i * 7919 % scan.size();
    if (at % 5 != 0 || at >= seen) indices.push_back(static_cast<std::int32_t>(at));
  }
  CloudView view = viewOf(scan);
  view.indices = indices.data();
  view.num_indices = indices.size();
  const Outcome some = outcomeOf(view, scan);
  EXPECT_GE(some.fit.outliers, 20u);
  EXPECT_LT(some.fit.points, 4 * seen / 5);
  EXPECT_EQ(some.fit.sides.source, SideSource::kSensors);
  EXPECT_GT(some.right, 0.99);
  EXPECT_GT(some.right, outcomeOf(viewOf(shortDrive()), shortDrive()).right - 0.005);
}

TEST(SensorSigns, DoNotChangeFarFromTheOrigin) {
  DrivenScan far = shortDrive();
  const Vector3 shift = {6.5e5, 5.3e6, 420};
  for (std::size_t i = 0; i < far.points.size(); ++i) {
    far.points[i] += shift[i % 3];
    far.sensors[i] += shift[i % 3];
  }
  for (measure::Solid& solid : far.solids) {
    solid.center = along(solid.center, 1, shift);
    solid.low = along(solid.low, 1, shift);
    solid.high = along(solid.high, 1, shift);
  }
  const double near = outcomeOf(viewOf(shortDrive()), shortDrive()).right;
  EXPECT_NEAR(outcomeOf(viewOf(far), far).right, near, 0.001);
}

TEST(SensorSigns, FollowTheSensorsRoundASurface) {
  // A plane seen from below, then from above.
  Cloud cloud = sceneCloud(measure::Shape::kRelief, 4000, 0.001).withoutNormals();
  for (const double height : {-30.0, 30.0}) {
    std::vector<float> sensors;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      sensors.push_back(static_cast<float>(cloud.points[3 * i]));
      sensors.push_back(static_cast<float>(cloud.points[3 * i + 1]));
      sensors.push_back(static_cast<float>(height));
    }
    CloudView view = cloud.view();
    view.sensors = sensors.data();
    view.sensors_stride = 3 * sizeof(float);
    view.sensors_scalar = CloudView::Scalar::kFloat;
    auto store = PointStore::build(view);
    ASSERT_TRUE(store);
    SLIMSurface surface;
    FitStatistics fit;
    ASSERT_FALSE(fitSurface(*store, {}, surface, &fit));
    for (const std::uint32_t i : surface.leaves()) EXPECT_GT(surface.nz[i] * height, 0);
    // A viewpoint that is given wins.
    FitParams params;
    params.viewpoint = {{0, 0, -1000 * height}};
    ASSERT_FALSE(fitSurface(*store, params, surface, &fit));
    EXPECT_EQ(fit.sides.source, SideSource::kViewpoint);
    for (const std::uint32_t i : surface.leaves()) EXPECT_LT(surface.nz[i] * height, 0);
  }
}

TEST(SensorSigns, GivenNormalsWin) {
  Cloud cloud = sceneCloud(measure::Shape::kSphere, 3000, 0.0);
  std::vector<double> sensors(cloud.points.size(), 0.0);  // inside
  auto store = PointStore::build(seenFrom(sensors, cloud.view()));
  ASSERT_TRUE(store);
  SLIMSurface surface;
  FitStatistics fit;
  ASSERT_FALSE(fitSurface(*store, {}, surface, &fit));
  EXPECT_EQ(fit.sides.source, SideSource::kNormals);
  for (const std::uint32_t i : surface.leaves()) {
    const Vector3 c = along(surface.info.origin, surface.info.scale,
                            {surface.cx[i], surface.cy[i], surface.cz[i]});
    EXPECT_GT(dot(c, {surface.nx[i], surface.ny[i], surface.nz[i]}), 0);
  }
}

TEST(SensorSigns, PointsNeedAPlaceEach) {
  DrivenScan scan = scanByDrive(2000, kScanNoise, 3);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, 1e300}) {
    scan.sensors[3 * 17 + 1] = bad;
    const auto store = PointStore::build(viewOf(scan));
    ASSERT_FALSE(store);
    EXPECT_NE(store.error().message.find("point 17"), std::string::npos) << store.error().message;
  }
}

TEST(SensorSigns, ANoiseModelTakesEachPointsBeam) {
  // A wall seen along two paths: close up, and from far away where the error is ten times as large.
  Cloud cloud;
  std::vector<double> sensors;
  for (int i = 0; i < 20000; ++i) {
    const double x = 20 * std::fmod(i * 0.6180339887498949, 1.0), z = 10.0 * i / 20000;
    cloud.add(x, 0, z);
    sensors.insert(sensors.end(), {x, x < 10 ? 2.0 : 20.0, z});
  }
  const auto store = PointStore::build(seenFrom(sensors, cloud.view()));
  ASSERT_TRUE(store);
  FitParams params;
  params.noise_model = {{0, 0.001, 0}};
  SLIMSurface surface;
  FitStatistics fit;
  ASSERT_FALSE(fitSurface(*store, params, surface, &fit));
  EXPECT_TRUE(fit.noise.varies);
  // The mean variance of .002 and .02, as a share of the squared diagonal.
  const double expected = (0.002 * 0.002 + 0.02 * 0.02) / 2 / (20 * 20 + 10 * 10);
  EXPECT_NEAR(fit.lambda, expected, 0.1 * expected);
}

TEST(SensorSigns, TellTheTwoSidesOfAThinPlate) {
  // Two sheets 3 spacings apart, with noise, each seen from its own side.
  std::mt19937_64 rng(11);
  std::normal_distribution<double> gauss(0, 0.3);
  Cloud cloud;
  std::vector<double> sensors;
  for (const double height : {1.5, -1.5}) {
    for (int i = 0; i < 2500; ++i) {
      const double x = (i + 0.5) / 50, y = 50 * std::fmod(i * 0.6180339887498949 + height, 1.0);
      cloud.addNoisy({x, y, height}, gauss, rng);
      sensors.insert(sensors.end(), {25, 25, 30 * height});
    }
  }
  auto store = PointStore::build(seenFrom(sensors, cloud.view()));
  ASSERT_TRUE(store);
  SLIMSurface surface;
  FitStatistics fit;
  ASSERT_FALSE(fitSurface(*store, {}, surface, &fit));
  EXPECT_EQ(fit.sides.source, SideSource::kSensors);
  EXPECT_EQ(fit.sides.points + fit.outliers, store->size());
  Projection projection;
  ASSERT_FALSE(projectPoints(*store, surface, {}, projection));
  std::size_t right = 0;
  for (std::size_t i = 0; i < store->size(); ++i) {
    const double height = sensors[3 * store->orderOfStore()[i] + 2];
    right += projection.normal[i][2] * height > 0;
  }
  EXPECT_GT(right, store->size() * 99 / 100);
}

/** RMS distance of a plate's smoothed points from their own faces, at these heights. */
double errorOfFaces(const CloudView& view, const std::vector<double>& faces) {
  auto store = PointStore::build(view);
  EXPECT_TRUE(store) << store.error().message;
  SLIMSurface surface;
  EXPECT_FALSE(fitSurface(*store, {}, surface));
  Projection projection;
  EXPECT_FALSE(projectPoints(*store, surface, {}, projection));
  double sum_sq = 0, count = 0;
  for (std::size_t i = 0; i < store->size(); ++i) {
    if (!projection.supported[i]) continue;
    const Vector3 at = along(store->origin(), store->scale(), projection.position[i]);
    sum_sq += std::pow(at[2] - faces[store->orderOfStore()[i]], 2);
    ++count;
  }
  EXPECT_GT(count, 0.99 * static_cast<double>(store->size()));
  return std::sqrt(sum_sq / count);
}

TEST(SensorSigns, FacesNearerThanTheNoiseAreKeptApart) {
  // Faces of a plate 5, 1.5 and .75 deviations of the noise thick, seen from two places on either
  // side.
  constexpr double kSpread = 0.8;
  for (const double thickness : {5.0, 1.5, 0.75}) {
    std::mt19937_64 rng(11);
    std::normal_distribution<double> gauss(0, kSpread);
    std::uniform_real_distribution<double> unit(0, 1);
    Cloud cloud;
    std::vector<double> sensors, faces;
    for (int i = 0; i < 20000; ++i) {
      const double face = (i % 2 ? 0.5 : -0.5) * thickness * kSpread;
      const double x = 100 * unit(rng), y = 100 * unit(rng);
      cloud.add(x, y, face + gauss(rng));
      sensors.insert(sensors.end(), {i % 4 < 2 ? 40.0 : 60.0, 50, face > 0 ? 100.0 : -100.0});
      faces.push_back(face);
    }
    EXPECT_LT(errorOfFaces(seenFrom(sensors, cloud.view()), faces), 0.25 * kSpread) << thickness;
    if (thickness > 2) continue;
    EXPECT_GT(errorOfFaces(cloud.view(), faces), 0.45 * thickness * kSpread)
        << thickness << ": without sensors points end in the middle";
  }
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
// The noise of a sensor, measured on one frame and used for the next ones.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "pcl_slim/fit/sensor_noise.h"
#include "support/clouds.h"
#include "support/lab/sensor.h"
#include "support/temporary_folder.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using measure::DepthCamera;
using measure::SensorScan;

/** A stereo camera whose errors are shared by box x box pixels. */
DepthCamera frameCamera(int box, double sigma = 0.06) {
  DepthCamera camera;
  camera.correlated_x = camera.correlated_y = box;
  camera.sigma = sigma;
  return camera;
}

/** RMS error of the camera's depth at a depth [m], to first order. */
double depthError(const DepthCamera& camera, double z) {
  return camera.sigma * z * z / (camera.disparity_focal * camera.baseline);
}

/** A frame of the room by a camera that goes backwards, turns and lifts. */
SensorScan frameOf(const DepthCamera& camera, int number, const char* solids = "room") {
  const Vector3 place{0.05 * number, -0.02 * number, -0.1 * number};
  return scanByCamera(seenFrom(measure::namedSolids(solids), place, 0.05 * number - 0.1), camera,
                      static_cast<std::uint64_t>(100 + number));
}

struct FrameFit {
  PointStore store;
  SLIMSurface surface;
  FitStatistics statistics;
  Projection projection;

  const NoiseStatistics& noise() const { return statistics.noise; }
  const std::optional<SensorNoise>& sensor() const { return statistics.noise.sensor_noise; }
};

FrameFit fitFrame(const SensorScan& scan, const std::optional<SensorNoise>& noise, int threads = 0,
                  bool sensor_known = true) {
  CloudView view;
  view.xyz = scan.points.data();
  view.xyz_stride = 3 * sizeof(float);
  view.size = scan.size();
  if (sensor_known) view.sensor = std::array<double, 3>{0, 0, 0};
  FitParams params;
  params.trim = false;
  params.threads = threads;
  params.keep_sensor_noise = true;
  params.sensor_noise = noise;
  FrameFit fit;
  fit.store = *PointStore::build(view);
  EXPECT_FALSE(fitSurface(fit.store, params, fit.surface, &fit.statistics));
  EXPECT_FALSE(projectPoints(fit.store, fit.surface, {}, fit.projection));
  return fit;
}

/** RMS distance of the projected points from their surfaces [m]. */
double positionError(const SensorScan& scan, const FrameFit& fit) {
  double squares = 0;
  for (std::size_t i = 0; i < fit.store.size(); ++i) {
    const int solid = scan.solid[fit.store.orderOfStore()[i]];
    const Vector3 place = along(fit.store.origin(), fit.store.scale(), fit.projection.position[i]);
    squares += std::pow(footOn(scan.solids[static_cast<std::size_t>(solid)], place).distance, 2);
  }
  return std::sqrt(squares / static_cast<double>(fit.store.size()));
}

double errorAtRange(const SensorNoise& noise, double z) {
  return noise.error[0] + noise.error[1] * z + noise.error[2] * z * z;
}

TEST(NextFrame, RecoversTheErrorByRange) {
  const DepthCamera camera = frameCamera(1);
  const FrameFit fit = fitFrame(frameOf(camera, 0), {});
  ASSERT_TRUE(fit.sensor());
  EXPECT_TRUE(fit.sensor()->along_rays);
  // At range z the depth is z cos(off-axis), the error along the ray thereby 5 % less on average.
  for (const double z : {1.3, 2.0, 2.8})
    EXPECT_NEAR(errorAtRange(*fit.sensor(), z), depthError(camera, z), 0.1 * depthError(camera, z));
  EXPECT_EQ(fit.sensor()->correlation, 1);
}

TEST(NextFrame, IsAsGoodAsMeasuredAlone) {
  for (const int box : {1, 5}) {
    const DepthCamera camera = frameCamera(box);
    const std::optional<SensorNoise> noise = fitFrame(frameOf(camera, 0), {}).sensor();
    ASSERT_TRUE(noise);
    double alone = 0, next = 0;
    for (int number = 1; number <= 2; ++number) {
      const SensorScan scan = frameOf(camera, number);
      const FrameFit fit = fitFrame(scan, noise);
      EXPECT_EQ(fit.noise().sensor_check, SensorCheck::kAgrees) << fit.noise().sensor_ratio;
      EXPECT_EQ(*fit.sensor(), *noise);
      EXPECT_EQ(fit.noise().correlation, noise->correlation);
      next += positionError(scan, fit);
      alone += positionError(scan, fitFrame(scan, {}));
    }
    EXPECT_LT(next, 1.03 * alone) << "errors shared by " << box;
  }
}

TEST(NextFrame, FollowsTheRange) {
  // Of one wall at 1.2 m the range hardly varies; three times as far away the error is nine times as
  // large. Either the model is valid there, or the frame is measured.
  const DepthCamera camera = frameCamera(3, 0.03);
  measure::Solid plane;
  plane.center = {0, 0, 1.2};
  plane.axis = normalized({0.1, 0.1, -1});
  const auto wall = [&](double away) {
    return scanByCamera(measure::seenFrom({plane}, {0, 0, -away}, 0), camera, 5);
  };
  const FrameFit near = fitFrame(wall(0), {});
  ASSERT_TRUE(near.sensor());
  const SensorScan scan = wall(2.4);
  const FrameFit far = fitFrame(scan, near.sensor()), alone = fitFrame(scan, {});
  const double found = std::sqrt(far.statistics.lambda / alone.statistics.lambda);
  EXPECT_GT(found, 0.85);
  EXPECT_LT(found, 1.2);
  EXPECT_LT(positionError(scan, far), 1.1 * positionError(scan, alone));
}

TEST(NextFrame, NoticesAnotherSensor) {
  const DepthCamera camera = frameCamera(3);
  const std::optional<SensorNoise> noise = fitFrame(frameOf(camera, 0), {}).sensor();
  ASSERT_TRUE(noise);
  for (const DepthCamera& other :
       {frameCamera(3, 0.078), frameCamera(3, 0.045), frameCamera(1), frameCamera(6)}) {
    const SensorScan scan = frameOf(other, 1);
    const FrameFit fit = fitFrame(scan, noise);
    EXPECT_EQ(fit.noise().sensor_check, SensorCheck::kDiffers)
        << other.sigma << " px, shared by " << other.correlated_x;
    ASSERT_TRUE(fit.sensor());
    EXPECT_NE(*fit.sensor(), *noise);
    if (other.correlated_x > 1) continue;
    const FrameFit alone = fitFrame(scan, {});
    EXPECT_EQ(fit.projection.position, alone.projection.position) << "measured anew";
    EXPECT_EQ(*fit.sensor(), *alone.sensor());
  }
}

TEST(NextFrame, NoticesASmoothedFrame) {
  const DepthCamera camera = frameCamera(3);
  const FrameFit first = fitFrame(frameOf(camera, 0), {});
  SensorScan scan = frameOf(camera, 1);
  const FrameFit fit = fitFrame(scan, first.sensor());
  for (std::size_t i = 0; i < fit.store.size(); ++i) {
    const Vector3 place = along(fit.store.origin(), fit.store.scale(), fit.projection.position[i]);
    for (std::size_t a = 0; a < 3; ++a)
      scan.points[3 * fit.store.orderOfStore()[i] + a] = static_cast<float>(place[a]);
  }
  EXPECT_EQ(fitFrame(scan, first.sensor()).noise().sensor_check, SensorCheck::kDiffers);
}

TEST(NextFrame, WithoutASensorsPlaceTheErrorIsOne) {
  const auto part = [](std::uint64_t seed, double sigma) {
    std::mt19937_64 rng(seed);
    std::normal_distribution<double> gauss;
    SensorScan scan;
    for (int i = 0; i < 30000; ++i) {
      Vector3 p;
      for (double& x : p) x = gauss(rng);
      p = scaled(normalized(p), 1 + sigma * gauss(rng));
      for (const double x : p) scan.points.push_back(static_cast<float>(x));
      scan.solid.push_back(0);
    }
    return scan;
  };
  const FrameFit first = fitFrame(part(1, 0.01), {}, 0, false);
  ASSERT_TRUE(first.sensor());
  EXPECT_FALSE(first.sensor()->along_rays);
  EXPECT_NEAR(first.sensor()->error[0], 0.01, 0.0007);
  EXPECT_EQ(fitFrame(part(2, 0.01), first.sensor(), 0, false).noise().sensor_check,
            SensorCheck::kAgrees);
  EXPECT_EQ(fitFrame(part(2, 0.013), first.sensor(), 0, false).noise().sensor_check,
            SensorCheck::kDiffers);
}

TEST(NextFrame, IsTheSameForAnyNumberOfThreads) {
  const DepthCamera camera = frameCamera(5);
  const FrameFit one = fitFrame(frameOf(camera, 0), {}, 1),
                 three = fitFrame(frameOf(camera, 0), {}, 3);
  ASSERT_TRUE(one.sensor());
  EXPECT_EQ(*one.sensor(), *three.sensor());
  const SensorScan scan = frameOf(camera, 1);
  const FrameFit next = fitFrame(scan, one.sensor(), 1), same = fitFrame(scan, one.sensor(), 3);
  EXPECT_EQ(next.projection.position, same.projection.position);
  EXPECT_EQ(next.noise().sensor_ratio, same.noise().sensor_ratio);
}

TEST(NextFrame, MergedFramesAreMeasured) {
  const SensorScan scan = frameOf(frameCamera(3), 0);
  const FrameFit first = fitFrame(scan, {});
  CloudView view;
  view.xyz = scan.points.data();
  view.xyz_stride = 3 * sizeof(float);
  view.size = scan.size();
  std::vector<std::uint32_t> numbers(scan.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = i % 2;
  view.frame_numbers = numbers.data();
  const auto store = PointStore::build(view);
  FitParams params;
  params.viewpoint = {{0, 0, 0}};
  params.keep_sensor_noise = true;
  params.sensor_noise = first.sensor();
  SLIMSurface surface;
  FitStatistics statistics;
  EXPECT_FALSE(fitSurface(*store, params, surface, &statistics));
  EXPECT_EQ(statistics.noise.sensor_check, SensorCheck::kNotSeen);
  EXPECT_FALSE(statistics.noise.sensor_noise);
}

SensorNoise someNoise() {
  SensorNoise noise;
  noise.error = {1.0 / 3, 0, 0.1};
  noise.along_rays = true;
  noise.relative_error = 0.02;
  noise.correlation = 9.1;
  noise.dependence = std::sqrt(12.0);
  noise.neighbors = 640;
  noise.residual = {0.25, 2.0 / 3};
  noise.columns = 640;
  noise.rows = 480;
  return noise;
}

TEST(SensorNoiseFile, KeepsEveryNumber) {
  const TemporaryFolder folder;
  const std::string path = folder / "noise.json";
  const SensorNoise noise = someNoise();
  EXPECT_FALSE(saveSensorNoise(path, noise));
  const Result<SensorNoise> read = loadSensorNoise(path);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(*read, noise);
  EXPECT_TRUE(read->hasSize(640, 480));
  EXPECT_FALSE(read->hasSize(480, 640));
  EXPECT_FALSE(read->hasSize(307200, 1));
}

TEST(SensorNoiseFile, RefusesOtherTexts) {
  const std::string text = toJson(someNoise());
  EXPECT_TRUE(sensorNoiseFromJson(text, "a.json"));
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    other.replace(other.find(from), from.size(), to);
    return other;
  };
  const std::string texts[] = {"",
                               "{}",
                               "{\"kind\": \"",
                               text.substr(0, text.size() / 2),
                               text + "x",
                               replaced("sensor noise", "camera"),
                               replaced("\"step\"", "\"steps\""),
                               replaced("\"rows\": 480", "\"rows\": 4.5"),
                               replaced("\"rows\": 480", "\"rows\": [480]"),
                               replaced("\"relative_error\": 0", "\"relative_error\": -0"),
                               replaced("\"correlation\": 9", "\"correlation\": nan"),
                               replaced("\"correlation\": 9", "\"correlation\": .9"),
                               replaced("\"correlation\": 9", "\"correlation\": 0"),
                               replaced("\"neighbors\": 640", "\"neighbors\": 6"),
                               replaced("\"along_rays\": 1", "\"along_rays\": 0"),
                               replaced("0.66666", "1e999")};
  for (const std::string& other : texts) {
    const Result<SensorNoise> read = sensorNoiseFromJson(other, "a.json");
    ASSERT_FALSE(read) << other;
    EXPECT_EQ(read.error().code, ErrorCode::kBadInput);
    EXPECT_NE(read.error().message.find("'a.json'"), std::string::npos);
    EXPECT_EQ(read.error().message.find('\n'), std::string::npos);
  }
}

TEST(SensorNoiseParameter, ExcludesGivenNoise) {
  FitParams params;
  params.sensor_noise = someNoise();
  EXPECT_FALSE(params.validate());
  FitParams given = params;
  given.noise = 0.1;
  EXPECT_TRUE(given.validate());
  given = params;
  given.noise_correlation = 4;
  EXPECT_TRUE(given.validate());
  given = params;
  given.sensor_noise->residual[1] = 0;
  EXPECT_TRUE(given.validate());
}

}  // namespace
}  // namespace pcl_slim

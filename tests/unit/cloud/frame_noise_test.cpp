// SPDX-License-Identifier: BSD-3-Clause
// The noise of merged frames: docs/noise.md, "Frames".
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/cloud/detail/sides.h"
#include "support/clouds.h"
#include "support/lab/sensor.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using detail::NoiseLevel;

/** What is known of the points of frames. */
enum class Known { kSensors, kNumbers };

/** Points, each with the place that it was seen from and the number of its frame. */
struct Frames {
  Cloud cloud;
  std::vector<double> sensors;
  std::vector<std::uint32_t> numbers;

  void add(const Eigen::Vector3d& point, const Eigen::Vector3d& sensor, std::uint32_t number) {
    cloud.add(point[0], point[1], point[2]);
    sensors.insert(sensors.end(), sensor.data(), sensor.data() + 3);
    numbers.push_back(number);
  }

  /** Adds a frame of a camera that is off by an angle. */
  void add(const measure::SensorScan& scan, double angle) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    const Eigen::Vector3d middle(0, 0, 2);
    const std::uint32_t number = numbers.empty() ? 7 : numbers.back() + 7;
    const auto turned = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
      return middle + turn * (p - middle);
    };
    for (std::size_t i = 0; i < scan.size(); ++i)
      add(turned(Eigen::Map<const Eigen::Vector3f>(&scan.points[3 * i]).cast<double>()),
          turned(Eigen::Map<const Eigen::Vector3d>(scan.sensor.data())), number);
  }

  Frames shuffled() const {
    std::vector<std::size_t> order(cloud.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::mt19937_64 random(5);
    std::shuffle(order.begin(), order.end(), random);
    Frames other;
    for (const std::size_t i : order)
      other.add(Eigen::Map<const Eigen::Vector3d>(&cloud.points[3 * i]),
                Eigen::Map<const Eigen::Vector3d>(&sensors[3 * i]), numbers[i]);
    return other;
  }

  PointStore store(int threads = 1, Known known = Known::kSensors) const {
    CloudView view = cloud.view();
    if (known == Known::kSensors) {
      view.sensors = sensors.data();
      view.sensors_stride = 3 * sizeof(double);
    } else {
      view.frame_numbers = numbers.data();
    }
    auto built = PointStore::build(view, threads);
    EXPECT_TRUE(built) << built.error().message;
    return built ? std::move(*built) : PointStore();
  }
};

measure::SensorScan frameOf(const char* solids, const measure::DepthCamera& camera, int number) {
  return scanByCamera(measure::namedSolids(solids), camera, static_cast<std::uint64_t>(3 + number));
}

Frames framesOf(const char* solids, const measure::DepthCamera& camera, int count) {
  Frames frames;
  for (int i = 0; i < count; ++i) frames.add(frameOf(solids, camera, i), 0.001 * i);
  return frames;
}

NoiseLevel recognizedInFrames(const PointStore& store, int threads = 1) {
  const detail::NoiseConstants constants;
  return recognizeFrameNoise(store, measureNoise(store, constants, threads), constants, threads);
}

measure::DepthCamera wideWindows() {
  measure::DepthCamera camera;
  camera.correlated_x = camera.correlated_y = 7;
  return camera;
}

TEST(FrameNoise, IsThatOfItsFrames) {
  for (const char* solids : {"room", "balls"}) {
    double variance = 0, correlation = 0;
    for (int count = 1; count <= 3; ++count) {
      Frames last;
      last.add(frameOf(solids, wideWindows(), count - 1), 0);
      const PointStore alone = last.store();
      const NoiseLevel noise = recognizedInFrames(alone);
      EXPECT_EQ(noise.frames, 0U) << "one place is no merged cloud";
      variance += alone.scale() * alone.scale() * noise.variance;
      correlation += noise.correlation;
      if (count == 1) continue;
      const PointStore merged = framesOf(solids, wideWindows(), count).store();
      const NoiseLevel found = recognizedInFrames(merged);
      EXPECT_EQ(found.frames, static_cast<std::size_t>(count));
      const double rms = merged.scale() * std::sqrt(found.variance);
      EXPECT_NEAR(rms / std::sqrt(variance / count), 1, 0.1) << solids << count;
      EXPECT_NEAR(found.correlation / (correlation / count), 1, 0.2) << solids << count;
      const PointStore unseen = storeOf(framesOf(solids, wideWindows(), count).cloud);
      EXPECT_LT(recognizedInFrames(unseen).correlation, 0.75 * found.correlation)
          << solids << count;
    }
  }
}

TEST(FrameNoise, NumbersSayTheSameAsSensors) {
  const Frames frames = framesOf("room", wideWindows(), 3);
  const NoiseLevel seen = recognizedInFrames(frames.store());
  for (const PointStore& store :
       {frames.store(1, Known::kNumbers), frames.shuffled().store(1, Known::kNumbers)}) {
    const NoiseLevel numbered = recognizedInFrames(store);
    EXPECT_EQ(numbered.frames, 3U);
    EXPECT_EQ(numbered.variance, seen.variance);
    EXPECT_EQ(numbered.correlation, seen.correlation);
  }
}

TEST(FrameNoise, NumbersSeparateTheFramesOfOnePlace) {
  Frames frames;
  for (int i = 0; i < 2; ++i) frames.add(frameOf("room", wideWindows(), i), 0);
  const double one = recognizedInFrames(framesOf("room", wideWindows(), 1).store()).correlation;
  const NoiseLevel seen = recognizedInFrames(frames.store());
  EXPECT_EQ(seen.frames, 0U) << "one place: one frame";
  EXPECT_LT(seen.correlation, 0.75 * one);
  const NoiseLevel numbered = recognizedInFrames(frames.store(1, Known::kNumbers));
  EXPECT_EQ(numbered.frames, 2U);
  EXPECT_NEAR(numbered.correlation / one, 1, 0.2);
}

TEST(FrameNoise, NumbersStayWithTheirPoints) {
  const Frames frames = framesOf("balls", measure::DepthCamera(), 2);
  PointStore store = frames.store(1, Known::kNumbers);
  const auto expectTheirs = [&](const PointStore& part) {
    ASSERT_TRUE(part.hasFrameNumbers());
    for (std::size_t i = 0; i < part.size(); ++i)
      ASSERT_EQ(part.frameNumber(i), frames.numbers[part.orderOfStore()[i]]) << i;
  };
  expectTheirs(store);
  std::vector<std::uint32_t> dropped;
  for (std::uint32_t i = 0; i < store.size(); i += 3) dropped.push_back(i);
  expectTheirs(store.without(dropped));
  store.drop(dropped);
  expectTheirs(store);
}

TEST(FrameNoise, DoesNotDependOnOrderOrThreads) {
  const Frames frames = framesOf("hall", wideWindows(), 2);
  const NoiseLevel noise = recognizedInFrames(frames.store());
  for (const NoiseLevel& other :
       {recognizedInFrames(frames.shuffled().store()), recognizedInFrames(frames.store(3), 3)}) {
    EXPECT_EQ(other.variance, noise.variance);
    EXPECT_EQ(other.correlation, noise.correlation);
    EXPECT_EQ(other.neighbors, noise.neighbors);
  }
}

TEST(FrameNoise, FramesThatRoundAlikeShareTheirErrors) {
  measure::DepthCamera camera;
  camera.sigma = 0;
  camera.step = 0.125;
  const NoiseLevel one = recognizedInFrames(framesOf("room", camera, 1).store());
  const NoiseLevel two = recognizedInFrames(framesOf("room", camera, 2).store());
  EXPECT_NEAR(two.correlation / one.correlation, 2, 0.4);
}

TEST(FrameNoise, WhiteNoiseIsThatOfAllPoints) {
  const measure::DepthCamera camera;
  const PointStore store = framesOf("room", camera, 2).store();
  const detail::NoiseConstants constants;
  const NoiseLevel white = measureNoise(store, constants, 1), found = recognizedInFrames(store);
  EXPECT_EQ(found.frames, 0U);
  EXPECT_EQ(found.variance, recognizeSharedNoise(store, white, constants, 1).variance);
}

TEST(FrameNoise, APlaceForEveryPointIsNoFrame) {
  Frames path;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, 0.01);
  for (int i = 0; i < 20000; ++i)
    path.add({0.01 * (i % 200), 0.01 * (i / 200), normal(random)}, {1e-4 * i, 1, 3}, 0);
  EXPECT_EQ(recognizedInFrames(path.store()).frames, 0U);
}

/** A plate two spacings thick: its upper face is seen from above, its lower one from another
 * height. */
Frames plateSeenFrom(double below) {
  Frames frames;
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0, 0.002);
  for (int i = 0; i < 40000; ++i) {
    const int side = i % 2, j = i / 2;
    const double height = 0.02 * side + noise(random);
    frames.add({0.01 * (j % 141), 0.01 * (j / 141), height}, {0.7, 0.7, side ? 2 : below}, 0);
  }
  return frames;
}

TEST(FrameNoise, PlacesSeenFromOneDirectionHaveOneSide) {
  const auto thin = [](const PointStore& store) {
    const detail::ThinPlaces places = detail::findThinPlaces(store, {}, {}, 1);
    return places.share + places.facing;
  };
  EXPECT_GT(thin(plateSeenFrom(-2).store()), 0.5) << "seen from above and below";
  EXPECT_EQ(thin(plateSeenFrom(2.5).store()), 0) << "seen from above";
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Noise that neighbours share, separated from detail: docs/noise.md, "Plateaus".
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "noise/patch.h"
#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/cloud/noise_level.h"
#include "support/clouds.h"
#include "support/lab/sensor.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using detail::NoiseLevel;

NoiseLevel recognized(const PointStore& store, const detail::NoiseConstants& constants = {}) {
  return recognizeSharedNoise(store, measureNoise(store, constants, 1), constants, 1);
}

NoiseLevel recognized(const Cloud& cloud) {
  return recognized(storeOf(cloud));
}

/** A scan's points, turned by an angle about an axis that is none of the coordinates'. */
Cloud cloudOf(const measure::SensorScan& scan, double angle = 0) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  Cloud cloud;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const float* p = &scan.points[3 * i];
    const Eigen::Vector3d turned = turn * Eigen::Vector3d(p[0], p[1], p[2]);
    cloud.add(turned[0], turned[1], turned[2]);
  }
  return cloud;
}

measure::SensorScan cameraScan(const std::string& solids, const measure::DepthCamera& camera) {
  return scanByCamera(measure::namedSolids(solids), camera, 3);
}

/** A grid of heights: noise averaged over boxes of so many points a side. */
Cloud boxNoise(int box, double sigma, std::uint64_t seed = 5) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const int side = 250, wide = side + box;
  std::vector<double> white(static_cast<std::size_t>(wide * wide));
  for (double& value : white) value = normal(random);
  Cloud cloud;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      double sum = 0;
      for (int k = 0; k < box * box; ++k)
        sum += white[static_cast<std::size_t>((y + k / box) * wide + x + k % box)];
      cloud.add(0.01 * x, 0.01 * y, 0.3 * x * 0.01 + sigma * sum / box);
    }
  }
  return cloud;
}

TEST(SharedNoise, CountsThePointsThatShareIt) {
  for (const int box : {3, 5}) {
    const NoiseLevel noise = recognized(boxNoise(box, 0.003));
    const double ratio = noise.correlation / (box * box);
    EXPECT_GT(ratio, 1 / 1.5) << box;
    EXPECT_LT(ratio, 1.5) << box;
  }
}

TEST(SharedNoise, MeasuresAllOfIt) {
  for (const int box : {3, 5}) {
    const PointStore store = storeOf(boxNoise(box, 0.003));
    const double across = 0.003 / std::sqrt(1 + 0.3 * 0.3);
    const double sigma = std::sqrt(recognized(store).variance) * store.scale();
    EXPECT_NEAR(sigma / across, 1.0, 0.1) << box;
    // What 20 neighbours share was taken for the surface's before.
    EXPECT_LT(std::sqrt(estimateNoise(store, NoiseEstimator::kCubicResidual, 1)) * store.scale(),
              0.8 * across)
        << box;
  }
}

TEST(SharedNoise, IsNotWhiteNoise) {
  const auto expectWhite = [](const Cloud& cloud, double level) {
    const PointStore store = storeOf(cloud);
    const NoiseLevel noise = recognized(store);
    EXPECT_EQ(noise.correlation, 1.0) << level;
    EXPECT_EQ(noise.line, 0u) << level;
    EXPECT_EQ(noise.variance, estimateNoise(store, NoiseEstimator::kCubicResidual, 1)) << level;
  };
  for (const double level : {0.0, 0.001, 0.01}) {
    for (const auto shape : {measure::Shape::kSphere, measure::Shape::kTorus,
                             measure::Shape::kBumpy, measure::Shape::kRelief})
      expectWhite(sceneCloud(shape, 40000, level).withoutNormals(), level);
  }
  expectWhite(boxNoise(1, 0.003), 0.003);
}

TEST(SharedNoise, IsNotWaves) {
  // Waves 12 spacings long and of a tenth of their height in noise.
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  Cloud cloud;
  for (int i = 0; i < 250 * 250; ++i) {
    const double x = 0.01 * (i % 250), y = 0.01 * (i / 250), k = 2 * M_PI / 0.12;
    cloud.add(x, y, 0.01 * std::sin(k * x) * std::sin(k * y) + 0.001 * normal(random));
  }
  EXPECT_EQ(recognized(cloud).correlation, 1.0);
}

TEST(SharedNoise, StepsOfACameraAreFound) {
  measure::DepthCamera camera;
  camera.sigma = 0;
  camera.step = 0.125;
  const PointStore store = storeOf(cloudOf(cameraScan("wave40", camera)));
  const NoiseLevel noise = recognized(store);
  EXPECT_GT(noise.correlation, 1.0);
  // A step of disparity is step z^2 / (f b) of depth; half of the scene is within .1 of 1.2 m.
  const double step = 0.125 * 1.2 * 1.2 / (camera.disparity_focal * camera.baseline);
  EXPECT_NEAR(noise.step * store.scale() / step, 1.0, 0.2);
}

TEST(SharedNoise, EverySeedShowsIt) {
  // Of these growth is low at the first scale by chance, or flat where steps hide that it goes on.
  measure::DepthCamera wide;
  wide.correlated_x = wide.correlated_y = 5;
  const auto waves = scanByCamera(measure::namedSolids("wave15"), wide, 24);
  EXPECT_GT(recognized(cloudOf(waves)).correlation, 2.0);
  wide.correlated_x = wide.correlated_y = 9;
  wide.step = 0.125;
  const auto steps = scanByCamera(measure::namedSolids("wave40"), wide, 21);
  EXPECT_GT(recognized(cloudOf(steps)).correlation, 4.0);
}

TEST(SharedNoise, TerracesAreMeasuredInFull) {
  // Steps of 18 mm on a wall 2.5 m away make terraces of 14, 10 and 7 pixels, which patches of 160
  // points see in part, and whose errors change sign from one to the next.
  measure::DepthCamera camera;
  camera.sigma = 0;
  camera.step = 0.125;
  for (const double tilt : {0.15, 0.2, 0.3}) {
    measure::Solid wall;
    wall.center = {0, 0, 2.5};
    wall.axis = normalized({tilt, 0.02, -1});
    const PointStore store = storeOf(cloudOf(scanByCamera({wall}, camera, 3)));
    const NoiseLevel noise = recognized(store);
    const double rounding = noise.step / std::sqrt(12.0) * std::abs(wall.axis[2]);
    EXPECT_NEAR(std::sqrt(noise.variance) / rounding, 1.0, 0.2) << tilt;
    EXPECT_GT(noise.correlation, 5.0) << tilt;
  }
}

TEST(SharedNoise, StepsAreFoundInATurnedCloud) {
  measure::DepthCamera pixels, millimetres;
  pixels.sigma = 0;
  pixels.step = 0.125;
  millimetres.sigma = 0.005;
  millimetres.depth_step = 0.005;
  for (const auto& [solids, camera] : {std::pair{"room", pixels}, {"wave40", millimetres}}) {
    const measure::SensorScan scan = cameraScan(solids, camera);
    const PointStore store = storeOf(cloudOf(scan));
    const NoiseLevel noise = recognized(store);
    ASSERT_GT(noise.step, 0) << solids;
    for (const double angle : {0.001, 0.01, 0.7, 2.1}) {
      const PointStore turned = storeOf(cloudOf(scan, angle));
      const NoiseLevel found = recognized(turned);
      const double size = turned.scale() / store.scale();
      EXPECT_NEAR(size * found.step / noise.step, 1, 0.05) << solids << " " << angle;
      EXPECT_NEAR(size * std::sqrt(found.variance / noise.variance), 1, 0.1) << solids;
      EXPECT_NEAR(found.correlation / noise.correlation, 1, 0.15) << solids << " " << angle;
    }
  }
}

TEST(SharedNoise, StepsAreNamedWhereSharedNoiseExplainsThemAsWell) {
  measure::DepthCamera camera;
  camera.sigma = camera.depth_step = 0.005;
  const PointStore store = storeOf(cloudOf(cameraScan("wave15", camera)));
  const NoiseLevel noise = recognized(store);
  EXPECT_GT(noise.correlation, 2.0);  // that of rounding alone is 2 here
  EXPECT_NEAR(noise.step * store.scale(), 0.005, 0.0001);
}

TEST(SharedNoise, AGridIsNoSteps) {
  // x and y take few values, z is what noise makes it.
  EXPECT_EQ(recognized(boxNoise(1, 0.002)).step, 0.0);
  // A clean grid of rounded heights has few values along every axis.
  Cloud cloud;
  for (int i = 0; i < 250 * 250; ++i)
    cloud.add(0.01 * (i % 250), 0.01 * (i / 250), 0.001 * std::round(10.0 * std::sin(0.02 * i)));
  EXPECT_EQ(recognized(cloud).step, 0.0);
}

TEST(SharedNoise, TwoMergedFramesHaveThatOfOne) {
  // Within the length that errors share, points are at random on one of two sheets: white noise to
  // small patches.
  measure::DepthCamera camera;
  camera.correlated_x = camera.correlated_y = 5;
  detail::NoiseConstants strict;
  strict.shared.constant_power_ratio = strict.shared.sided_constant_power_ratio;
  for (const char* name : {"room", "hall", "balls"}) {
    const auto solids = measure::namedSolids(name);
    const Cloud one = cloudOf(scanByCamera(solids, camera, 3));
    const Cloud other = cloudOf(scanByCamera(solids, camera, 4), 0.001);
    Cloud both = one;
    both.points.insert(both.points.end(), other.points.begin(), other.points.end());
    const PointStore store = storeOf(one), merged = storeOf(both);
    const NoiseLevel noise = recognized(store), merged_noise = recognized(merged);
    const double sigma = store.scale() * std::sqrt(noise.variance);
    EXPECT_NEAR(merged.scale() * std::sqrt(merged_noise.variance) / sigma, 1, 0.1) << name;
    EXPECT_GT(merged_noise.correlation, 0.5 * noise.correlation) << name;
    EXPECT_LT(merged_noise.correlation, 1.2 * noise.correlation) << name;
    EXPECT_LT(recognized(merged, strict).correlation, 0.75 * merged_noise.correlation) << name;
  }
}

TEST(SharedNoise, ATurnedCameraIsFound) {
  measure::DepthCamera camera;
  camera.correlated_x = camera.correlated_y = 3;
  camera.step = 0.125;
  EXPECT_GT(recognized(cloudOf(cameraScan("room", camera), 0.7)).correlation, 2.0);
}

TEST(SharedNoise, MorePlacesMakeTurnedScansAgree) {
  // A turned scan is looked at in other places. Few patches of these balls are plain and wide
  // enough for it.
  measure::DepthCamera camera;
  camera.correlated_x = camera.correlated_y = 9;
  const measure::SensorScan scan = cameraScan("balls", camera);
  detail::NoiseConstants few;
  few.shared.most_places = few.shared.places;
  double least[2] = {HUGE_VAL, HUGE_VAL}, most[2] = {0, 0};  // RMS noise in metres
  for (const double angle : {0.0, 0.001, 0.3, 0.7, 1.3, 2.1, 2.9}) {
    const PointStore store = storeOf(cloudOf(scan, angle));
    const NoiseLevel noise[2] = {recognized(store, few), recognized(store)};
    EXPECT_GT(noise[1].patches, noise[0].patches);
    for (int k = 0; k < 2; ++k) {
      const double rms = store.scale() * std::sqrt(noise[k].variance);
      least[k] = std::min(least[k], rms);
      most[k] = std::max(most[k], rms);
    }
  }
  EXPECT_LT(most[1] / least[1], 1.2);
  EXPECT_GT(most[0] / least[0], 1.25);
}

TEST(SharedNoise, NeighbouringPlacesAreMeasuredOnDifferentPoints) {
  const PointStore store = storeOf(boxNoise(1, 0.002));
  const std::size_t places = 64;
  detail::ThinnedPlaces points(store, places);
  for (const std::size_t stride : {1, 4, 16, 128}) {
    points.thinTo(stride, 1);
    std::set<std::uint32_t> seen, at;
    std::size_t most = 0;
    points.forEach(1, [&](const PointStore& part, NeighborSearch&, std::size_t place,
                          std::size_t s) {
      ASSERT_LT(place, part.size());
      EXPECT_LE(std::abs(static_cast<double>(part.size() * stride) - store.size()), stride) << s;
      at.insert(part.orderOfStore()[place]);
      if (s < 32) seen.insert(part.orderOfStore().begin(), part.orderOfStore().end());
      most = std::max(most, s);
    });
    EXPECT_EQ(most, places - 1);
    EXPECT_EQ(at.size(), places) << stride;
    // Up to a stride of 4 all places have the same points; from there on parts do not overlap.
    const std::size_t parts = std::min<std::size_t>(std::max<std::size_t>(stride / 4, 1), 32);
    EXPECT_NEAR(static_cast<double>(seen.size()),
                static_cast<double>(parts * store.size() / stride), static_cast<double>(parts))
        << stride;
  }
}

/** RMS of relative errors of sigma and of the correlation, as stated and as seeds show them. */
struct ErrorRatio {
  double sigma = 0, correlation = 0;  ///< stated over shown
};

ErrorRatio errorRatio(int box) {
  constexpr int kSeeds = 12;
  std::vector<double> sigmas, correlations;
  double sigma_sq = 0, correlation_sq = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const NoiseLevel noise = recognized(boxNoise(box, 0.002, 20 + seed));
    sigmas.push_back(0.5 * std::log(noise.variance));
    correlations.push_back(std::log(noise.correlation));
    sigma_sq += noise.error * noise.error / kSeeds;
    correlation_sq += noise.correlation_error * noise.correlation_error / kSeeds;
  }
  const auto scatter = [](const std::vector<double>& values) {
    double mean = 0, square = 0;
    for (const double v : values) mean += v / kSeeds;
    for (const double v : values) square += (v - mean) * (v - mean) / (kSeeds - 1);
    return std::sqrt(square);
  };
  return {std::sqrt(sigma_sq) / scatter(sigmas), std::sqrt(correlation_sq) / scatter(correlations)};
}

TEST(SharedNoise, StatesItsError) {
  for (const int box : {1, 3, 5}) {
    const ErrorRatio ratio = errorRatio(box);
    EXPECT_GT(ratio.sigma, 0.5) << box;
    EXPECT_LT(ratio.sigma, 2.5) << box;  // halves of the places scatter more than they should
    if (box == 1) continue;
    EXPECT_GT(ratio.correlation, 0.5) << box;
    EXPECT_LT(ratio.correlation, 2.0) << box;
  }
}

/** Places that a first look left, and those that it measured, are all places. */
TEST(SharedNoise, TwoLooksAreOne) {
  const PointStore store = storeOf(boxNoise(3, 0.001));
  const detail::NoiseConstants constants;
  for (const std::size_t k : {20u, 1280u}) {  // the wider ones on every fourth point
    detail::ThinnedPlaces at_once(store, 300), first(store, 300), rest(store, 300);
    const detail::PatchScale all = measureScale(at_once, k, constants, 2);
    const detail::PatchScale few = measureScale(first, k, constants, 2, nullptr, {3});
    const detail::PatchScale both = measureScale(rest, k, constants, 2, nullptr, {3, &few});
    EXPECT_EQ(std::count_if(few.variances.begin(), few.variances.end(),
                            [](double variance) { return variance >= 0; }),
              100);
    EXPECT_EQ(both.variances, all.variances);
    EXPECT_EQ(both.shared, all.shared);
    EXPECT_EQ(both.radii, all.radii);
  }
}

/** A third of the places is enough where every half of them shows white noise. */
TEST(SharedNoise, TakesMorePlacesThanWhiteNoise) {
  const auto placesOf = [](const Cloud& cloud) {
    const PointStore store = storeOf(cloud);
    const NoiseLevel white = detail::measureNoise(store, {}, 1);
    return detail::recognizeSharedNoise(store, white, {}, 1).patches - white.patches;
  };
  const std::uint64_t white = placesOf(boxNoise(1, 0.001)), shared = placesOf(boxNoise(3, 0.001));
  EXPECT_EQ(white % 100, 0u);
  EXPECT_LT(2 * white, shared);
}

}  // namespace
}  // namespace pcl_slim

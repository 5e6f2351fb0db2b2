// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/noise_level.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pcl_slim/cloud/detail/noise.h"
#include "support/clouds.h"

namespace pcl_slim {
namespace {

using measure::Shape;
using namespace pcl_slim_test;

/** sqrt(lambda) in world units. */
double noiseOf(const PointStore& store, NoiseEstimator estimator = NoiseEstimator::kCubicResidual) {
  return std::sqrt(estimateNoise(store, estimator, 1)) * store.scale();
}

TEST(NoiseLevel, IsWithinATenthOfTheTruth) {
  for (const Shape shape : {Shape::kSphere, Shape::kTorus, Shape::kBumpy}) {
    for (const double noise : {0.0001, 0.0005, 0.002, 0.005}) {
      for (const bool normals : {false, true}) {
        const auto scene = measure::makeScene(shape, 20000, noise, 0.05, 7);
        const Cloud cloud = {scene.points, normals ? scene.normals : std::vector<float>()};
        EXPECT_NEAR(noiseOf(storeOf(cloud)) / (noise * scene.diagonal), 1.0, 0.1)
            << static_cast<int>(shape) << " at " << noise << (normals ? " with" : " without")
            << " normals";
      }
    }
  }
}

TEST(NoiseLevel, OfCleanDataIsNothing) {
  for (const Shape shape : {Shape::kSphere, Shape::kTorus, Shape::kBumpy, Shape::kRelief}) {
    const auto scene = measure::makeScene(shape, 20000, 0.0, 0.0, 7);
    const Cloud cloud = {scene.points, {}};
    const double bound = shape == Shape::kRelief ? 2e-6 : 1e-6;
    EXPECT_LT(noiseOf(storeOf(cloud)), bound * scene.diagonal) << static_cast<int>(shape);
  }
}

TEST(NoiseLevel, SeesTheStepsOfARangeSensor) {
  // A tilted plane whose heights are multiples of a step: an error spread evenly over one step.
  const double step = 0.004;
  const Cloud cloud = pcl_slim_test::heightField(20000, 31, [&](double x, double y) {
    return step * std::round((0.31 * x + 0.17 * y) / step);
  });
  const double sigma = step / std::sqrt(12.0) / std::sqrt(1.0 + 0.31 * 0.31 + 0.17 * 0.17);
  EXPECT_NEAR(noiseOf(storeOf(cloud)) / sigma, 1.0, 0.2);
}

TEST(NoiseLevel, SeesNoiseThatIsThickerThanTheSpacing) {
  // 40000 points on 4 square units are .01 apart; the sheet is ten times thicker.
  std::mt19937_64 random(32);
  std::normal_distribution<double> normal;
  const double sigma = 0.05;
  const Cloud cloud =
      pcl_slim_test::heightField(40000, 33, [&](double, double) { return sigma * normal(random); });
  EXPECT_NEAR(noiseOf(storeOf(cloud)) / sigma, 1.0, 0.15);
}

TEST(NoiseLevel, IsNotTheThicknessOfABody) {
  // A ring whose tube is four deviations thick to either side: patches of five contain its far side.
  const double sigma = 0.06;
  EXPECT_NEAR(noiseOf(storeOf(thickRing(40000, 0.26, sigma, 35))) / sigma, 1.0, 0.1);
}

TEST(NoiseLevel, PutsBackWhatABallCutsOff) {
  // A plane's noise in patches of three deviations, and of many.
  const double sigma = 0.05;
  std::mt19937_64 random(36);
  std::normal_distribution<double> normal(0, sigma);
  Cloud cloud;
  std::uniform_real_distribution<double> side(-1, 1);
  for (int i = 0; i < 40000; ++i)
    cloud.add(side(random) + normal(random), side(random) + normal(random), normal(random));
  const PointStore store = storeOf(cloud);
  EXPECT_NEAR(noiseOf(store) / sigma, 1.0, 0.1);
  const detail::NoiseLevel level = detail::measureNoise(store, {}, 1);
  EXPECT_LT(level.patch_radius * store.scale(), 4 * sigma);
}

TEST(NoiseLevel, ReliefAtEveryScaleIsNotThickNoise) {
  // A tetrahedron of tetrahedra of ... (Sierpinski's): the wider a patch, the farther its points
  // lie from any cubic. A patch of 20 points has a radius of .02.
  Cloud cloud;
  std::mt19937 random(9);
  std::uniform_int_distribution<std::size_t> choice(0, 3);
  const double corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0.5, 0.866, 0}, {0.5, 0.289, 0.816}};
  double p[3] = {0, 0, 0};
  for (int i = 0; i < 20000; ++i) {
    const std::size_t c = choice(random);
    for (std::size_t a = 0; a < 3; ++a) p[a] = 0.5 * (p[a] + corners[c][a]);
    cloud.add(p[0], p[1], p[2]);
  }
  const double noise = noiseOf(storeOf(cloud));
  EXPECT_GT(noise, 0.1 * 0.02);
  EXPECT_LT(noise, 0.25 * 0.02);
}

TEST(NoiseLevel, IgnoresAFewOutliers) {
  const auto scene = measure::makeScene(Shape::kTorus, 20000, 0.001, 0.0, 7);
  Cloud cloud = {scene.points, {}};
  std::mt19937_64 random(34);
  std::uniform_real_distribution<double> u(-1.5, 1.5);
  for (int i = 0; i < 200; ++i) cloud.add(u(random), u(random), 0.4 * u(random));
  EXPECT_NEAR(noiseOf(storeOf(cloud)) / (0.001 * scene.diagonal), 1.0, 0.2);
}

TEST(NoiseLevel, OfTheFirstPaperFollowsTheNoise) {
  double last = 0;
  for (const double noise : {0.0, 0.001, 0.002, 0.005}) {
    const auto scene = measure::makeScene(Shape::kSphere, 20000, noise, 0.0, 7);
    const Cloud cloud = {scene.points, {}};
    const double found = noiseOf(storeOf(cloud), NoiseEstimator::kMinEigenvalue10);
    EXPECT_GT(found, last);
    EXPECT_LT(found, std::max(noise, 3e-4) * scene.diagonal);
    EXPECT_GE(found, 1e-6 * scene.diagonal * 0.99);
    last = found;
  }
}

TEST(NoiseLevel, IsZeroForTooFewPointsAndPositiveForTwelve) {
  Cloud cloud;
  std::mt19937_64 random(35);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 11; ++i) cloud.add(normal(random), normal(random), normal(random));
  for (const auto estimator : {NoiseEstimator::kCubicResidual, NoiseEstimator::kMinEigenvalue10}) {
    EXPECT_EQ(estimateNoise(storeOf(cloud), estimator, 1), 0.0);
  }
  cloud.add(0.1, 0.2, 0.3);
  for (const auto estimator : {NoiseEstimator::kCubicResidual, NoiseEstimator::kMinEigenvalue10}) {
    const double found = estimateNoise(storeOf(cloud), estimator, 1);
    EXPECT_TRUE(std::isfinite(found));
    EXPECT_GT(found, 0.0);
  }
}

TEST(NoiseLevel, SurvivesALineAndAPlane) {
  Cloud line, plane;
  for (int i = 0; i < 500; ++i) line.add(0.3 * i, 0.1 * i, -0.7 * i);
  for (int i = 0; i < 900; ++i) plane.add(i % 30, i / 30, 0.0);
  for (const Cloud& cloud : {line, plane}) {
    for (const auto estimator :
         {NoiseEstimator::kCubicResidual, NoiseEstimator::kMinEigenvalue10}) {
      const PointStore store = storeOf(cloud);
      const double found = std::sqrt(estimateNoise(store, estimator, 1));
      EXPECT_TRUE(std::isfinite(found));
      EXPECT_LT(found, 2e-6 * store.diagonal());
    }
  }
}

/** Patches within a face have no residual at all, and those across an edge have much. */
TEST(NoiseLevel, OfExactPlanesIsANumber) {
  for (const unsigned int seed : {3u, 11u, 12u}) {
    const Cloud cloud = boxCloud({1, 0.8, 0.6}, 12000, 0, seed);
    const PointStore store = storeOf(cloud);
    const detail::NoiseLevel level = detail::measureNoise(store, {}, 1);
    const detail::NoiseLevel shared = detail::recognizeSharedNoise(store, level, {}, 1);
    EXPECT_TRUE(std::isfinite(shared.variance) && shared.variance >= 0) << "seed " << seed;
    EXPECT_LT(std::sqrt(shared.variance), 1e-6) << "seed " << seed;
  }
}

TEST(NoiseLevel, IsTheSameForAnyNumberOfThreads) {
  for (const std::size_t count : {40, 520, 600, 777, 950, 5000}) {
    const PointStore store = storeOf(sceneCloud(Shape::kBumpy, count, 0.01));
    for (const auto estimator :
         {NoiseEstimator::kCubicResidual, NoiseEstimator::kMinEigenvalue10}) {
      const double one = estimateNoise(store, estimator, 1);
      for (int run = 0; run < 5; ++run) {
        EXPECT_EQ(estimateNoise(store, estimator, 2), one) << count;
        EXPECT_EQ(estimateNoise(store, estimator, 8), one) << count;
      }
    }
  }
}

TEST(NoiseLevel, ProfileFollowsNoiseThatVaries) {
  // A plane, four times as noisy on the right as on the left.
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  const Cloud cloud = pcl_slim_test::heightField(
      40000, 12, [&](double x, double) { return 0.0002 * (x < 0 ? 1.0 : 4.0) * normal(random); });
  const PointStore store = storeOf(cloud);
  const std::vector<float> profile = noiseProfile(store, 1);
  ASSERT_GT(profile.size(), 100u);
  const double lambda = estimateNoise(store, NoiseEstimator::kCubicResidual, 1);
  std::size_t near = 0, counted = 0;
  for (std::size_t j = 0; j < profile.size(); ++j) {
    const auto p = store.position((2 * j + 1) * store.size() / (2 * profile.size()));
    const double x = store.origin()[0] + store.scale() * p[0];
    if (std::abs(x) < 0.2) continue;  // windows there may contain both
    const double sigma = std::sqrt(profile[j] * lambda) * store.scale();
    near += std::abs(sigma / (x < 0 ? 0.0002 : 0.0008) - 1.0) < 0.3;
    ++counted;
  }
  EXPECT_GT(static_cast<double>(near), 0.9 * static_cast<double>(counted));
  EXPECT_EQ(profile, noiseProfile(store, 3));
}

/** A plane of 100 x 100 with noise of .02, and on it a small one of .4 x .4 with noise of .0005. */
Cloud planeWithFinePart(std::size_t coarse, std::size_t fine) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share(-0.5, 0.5);
  Cloud cloud;
  for (std::size_t i = 0; i < coarse + fine; ++i) {
    const bool small = i >= coarse;
    const double width = small ? 0.4 : 100, noise = small ? 0.0005 : 0.02;
    const double x = width * share(random), y = width * share(random), e = noise * normal(random);
    cloud.add(x, y, (small ? 3 : 0) + e);
  }
  return cloud;
}

/** A plane whose noise grows from .001 to .005 from left to right. */
Cloud planeOfGrowingNoise() {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  return pcl_slim_test::heightField(40000, 12, [&](double x, double) {
    return 0.001 * std::pow(5, 0.5 * (x + 1)) * normal(random);
  });
}

detail::NoiseLevel wholeNoise(const PointStore& store) {
  const detail::NoiseConstants constants;
  return detail::recognizeSharedNoise(store, detail::measureNoise(store, constants, 2), constants,
                                      2);
}

/** Share of the places of a field where sigma is right within a factor.
 * \param[in] truth sigma at a world position; 0: not compared */
template <typename Truth>
double rightShare(const PointStore& store, const Truth& truth, double factor) {
  const detail::NoiseLevel level = wholeNoise(store);
  const std::vector<float> ratios = detail::measureNoiseField(store, level, false, {}, 2);
  EXPECT_EQ(detail::measureNoiseField(store, level, false, {}, 1), ratios);
  double right = 0, compared = 0;
  for (std::size_t j = 0; j < ratios.size(); ++j) {
    const std::size_t i = (2 * j + 1) * store.size() / (2 * ratios.size());
    Vector3 world{};
    for (std::size_t a = 0; a < 3; ++a)
      world[a] = store.origin()[a] + store.scale() * store.position(i)[a];
    const double wanted = truth(world);
    if (!(wanted > 0)) continue;
    const double sigma = store.scale() * std::sqrt(level.variance * ratios[j]);
    right += std::max(sigma / wanted, wanted / sigma) < factor;
    ++compared;
  }
  EXPECT_GT(compared, 50);
  return right / compared;
}

TEST(NoiseField, FollowsNoiseThatGrows) {
  const PointStore store = storeOf(planeOfGrowingNoise());
  const auto truth = [](const Vector3& p) { return 0.001 * std::pow(5, 0.5 * (p[0] + 1)); };
  EXPECT_GT(rightShare(store, truth, 1.4), 0.95);
}

// Windows across the border of two parts, a few of a hundred, have the noise of either.

TEST(NoiseField, AFinePartHasItsOwn) {
  const PointStore store = storeOf(planeWithFinePart(30000, 20000));
  const auto truth = [](const Vector3& p) { return p[2] > 1.5 ? 0.0005 : 0.02; };
  EXPECT_GT(rightShare(store, truth, 1.4), 0.85);
}

TEST(NoiseField, ACleanPartHasItsOwn) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share;
  Cloud cloud;
  for (std::size_t i = 0; i < 30000; ++i) {
    const double x = share(random), y = share(random);
    cloud.add(x, y, (x < 0.3 ? 0.0002 : 0.005) * normal(random));
  }
  const auto truth = [](const Vector3& p) {
    return std::abs(p[0] - 0.3) < 0.15 ? 0 : p[0] < 0.3 ? 0.0002 : 0.005;
  };
  EXPECT_GT(rightShare(storeOf(cloud), truth, 1.4), 0.85);
}

/** One level is enough for noise that is alike everywhere, on planes and on bent surfaces. */
TEST(NoiseField, EvenNoiseHasOneLevel) {
  for (const Shape shape : {Shape::kSphere, Shape::kTorus, Shape::kBumpy}) {
    for (const double sigma : {0.002, 0.01, 0.03}) {
      const PointStore store = storeOf(sceneCloud(shape, 20000, sigma));
      const detail::NoiseLevel level = wholeNoise(store);
      for (const float ratio : detail::measureNoiseField(store, level, true, {}, 2))
        ASSERT_NEAR(std::log(ratio), 0, 0.5) << sigma;
    }
  }
}

}  // namespace
}  // namespace pcl_slim

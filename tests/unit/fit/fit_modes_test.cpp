// SPDX-License-Identifier: BSD-3-Clause
// Penalties, noise given or measured, outliers, and a box that says nothing about the object.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>

#include "pcl_slim/cloud/noise_level.h"
#include "pcl_slim/surface/surface_io.h"
#include "support/clouds.h"

namespace pcl_slim {
namespace {

using measure::Shape;
using namespace pcl_slim_test;

TEST(FitModes, LeavesRiseAsTheThresholdFalls) {
  const Cloud cloud = sceneCloud(Shape::kBumpy, 10000, 0.001, 0.05);
  for (const bool paper : {false, true}) {
    for (const int degree : {2, 3}) {
      std::uint64_t last = 0;
      for (const double t : {0.05, 0.02, 0.01, 0.005}) {  // below, support decides
        FitParams params;
        params.degree = degree;
        params.size = MDLThreshold{t};
        params.paper_mode = paper;
        const auto f = fitted(cloud, params);
        expectSound(f);
        EXPECT_GT(f.statistics.leaves, last) << "T " << t << (paper ? " paper" : "");
        EXPECT_DOUBLE_EQ(f.surface.info.t_mdl, t);
        EXPECT_EQ(f.surface.info.penalty, 0.0);
        EXPECT_EQ(f.surface.info.paper_mode, paper);
        last = f.statistics.leaves;
      }
    }
  }
}

TEST(FitModes, PaperModeIsAccurateEnough) {
  const auto scene = measure::makeScene(Shape::kBumpy, 20000, 0.0, 0.0, 7);
  FitParams params;
  params.paper_mode = true;
  params.degree = 2;
  params.size = MDLThreshold{0.005};
  const auto f = fitted({scene.points, scene.normals}, params);
  expectSound(f);
  EXPECT_EQ(f.surface.info.blend_kernel, WeightKernel::kGaussian);
  EXPECT_LT(errorsOf(Shape::kBumpy, f).position, 1e-3 * scene.diagonal);
}

TEST(FitModes, DegreeAndPenaltyLeftOpenAreSettled) {
  const Cloud cloud = sceneCloud(Shape::kSphere, 1000, 0.001);
  FitParams params;
  const auto smooth = fitted(cloud, params);
  EXPECT_EQ(smooth.surface.info.degree, 4);
  EXPECT_EQ(smooth.surface.info.penalty, 3.0);
  params.sharp_features = true;
  const auto sharp = fitted(cloud, params);
  EXPECT_EQ(sharp.surface.info.degree, 2);
  EXPECT_EQ(sharp.surface.info.penalty, 1.0);
  params.degree = 3;
  params.size = PenaltyWeight{7.0};
  const auto asked = fitted(cloud, params);
  EXPECT_EQ(asked.surface.info.degree, 3);
  EXPECT_EQ(asked.surface.info.penalty, 7.0);
}

TEST(FitModes, AHeavierPenaltyGivesFewerLeaves) {
  const Cloud cloud = sceneCloud(Shape::kBumpy, 10000, 0.001, 0.05);
  std::uint64_t last = ~0ull;
  for (const double penalty : {1.0, 3.0, 30.0}) {
    FitParams params;
    params.size = PenaltyWeight{penalty};
    const auto f = fitted(cloud, params);
    EXPECT_LT(f.statistics.leaves, last) << penalty;
    EXPECT_EQ(f.surface.info.penalty, penalty);
    last = f.statistics.leaves;
  }
}

TEST(FitModes, TakesTheNoiseItIsGiven) {
  const Cloud cloud = sceneCloud(Shape::kTorus, 8000, 0.0001);
  FitParams params;
  params.lambda = 1e-6;
  const auto given = fitted(cloud, params), measured = fitted(cloud);
  EXPECT_NEAR(given.statistics.lambda, 1e-6, 1e-13);
  EXPECT_NEAR(std::sqrt(measured.statistics.lambda), 0.0001, 0.00002);
  EXPECT_LT(given.statistics.leaves, measured.statistics.leaves);
}

/** lambda of a noise in the cloud's unit. */
double lambdaOf(double noise, const PointStore& store) {
  const double share = noise / (store.diagonal() * store.scale());
  return share * share;
}

TEST(FitModes, NoiseInTheCloudsUnitIsItsLambda) {
  const Cloud cloud = sceneCloud(Shape::kTorus, 8000, 0.002);
  struct Unit {
    double scale;
    std::array<double, 3> origin;
  };
  for (const auto& [scale, origin] :
       {Unit{1, {0, 0, 0}}, Unit{1000, {0, 0, 0}}, Unit{1, {432100.5, 5412345.25, -310}}}) {
    Cloud moved = cloud;
    for (std::size_t i = 0; i < moved.points.size(); ++i)
      moved.points[i] = scale * moved.points[i] + origin[i % 3];
    for (const bool paper : {false, true}) {
      FitParams in_unit, as_share;
      in_unit.paper_mode = as_share.paper_mode = paper;
      in_unit.noise = 0.01 * scale;
      as_share.lambda = lambdaOf(*in_unit.noise, storeOf(moved));
      const auto f = fitted(moved, in_unit), expected = fitted(moved, as_share);
      EXPECT_GT(f.statistics.leaves, 0u);
      EXPECT_EQ(encodeSlim(f.surface), encodeSlim(expected.surface)) << scale << " " << origin[0];
      EXPECT_EQ(f.statistics.lambda, expected.statistics.lambda);
    }
  }
}

TEST(FitModes, NoiseIsLambdaBesideOutliersToo) {
  Cloud cloud = sceneCloud(Shape::kTorus, 8000, 0.002).withoutNormals();
  cloud.add(9, 9, 9);
  FitParams in_unit, as_share;
  in_unit.noise = 0.01;
  as_share.lambda = lambdaOf(0.01, storeOf(cloud));
  const auto f = fitted(cloud, in_unit);
  EXPECT_GT(f.statistics.outliers, 0u);
  EXPECT_EQ(encodeSlim(f.surface), encodeSlim(fitted(cloud, as_share).surface));
}

TEST(FitModes, NoiseWiderThanTheCloudIsRefused) {
  const PointStore store = storeOf(sceneCloud(Shape::kTorus, 2000, 0.0));
  FitParams params;
  params.noise = 5 * store.diagonal() * store.scale();
  SLIMSurface surface;
  const Error error = fitSurface(store, params, surface);
  EXPECT_EQ(error.code, ErrorCode::kBadArgument);
  EXPECT_NE(error.message.find("wider than the cloud"), std::string::npos) << error.message;
  // The smallest and largest numbers neither vanish nor overflow, nor do points at one place.
  params.noise = 1e-300;
  EXPECT_FALSE(fitSurface(store, params, surface));
  EXPECT_EQ(surface.validate().message, "");
  Cloud place;
  for (int i = 0; i < 50; ++i) place.add(1, 2, 3);
  EXPECT_EQ(fitSurface(storeOf(place), params, surface).code, ErrorCode::kNoSurface);
}

TEST(FitModes, TheBoxDoesNotMatter) {
  for (const bool normals : {true, false}) {
    Cloud cloud = sceneCloud(Shape::kBumpy, 20000, 0.001, 0.05);
    if (!normals) cloud = cloud.withoutNormals();
    const std::size_t count = cloud.size();
    const auto alone = errorsOf(Shape::kBumpy, fitted(cloud), count);
    for (const double reach : {20.0, 200.0}) {
      Cloud larger = cloud;
      larger.points.insert(larger.points.end(), {reach, reach, reach});
      if (normals) larger.normals.insert(larger.normals.end(), {0.0f, 0.0f, 1.0f});
      const auto f = fitted(larger);
      expectSound(f);
      const auto boxed = errorsOf(Shape::kBumpy, f, count);
      EXPECT_NEAR(boxed.position / alone.position, 1.0, 0.1)
          << reach << (normals ? " with" : " without");
      EXPECT_NEAR(boxed.normal / alone.normal, 1.0, 0.15)
          << reach << (normals ? " with" : " without");
    }
  }
}

TEST(FitModes, NoisyNormalsHardlyMatter) {
  const auto exact = errorsOf(Shape::kBumpy, fitted(sceneCloud(Shape::kBumpy, 20000, 0.001, 0.0)));
  const auto noisy = errorsOf(Shape::kBumpy, fitted(sceneCloud(Shape::kBumpy, 20000, 0.001, 0.3)));
  EXPECT_NEAR(noisy.position / exact.position, 1.0, 0.1);
  EXPECT_NEAR(noisy.normal / exact.normal, 1.0, 0.1);
}

TEST(FitModes, AFewNormalsTurnedRoundHarmNoOtherPoint) {
  Cloud cloud = sceneCloud(Shape::kTorus, 10000, 0.0005);
  const std::size_t right = 9800;
  const auto before = errorsOf(Shape::kTorus, fitted(cloud), right);
  for (std::size_t i = 3 * right; i < cloud.normals.size(); ++i)
    cloud.normals[i] = -cloud.normals[i];
  const auto f = fitted(cloud);
  expectSound(f);
  EXPECT_TRUE(f.statistics.sides.normals.contradicts());
  EXPECT_LE(f.statistics.skipped_normals, 200u);
  EXPECT_LE(f.statistics.uncovered, 200u);
  EXPECT_LE(f.projection.num_unsupported, 200u);
  EXPECT_NEAR(errorsOf(Shape::kTorus, f, right).position / before.position, 1.0, 0.1);
}

TEST(FitModes, RobustFitsBearOutliers) {
  // One point in twenty is thrown off the torus by up to 2 % of the diagonal, to one side.
  for (const bool normals : {true, false}) {
    Cloud cloud = sceneCloud(Shape::kTorus, 12000, 0.0005);
    std::mt19937_64 random(81);
    std::uniform_real_distribution<double> off(0.02, 0.06);
    for (std::size_t i = 0; i < cloud.size(); i += 20) {
      const double by = off(random);
      for (std::size_t a = 0; a < 3; ++a) cloud.points[3 * i + a] += by * cloud.normals[3 * i + a];
    }
    if (!normals) cloud = cloud.withoutNormals();
    const auto inliers = [&](bool robust) {
      FitParams params;
      params.robust = robust;
      auto f = fitted(cloud, params);
      expectSound(f);
      double sum = 0;
      std::size_t count = 0;
      for (std::size_t i = 0; i < f.store.size(); ++i) {
        if (f.store.orderOfStore()[i] % 20 == 0) continue;
        const double d =
            measure::truthAt(Shape::kTorus, f.world(f.projection.position[i])).distance;
        sum += d * d;
        ++count;
      }
      return std::sqrt(sum / static_cast<double>(count));
    };
    EXPECT_LT(inliers(true), 0.8 * inliers(false))
        << (normals ? "with normals" : "without normals");
  }
}

TEST(FitModes, RobustFitsOfCleanPointsLoseNothing) {
  for (const Shape shape : {Shape::kBumpy, Shape::kTorus}) {
    const Cloud cloud = sceneCloud(shape, 12000, 0.0);
    FitParams params;
    const auto plain = errorsOf(shape, fitted(cloud, params));
    params.robust = true;
    const auto robust = errorsOf(shape, fitted(cloud, params));
    EXPECT_LT(robust.position, 1.1 * plain.position);
    EXPECT_LT(robust.normal, 1.1 * plain.normal);
  }
}

TEST(FitModes, LocalNoiseSparesCleanParts) {
  // A waved sheet whose noise grows twentyfold from left to right.
  const auto height = [](double x, double y) { return 0.03 * std::sin(9 * x) * std::cos(8 * y); };
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const Cloud cloud = pcl_slim_test::heightField(20000, 17, [&](double x, double y) {
    return height(x, y) + 0.0005 * std::exp2((x + 1.0) * 2.16) * normal(random);
  });
  double clean[2] = {}, noisy[2] = {};
  for (const bool local : {false, true}) {
    FitParams params;
    params.local_noise = local;
    const auto f = fitted(cloud, params);
    expectSound(f);
    for (std::size_t i = 0; i < f.store.size(); ++i) {
      const auto p = f.world(f.projection.position[i]);
      if (std::abs(p[0]) > 0.95 || std::abs(p[1]) > 0.95) continue;
      const double d = p[2] - height(p[0], p[1]);
      if (p[0] < -0.5) clean[local] += d * d;
      if (p[0] > 0.5) noisy[local] += d * d;
    }
  }
  EXPECT_LT(std::sqrt(clean[1]), 0.9 * std::sqrt(clean[0]));
  EXPECT_LT(std::sqrt(noisy[1]), 1.1 * std::sqrt(noisy[0]));
}

TEST(FitModes, LocalNoiseMeasuresTheLevelOnce) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const Cloud cloud = pcl_slim_test::heightField(
      20000, 12, [&](double x, double) { return (x < 0 ? 0.001 : 0.004) * normal(random); });
  FitParams params;
  params.noise_correlation = 1;  // recognising shared noise would take patches of its own
  params.local_noise = false;
  const std::uint64_t level = fitted(cloud, params).statistics.noise.patches;
  ASSERT_GT(level, 0u);
  params.local_noise = true;
  // The profile takes a place for each of its runs and nothing else.
  const std::size_t runs = noiseProfile(pcl_slim_test::storeOf(cloud), 1).size();
  EXPECT_EQ(fitted(cloud, params).statistics.noise.patches, level + runs);
  // The paper's estimate and a stated lambda know no patches: there the level is measured for it.
  params.lambda = 1e-6;
  EXPECT_EQ(fitted(cloud, params).statistics.noise.patches, level + runs);
}

TEST(FitModes, LowerDegreesServeEdges) {
  // A noisy roof takes quadratics along its ridge and not where it waves; a noisy sphere takes
  // none.
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const auto roof = fitted(pcl_slim_test::heightField(20000, 17, [&](double x, double y) {
    const double wave = 0.05 * std::sin(6 * x) * std::cos(6 * y);
    return wave - std::abs(x) + 0.004 * normal(random);
  }));
  std::size_t along = 0, elsewhere = 0, leaves = 0;
  for (std::size_t i = 0; i < roof.surface.size(); ++i) {
    if (!roof.surface.isLeaf(i)) continue;
    const auto c = roof.world({roof.surface.cx[i], roof.surface.cy[i], roof.surface.cz[i]});
    const bool quadratic = roof.surface.degree[i] == 2;
    if (std::abs(c[0]) < 0.15) {
      along += quadratic;
    } else {
      elsewhere += quadratic;
      ++leaves;
    }
  }
  EXPECT_GT(along, 50u);
  EXPECT_LT(4 * elsewhere, leaves);
  const auto sphere = fitted(sceneCloud(Shape::kSphere, 20000, 0.002).withoutNormals());
  EXPECT_EQ(sphere.statistics.reduced_degree, 0u);
}

}  // namespace
}  // namespace pcl_slim

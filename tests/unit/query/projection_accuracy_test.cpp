// SPDX-License-Identifier: BSD-3-Clause
// Projected points against exact surfaces.
#include <gtest/gtest.h>

#include <cmath>

#include "support/clouds.h"

namespace pcl_slim {
namespace {

using measure::Shape;
using namespace pcl_slim_test;

/** A tilted square. */
Cloud plane(std::size_t count) {
  return pcl_slim_test::heightField(count, 91,
                                    [](double x, double y) { return 0.3 * x - 0.7 * y + 2.0; });
}

TEST(Projection, LeavesAPlaneAPlane) {
  const double length = std::sqrt(1.0 + 0.3 * 0.3 + 0.7 * 0.7);
  for (int degree = 1; degree <= kMaxDegree; ++degree) {
    for (const bool normals : {false, true}) {
      Cloud cloud = plane(6000);
      for (std::size_t i = 0; normals && i < cloud.size(); ++i) {
        for (const double n : {-0.3, 0.7, 1.0})
          cloud.normals.push_back(static_cast<float>(n / length));
      }
      FitParams params;
      params.degree = degree;
      const auto f = fitted(cloud, params, true);
      expectSound(f);
      EXPECT_EQ(f.statistics.uncovered, 0u);
      EXPECT_EQ(f.projection.num_unsupported, 0u);
      double sum = 0, angle = 0, curvature = 0;
      for (std::size_t i = 0; i < f.store.size(); ++i) {
        const auto p = f.world(f.projection.position[i]);
        sum += std::pow((p[2] - 0.3 * p[0] + 0.7 * p[1] - 2.0) / length, 2);
        angle =
            std::max(angle, pcl_slim_test::angleBetween(f.projection.normal[i], {-0.3, 0.7, 1.0}));
        curvature = std::max(curvature, std::abs(double(f.projection.curvature[i][0])));
      }
      const double n = static_cast<double>(f.store.size());
      EXPECT_LT(std::sqrt(sum / n), 1e-7 * f.store.diagonal() * f.store.scale()) << degree;
      EXPECT_LT(angle, 1e-5) << degree;
      EXPECT_LT(curvature, 1e-2) << degree;
    }
  }
}

/** The share of the noise that one leaf takes up [RMS]: P coefficients follow P / n_eff of its
 * variance. */
double shareOfNoise(const Fitted& f) {
  double coefficients = 0, points = 0;
  for (const std::uint32_t i : f.surface.leaves()) {
    coefficients += numCoefficients(f.surface.degree[i]);
    points += f.surface.effective_count[i];
  }
  return std::sqrt(coefficients / points);
}

/** Mean of 1 / r over the leaves, world units, each counted by its points. */
double meanInverseRadius(const Fitted& f) {
  double sum = 0, weight = 0;
  for (const std::uint32_t i : f.surface.leaves()) {
    sum += f.surface.effective_count[i] / f.surface.radius[i];
    weight += f.surface.effective_count[i];
  }
  return sum / weight / f.store.scale();
}

TEST(Projection, LeavesTheNoiseThatCoefficientsTakeUp) {
  // Leaves that overlap average their errors, which leaves room for bias. A Legendre polynomial of
  // degree d has slopes sqrt(d (d + 1)) times its values (RMS, weighted by 1 - s^2). The relief's
  // fine wave is less than the noise: its slopes are lost.
  const double noise = 0.001, slope = std::sqrt(kMaxDegree * (kMaxDegree + 1.0));
  for (const Shape shape : {Shape::kSphere, Shape::kTorus, Shape::kBumpy, Shape::kRelief}) {
    for (const bool normals : {true, false}) {
      SCOPED_TRACE(std::to_string(static_cast<int>(shape)) + (normals ? " with" : " without"));
      const auto scene = measure::makeScene(shape, 20000, noise, 0.05, 7);
      const auto f = fitted({scene.points, normals ? scene.normals : std::vector<float>()});
      expectSound(f);
      EXPECT_LE(f.statistics.uncovered, 3u);
      EXPECT_EQ(f.projection.num_unsupported, 0u);
      const auto e = errorsOf(shape, f);
      const double bound = shareOfNoise(f) * noise * scene.diagonal;
      EXPECT_LT(e.position, bound);
      if (shape == Shape::kRelief) continue;
      EXPECT_LT(e.normal, slope * bound * meanInverseRadius(f));
    }
  }
}

struct Expected {
  Shape shape;
  double position;   ///< share of the diagonal
  double normal;     ///< rad
  double curvature;  ///< relative
};

// Bias alone: ConvergesWithItsDegree shows how it falls with the spacing, these values at 20,000
// points.
TEST(Projection, IsOnExactSurfacesWithoutNoise) {
  const Expected table[] = {
      {Shape::kSphere, 2e-8, 1.5e-6, 2e-5},
      {Shape::kTorus, 1.3e-8, 8e-6, 1.6e-4},
      {Shape::kBumpy, 9e-8, 5.2e-5, 1.2e-3},
      {Shape::kRelief, 2e-6, 1.6e-3, 3.2e-2},
  };
  for (const Expected& expected : table) {
    for (const bool normals : {true, false}) {
      SCOPED_TRACE(std::to_string(static_cast<int>(expected.shape)) +
                   (normals ? " with" : " without"));
      const auto scene = measure::makeScene(expected.shape, 20000, 0.0, 0.05, 7);
      const auto f =
          fitted({scene.points, normals ? scene.normals : std::vector<float>()}, {}, true);
      expectSound(f);
      EXPECT_LE(f.statistics.uncovered, 3u);
      EXPECT_EQ(f.projection.num_unsupported, 0u);
      const auto e = errorsOf(expected.shape, f);
      EXPECT_LT(e.position / scene.diagonal, expected.position);
      EXPECT_LT(e.normal, expected.normal);
      EXPECT_LT(e.curvature, expected.curvature);
    }
  }
}

TEST(Projection, TakesNoiseAway) {
  for (const Shape shape : {Shape::kSphere, Shape::kTorus, Shape::kBumpy}) {
    const double noise = 0.005;
    const auto scene = measure::makeScene(shape, 20000, noise, 0.05, 7);
    const double limit = shape == Shape::kBumpy ? 0.35 : 0.2;
    const auto with = errorsOf(shape, fitted({scene.points, scene.normals}));
    const auto without = errorsOf(shape, fitted({scene.points, {}}));
    EXPECT_LT(with.position, limit * noise * scene.diagonal) << static_cast<int>(shape);
    EXPECT_LT(without.position, limit * noise * scene.diagonal) << static_cast<int>(shape);
  }
}

TEST(Projection, FlingsNoPoint) {
  // No point of ten thousand moves farther than noise can have thrown it.
  const double noise = 0.001;
  for (const Shape shape : {Shape::kTorus, Shape::kBumpy, Shape::kRelief}) {
    const auto scene = measure::makeScene(shape, 10000, noise, 0.05, 7);
    for (int mode = 0; mode < 8; ++mode) {
      FitParams params;
      params.robust = mode / 2 == 1;
      if (mode / 2 >= 2) params.size = MDLThreshold{0.005};
      params.paper_mode = mode / 2 == 3;
      params.degree = params.paper_mode ? 2 : 4;
      const auto f =
          fitted({scene.points, mode % 2 ? scene.normals : std::vector<float>()}, params);
      for (std::size_t i = 0; i < f.store.size(); ++i) {
        const auto from = f.store.position(i), to = f.projection.position[i];
        const double moved = std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
        ASSERT_LT(moved * f.store.scale(), 6 * noise * scene.diagonal)
            << "point " << i << " of shape " << static_cast<int>(shape) << " in mode " << mode;
      }
    }
  }
}

TEST(Projection, NeedsNoNormals) {
  for (const double noise : {0.0, 0.001}) {
    const Cloud cloud = sceneCloud(Shape::kBumpy, 20000, noise, 0.05);
    const auto with = errorsOf(Shape::kBumpy, fitted(cloud));
    const auto without = errorsOf(Shape::kBumpy, fitted(cloud.withoutNormals()));
    EXPECT_NEAR(without.position / with.position, 1.0, 0.1) << noise;
    EXPECT_NEAR(without.normal / with.normal, 1.0, 0.1) << noise;
  }
}

TEST(Projection, ConvergesWithItsDegree) {
  // Four times the points halve their spacing h; normals gain 2^d of a fit of degree d.
  for (int degree = 1; degree <= kMaxDegree; ++degree) {
    FitParams params;
    params.degree = degree;
    const auto coarse =
        errorsOf(Shape::kBumpy, fitted(sceneCloud(Shape::kBumpy, 8000, 0.0), params));
    const auto fine =
        errorsOf(Shape::kBumpy, fitted(sceneCloud(Shape::kBumpy, 32000, 0.0), params));
    const double gain = std::pow(2.0, degree);
    EXPECT_GT(coarse.normal / fine.normal, 0.6 * gain) << "degree " << degree;
    EXPECT_GT(coarse.position / fine.position, 0.6 * 2.0 * gain) << "degree " << degree;
  }
}

TEST(Projection, RefusesASurfaceWithoutScale) {
  auto f = fitted(sceneCloud(Shape::kSphere, 1000, 0.0));
  f.surface.info.scale = 0.0;
  Projection projection;
  projection.position.resize(5);
  const Error error = projectPoints(f.store, f.surface, ProjectionParams(), projection);
  EXPECT_EQ(error.code, ErrorCode::kBadArgument);
  EXPECT_TRUE(projection.position.empty());
}

TEST(Projection, MovesOtherPointsOntoTheSurfaceToo) {
  // Fitted to one half of the points, evaluated at the other.
  const Cloud all = sceneCloud(Shape::kTorus, 20000, 0.0);
  std::vector<std::int32_t> even, odd;
  for (std::int32_t i = 0; i < 20000; ++i) (i % 2 == 0 ? even : odd).push_back(i);
  const auto take = [](const Cloud& from, const std::vector<std::int32_t>& indices) {
    Cloud taken;
    for (const std::int32_t i : indices) {
      const double* p = from.points.data() + 3 * i;
      taken.add(p[0], p[1], p[2]);
    }
    return taken;
  };
  auto f = fitted(take(all, even));
  f.store = pcl_slim_test::storeOf(take(all, odd));
  ASSERT_EQ(f.store.scale(), f.surface.info.scale);
  const Error error = projectPoints(f.store, f.surface, ProjectionParams(), f.projection);
  ASSERT_FALSE(error) << error.message;
  EXPECT_LT(f.projection.num_unsupported, 10u);
  EXPECT_LT(errorsOf(Shape::kTorus, f).normal, 1e-3);
}

TEST(Projection, StopsWhenAsked) {
  auto f = fitted(sceneCloud(Shape::kSphere, 3000, 0.0));
  Progress progress;
  progress.cancel();
  const Error error =
      projectPoints(f.store, f.surface, ProjectionParams(), f.projection, &progress);
  EXPECT_EQ(error.code, ErrorCode::kCancelled);
  EXPECT_TRUE(f.projection.position.empty());
}

TEST(Projection, OntoNothingKeepsEveryPoint) {
  auto f = fitted(sceneCloud(Shape::kSphere, 300, 0.0));
  f.surface.clear();
  ASSERT_FALSE(projectPoints(f.store, f.surface, ProjectionParams(), f.projection));
  expectSound(f);
  EXPECT_EQ(f.projection.num_unsupported, 300u);
}

}  // namespace
}  // namespace pcl_slim

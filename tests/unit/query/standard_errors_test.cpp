// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/query/standard_errors.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "pcl_slim/query/surface_probe.h"
#include "support/clouds.h"
#include "support/lab/scenes.h"

namespace {

using namespace pcl_slim;
using measure::Shape;

/** A cloud's fit, and its points projected with standard errors. */
struct Fitted {
  PointStore store;
  SLIMSurface surface;
  Projection projection;

  Fitted(const CloudView& view, const FitParams& params = {}, int threads = 1) {
    auto built = PointStore::build(view, threads);
    EXPECT_TRUE(built);
    store = std::move(*built);
    EXPECT_FALSE(fitSurface(store, params, surface));
    project(threads);
  }

  void project(int threads = 1) {
    ProjectionParams params;
    params.curvature = params.errors = true;
    params.threads = threads;
    EXPECT_FALSE(projectPoints(store, surface, params, projection));
  }

  Vector3 world(std::size_t i) const {
    return along(store.origin(), store.scale(), projection.position[i]);
  }

  static Vector3 along(const Vector3& origin, double scale, const Vector3& local) {
    return {origin[0] + scale * local[0], origin[1] + scale * local[1],
            origin[2] + scale * local[2]};
  }

  double meanError() const {
    double sum = 0;
    for (const StandardErrors& e : projection.errors) sum += e.position;
    return sum / static_cast<double>(projection.errors.size());
  }
};

/** Share of the points whose 95 % intervals contain the truth. */
struct Coverage {
  double position = 0, normal = 0, curvature = 0;
};

Coverage coverageOf(Shape shape, std::size_t count, double noise, std::uint64_t seed) {
  const measure::Scene scene = measure::makeScene(shape, count, noise, 0, seed);
  const Fitted fit(measure::viewOf(scene, nullptr, false));
  const double scale = fit.store.scale();
  Coverage found;
  double points = 0;
  for (std::size_t i = 0; i < fit.store.size(); ++i) {
    if (fit.projection.supported[i] == 0) continue;
    const measure::Truth truth = measure::truthAt(shape, fit.world(i));
    if (truth.rim) continue;
    const auto& n = fit.projection.normal[i];
    const double cosine = n[0] * truth.normal[0] + n[1] * truth.normal[1] + n[2] * truth.normal[2];
    const double side = cosine < 0 ? -1 : 1;
    const StandardErrors& e = fit.projection.errors[i];
    const double bent = side * fit.projection.curvature[i][0] - truth.mean_curvature * scale;
    found.position += std::abs(truth.distance) <= 1.96 * e.position * scale ? 1 : 0;
    found.normal += std::acos(std::min(1.0, std::abs(cosine))) <= 1.731 * e.normal ? 1 : 0;
    found.curvature += std::abs(bent) <= 1.96 * e.curvature ? 1 : 0;
    ++points;
  }
  return {found.position / points, found.normal / points, found.curvature / points};
}

TEST(StandardErrors, IntervalsContainTheTruthAsOftenAsTheySay) {
  for (const Shape shape : {Shape::kSphere, Shape::kTorus, Shape::kBumpy}) {
    for (const double noise : {0.0003, 0.001}) {
      const Coverage found = coverageOf(shape, 20000, noise, 3);
      EXPECT_GT(found.position, 0.93);
      EXPECT_LT(found.position, 0.985);
      EXPECT_GT(found.normal, 0.93);
      EXPECT_GT(found.curvature, 0.88);
    }
  }
}

/** The spread of a plane's height over many scans, beside what one scan's fit says of it. */
TEST(StandardErrors, AreTheScatterOfRepeatedScans) {
  constexpr int kScans = 60;
  double sum_sq = 0, said = 0;
  std::size_t places = 0;
  for (int scan = 0; scan < kScans; ++scan) {
    std::mt19937_64 rng(static_cast<std::uint64_t>(scan) + 1);
    std::uniform_real_distribution<double> side(-1, 1);
    std::normal_distribution<double> noise(0, 0.01);
    pcl_slim_test::Cloud cloud;
    for (int k = 0; k < 1500; ++k) {
      const double x = side(rng), y = side(rng);
      cloud.add(x, y, noise(rng));
    }
    const Fitted fit(cloud.view());
    for (std::size_t i = 0; i < fit.store.size(); i += 7) {
      const Vector3 p = fit.world(i);
      if (std::max(std::abs(p[0]), std::abs(p[1])) > 0.8) continue;
      sum_sq += p[2] * p[2];
      const double error = fit.projection.errors[i].position * fit.store.scale();
      said += error * error;
      ++places;
    }
  }
  EXPECT_GT(places, 5000u);
  EXPECT_NEAR(std::sqrt(said / sum_sq), 1.0, 0.2);
}

pcl_slim_test::Cloud noisyPatch(double scale, double shift) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> side(-1, 1);
  std::normal_distribution<double> noise(0, 0.01);
  pcl_slim_test::Cloud cloud;
  for (int k = 0; k < 4000; ++k) {
    const double x = side(rng), y = side(rng), z = 0.1 * x * x + noise(rng);
    cloud.add(scale * x + shift, scale * y, scale * z);
  }
  return cloud;
}

TEST(StandardErrors, AreLargerAtTheBorder) {
  const pcl_slim_test::Cloud cloud = noisyPatch(1, 0);
  const Fitted fit(cloud.view());
  double inner = 0, outer = 0, inside = 0, outside = 0;
  for (std::size_t i = 0; i < fit.store.size(); ++i) {
    const Vector3 p = fit.world(i);
    const double reach = std::max(std::abs(p[0]), std::abs(p[1]));
    if (reach < 0.6) {
      inner += fit.projection.errors[i].position;
      ++inside;
    } else if (reach > 0.97) {
      outer += fit.projection.errors[i].position;
      ++outside;
    }
  }
  EXPECT_GT(outer / outside, 1.5 * inner / inside);
}

TEST(StandardErrors, ScaleWithTheCloud) {
  const pcl_slim_test::Cloud small = noisyPatch(1, 0), large = noisyPatch(1024, 0);
  const Fitted a(small.view()), b(large.view());
  ASSERT_EQ(a.store.size(), b.store.size());
  EXPECT_NEAR(b.meanError() * b.store.scale() / (a.meanError() * a.store.scale()), 1024, 1);
}

TEST(StandardErrors, AreTheSameForAnyNumberOfThreads) {
  const pcl_slim_test::Cloud cloud = noisyPatch(1, 0);
  Fitted fit(cloud.view());
  const std::vector<StandardErrors> one = fit.projection.errors;
  fit.project(3);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].position, fit.projection.errors[i].position);
    EXPECT_EQ(one[i].normal, fit.projection.errors[i].normal);
    EXPECT_EQ(one[i].curvature, fit.projection.errors[i].curvature);
  }
}

/** Points that share their errors bring as much as fewer independent ones. */
TEST(StandardErrors, GrowWithTheRootOfTheCorrelation) {
  const pcl_slim_test::Cloud cloud = noisyPatch(1, 0);
  Fitted fit(cloud.view());
  EXPECT_EQ(fit.surface.info.correlation, 1.0);
  const double independent = fit.meanError();
  fit.surface.info.correlation = 9;
  fit.project();
  EXPECT_GT(fit.meanError(), 2.5 * independent);
  EXPECT_LT(fit.meanError(), 3.6 * independent);
}

TEST(StandardErrors, OfAProbeAreThoseOfTheProjection) {
  const pcl_slim_test::Cloud cloud = noisyPatch(3, 5);
  const Fitted fit(cloud.view());
  std::vector<Vector3> positions;
  std::vector<std::array<float, 3>> normals;
  for (std::size_t i = 0; i < fit.store.size(); i += 11) {
    positions.push_back(fit.world(i));
    normals.push_back(fit.projection.normal[i]);
  }
  const std::vector<StandardErrors> probed = surfaceErrors(fit.surface, positions, normals, 2);
  const auto scale = static_cast<float>(fit.store.scale());
  std::size_t alike = 0;
  for (std::size_t k = 0; k < probed.size(); ++k) {
    const StandardErrors& own = fit.projection.errors[11 * k];
    // The projected point has left the rim of a leaf or entered it here and there.
    const bool same =
        std::abs(probed[k].position - own.position * scale) <= 0.05f * own.position * scale &&
        std::abs(probed[k].normal - own.normal) <= 0.05f * own.normal;
    alike += same ? 1 : 0;
  }
  EXPECT_GT(static_cast<double>(alike), 0.95 * static_cast<double>(probed.size()));
}

TEST(StandardErrors, AreZeroWithoutNoiseAndShape) {
  pcl_slim_test::Cloud cloud;
  for (int x = 0; x < 40; ++x) {
    for (int y = 0; y < 40; ++y) cloud.add(x / 40.0, y / 40.0, 0);
  }
  const Fitted fit(cloud.view());
  for (const StandardErrors& e : fit.projection.errors) EXPECT_LT(e.position, 1e-7);
}

}  // namespace

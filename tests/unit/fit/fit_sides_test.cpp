// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "fit_constants.h"
#include "pcl_slim/core/vector3.h"
#include "support/clouds.h"
#include "support/finger.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

constexpr double kGolden = 0.6180339887498949;

/** RMS over the projected points of their distance to a surface, in the cloud's units. */
template <typename Distance>
double rmsOf(const Fitted& f, const Distance& distance) {
  double sum = 0;
  for (const auto& local : f.projection.position) sum += std::pow(distance(f.world(local)), 2);
  return std::sqrt(sum / static_cast<double>(f.store.size()));
}

/** Two plates a gap apart, spacing 1, with white noise; turned by a rotation of no axis. */
struct Plates {
  double gap, noise;
  Vector3 u = normalized({2, -1, 3}), v = normalized(cross(u, {1, 5, -2})), w = cross(u, v);

  Cloud cloud(int side = 50, double scale = 1) const {
    std::mt19937_64 rng(11);
    std::normal_distribution<double> gauss(0, 1);
    Cloud made;
    for (const double height : {gap / 2, -gap / 2}) {
      for (int i = 0; i < side * side; ++i) {
        const double x = (i + 0.5) / side, y = side * std::fmod(i * kGolden + height, 1.0);
        Vector3 at{x, y, height};
        for (double& value : at) value += noise * gauss(rng);
        const Vector3 p = along(along(scaled(u, at[0]), at[1], v), at[2], w);
        made.add(scale * p[0], scale * p[1], scale * p[2]);
      }
    }
    return made;
  }

  double rms(const Fitted& f, double scale = 1) const {
    return rmsOf(f, [&](const Vector3& p) { return std::abs(dot(p, w)) / scale - gap / 2; });
  }
};

TEST(FitSides, PutsNoisyPointsOntoTheirOwnPlate) {
  const Plates plates{3, 0.3};
  FitParams params;
  const Fitted with = fitted(plates.cloud(), params);
  EXPECT_EQ(with.statistics.sides.points + with.statistics.outliers, with.store.size());
  EXPECT_TRUE(with.store.hasSides());
  EXPECT_FALSE(with.store.hasNormals());
  EXPECT_TRUE(with.surface.info.oriented);
  // Exact normals leave .026; without sides all points end in the middle, 1.5 away.
  EXPECT_LT(plates.rms(with), 0.09);
  params.sides = false;
  const Fitted without = fitted(plates.cloud(), params);
  EXPECT_EQ(without.statistics.sides.points, 0u);
  EXPECT_FALSE(without.store.hasSides());
  EXPECT_GT(plates.rms(without), 1.0);
}

// A wide ball about a point with a wrong side finds few others of that side, anywhere in it, and
// its surface would cut through the body.
TEST(FitSides, NoLeafStartsAtAWrongSide) {
  const Fitted f = fitted(Finger{0.1}.cloud(40000, 0.04));
  ASSERT_GT(f.statistics.sides.points, 0u);
  std::vector<double> density;
  for (const std::uint32_t i : f.surface.leaves()) {
    density.push_back(f.surface.effective_count[i] / std::pow(f.surface.radius[i], 2));
  }
  std::sort(density.begin(), density.end());
  EXPECT_GT(density.front(), 0.1 * density[density.size() / 2]);
  // Points of wrong sides are projected all the same.
  EXPECT_LT(f.projection.num_unsupported, f.store.size() / 1000);
}

TEST(FitSides, PartsCleanSheetsThatAreNear) {
  // Two spheres two spacings apart, far for their noise: a fit without sides takes their middle.
  Cloud cloud;
  std::mt19937_64 rng(5);
  std::normal_distribution<double> gauss(0, 0.1);
  for (const double radius : {19.0, 17.0}) {
    const int points = static_cast<int>(4 * M_PI * radius * radius);
    for (int i = 0; i < points; ++i) {
      const double z = 1 - (2 * i + 1.0) / points, turn = 2 * M_PI * std::fmod(i * kGolden, 1.0);
      const double level = std::sqrt(1 - z * z);
      const Vector3 p = scaled({level * std::cos(turn), level * std::sin(turn), z}, radius);
      cloud.addNoisy(p, gauss, rng);
    }
  }
  const auto rms = [](const Fitted& f) {
    return rmsOf(f, [](const Vector3& p) { return std::abs(length(p) - 18) - 1; });
  };
  FitParams params;
  const Fitted with = fitted(cloud, params);
  params.sides = false;
  const Fitted without = fitted(cloud, params);
  EXPECT_GT(with.statistics.sides.points, 0u);
  EXPECT_LT(with.statistics.lambda, 0.25 * without.statistics.lambda);
  EXPECT_LT(rms(with), 0.05);
  EXPECT_GT(rms(without), 0.3);
}

TEST(FitSides, KeepATubeOfAFewDeviations) {
  // Few places show two sides by themselves, but wide leaves span the tube.
  const double tube = 0.26, sigma = 0.08;
  const Cloud cloud = thickRing(30000, tube, sigma, 8);
  const auto rms = [&](const Fitted& f) {
    return rmsOf(
        f, [&](const Vector3& p) { return std::hypot(std::hypot(p[0], p[1]) - 1, p[2]) - tube; });
  };
  FitParams params;
  const Fitted with = fitted(cloud, params);
  params.sides = false;
  const Fitted without = fitted(cloud, params);
  EXPECT_GT(with.statistics.sides.points, 0u);
  EXPECT_LT(rms(with), 0.25 * sigma);
  EXPECT_GT(rms(without), 0.3 * sigma);
}

// Six points around: no plane of neighbours parts the sides.
TEST(FitSides, KeepARodOfTwoSpacings) {
  const Vector3 u = normalized({2, -1, 3}), v = normalized(cross(u, {1, 5, -2})), w = cross(u, v);
  for (const double noise : {0.0, 0.1}) {
    std::mt19937_64 rng(15);
    std::normal_distribution<double> gauss(0, 1);
    Cloud cloud;
    for (int i = 0; i < 1570; ++i) {
      const double x = (i + 0.5) / (2 * M_PI), angle = 2 * M_PI * std::fmod(i * kGolden, 1.0);
      Vector3 at{x, std::cos(angle), std::sin(angle)};
      for (double& value : at) value += noise * gauss(rng);
      const Vector3 p = along(along(scaled(u, at[0]), at[1], v), at[2], w);
      cloud.add(p[0], p[1], p[2]);
    }
    const auto rms = [&](const Fitted& f) {
      return rmsOf(f, [&](const Vector3& p) { return length(along(p, -dot(p, u), u)) - 1; });
    };
    FitParams without;
    without.sides = false;
    const Fitted f = fitted(cloud);
    EXPECT_GT(f.statistics.sides.confidence, 0.95);
    EXPECT_LT(rms(f), 0.5 * rms(fitted(cloud, without)));
  }
}

/** Two spheres that touch, one below the other, spacing 1; turned by a rotation of no axis. */
struct TouchingSpheres {
  double radius = 20, noise = 0.1;
  Vector3 u, v, w;

  explicit TouchingSpheres(const Vector3& axis)
      : u(normalized(axis)), v(normalized(cross(u, {1, 5, -2}))), w(cross(u, v)) {}

  Cloud cloud() const {
    Cloud made;
    std::mt19937_64 rng(13);
    std::normal_distribution<double> gauss(0, noise);
    const int points = static_cast<int>(4 * M_PI * radius * radius);
    for (const double middle : {radius, -radius}) {
      for (int i = 0; i < points; ++i) {
        const double z = 1 - (2 * i + 1.0) / points, turn = 2 * M_PI * std::fmod(i * kGolden, 1.0);
        const double level = std::sqrt(1 - z * z);
        Vector3 p = scaled(u, middle + radius * z + gauss(rng));
        p = along(p, radius * level * std::cos(turn) + gauss(rng), v);
        p = along(p, radius * level * std::sin(turn) + gauss(rng), w);
        made.add(p[0], p[1], p[2]);
      }
    }
    return made;
  }

  double rms(const Fitted& f) const {
    return rmsOf(f, [&](const Vector3& p) {
      return std::min(std::abs(length(along(p, -radius, u)) - radius),
                      std::abs(length(along(p, radius, u)) - radius));
    });
  }
};

TEST(FitSides, FewThinPlacesGetSidesWhileLeavesAreFitted) {
  std::vector<double> leaves;
  for (const Vector3& axis : {Vector3{0, 0, 1}, Vector3{2, -1, 3}, Vector3{-1, 0.4, 0.2}}) {
    const TouchingSpheres spheres(axis);
    FitParams params;
    const Fitted with = fitted(spheres.cloud(), params);
    leaves.push_back(static_cast<double>(with.statistics.leaves));
    params.sides = false;
    const Fitted without = fitted(spheres.cloud(), params);
    EXPECT_TRUE(with.statistics.sides.for_cover);
    EXPECT_GT(with.statistics.sides.points, with.store.size() / 20);
    EXPECT_LT(with.statistics.sides.points, with.store.size() / 3);
    EXPECT_TRUE(with.store.hasSides());
    EXPECT_TRUE(with.surface.info.oriented);
    EXPECT_LT(spheres.rms(with), 0.5 * spheres.rms(without));
  }
  EXPECT_LT(*std::max_element(leaves.begin(), leaves.end()),
            1.35 * *std::min_element(leaves.begin(), leaves.end()));
}

/** A blade of 30 degrees whose edge is the x axis, spacing 1, noise .1. */
Cloud bladeOf(double length, double width) {
  Cloud blade;
  std::mt19937_64 rng(17);
  std::normal_distribution<double> gauss(0, 0.1);
  const double slope = std::tan(M_PI / 12);
  const int points = static_cast<int>(length * width * std::hypot(1, slope));
  for (const double side : {slope, -slope}) {
    for (int i = 0; i < points; ++i) {
      const double x = length * (i + 0.5) / points, y = width * std::fmod(i * kGolden, 1.0);
      blade.addNoisy({x, y, side * y}, gauss, rng);
    }
  }
  return blade;
}

TEST(FitSides, LargeCloudsWithFewThinPlacesGetThemByAnyNumberOfThreads) {
  const Cloud blade = bladeOf(230, 145);
  FitParams params;
  params.threads = 1;
  const Fitted one = fitted(blade, params);
  params.threads = 3;
  const Fitted three = fitted(blade, params);
  EXPECT_TRUE(one.statistics.sides.for_cover);
  EXPECT_EQ(one.statistics.sides.points, three.statistics.sides.points);
  EXPECT_EQ(one.surface.nz, three.surface.nz);
  EXPECT_EQ(one.surface.coefficients, three.surface.coefficients);
}

TEST(FitSides, LeavesOfABladeFaceApart) {
  const Fitted f = fitted(bladeOf(80, 50), {});
  EXPECT_TRUE(f.statistics.sides.for_cover);
  EXPECT_TRUE(f.surface.info.oriented);
  const SLIMSurface& s = f.surface;
  std::size_t leaves = 0, apart = 0;
  for (const std::uint32_t i : s.leaves()) {
    if (s.info.origin[1] + s.info.scale * s.cy[i] < 2) continue;
    ++leaves;
    apart += s.nz[i] * (s.info.origin[2] + s.info.scale * s.cz[i]) > 0;
  }
  EXPECT_GT(leaves, 100u);
  EXPECT_GE(apart, 0.99 * static_cast<double>(leaves));
}

// Cells at the edge contain both faces; the points of each end on their own.
TEST(FitSides, PointsAtTheEdgeOfABladeStayOnTheirFace) {
  const Vector3 up = {0, -std::sin(M_PI / 12), std::cos(M_PI / 12)}, down = {0, up[1], -up[2]};
  const Fitted f = fitted(bladeOf(80, 50), {});
  EXPECT_LT(rmsOf(f, [&](const Vector3& p) { return std::max(dot(p, up), dot(p, down)); }), 0.022);
}

TEST(FitSides, ScatteredPointsGetNone) {
  // Foliage above ground shows sheets wherever one looks, and they agree as chance has it.
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  Cloud cloud;
  for (int i = 0; i < 40000; ++i) {
    const double x = 200 * uniform(rng), y = 200 * uniform(rng);
    const bool tree = std::hypot(std::fmod(x, 40) - 20, std::fmod(y, 40) - 20) < 8;
    cloud.add(x, y, tree ? 3 + 10 * uniform(rng) : 0.05 * uniform(rng));
  }
  const Fitted f = fitted(cloud, {});
  EXPECT_GE(f.statistics.sides.thin_places, 0.02);
  EXPECT_LT(f.statistics.sides.points, f.store.size() / 100);
}

TEST(FitSides, NarrowerCellsKeepPlatesApart) {
  // As one sheet the plates show twice their noise, and cells cut by that contain both.
  const Plates plates{1.5, 0.3};
  const Fitted f = fitted(plates.cloud(), {});
  EXPECT_GT(f.statistics.sides.points, 0u);
  EXPECT_LT(plates.rms(f), 0.15);
}

TEST(FitSides, PlatesOneSpacingApartGetSidesByTheNarrowestCells) {
  const Plates plates{1, 0.1};
  EXPECT_LT(plates.rms(fitted(plates.cloud(), {})), 0.03);
}

// Cells that contain a bit of the other plate have normals of any direction.
TEST(FitSides, PlatesNextToEachOtherAreAsExactAsFarOnes) {
  for (const double noise : {0.1, 0.3}) {
    const double far = Plates{5, noise}.rms(fitted(Plates{5, noise}.cloud()));
    const Plates near{2, noise};
    const Fitted f = fitted(near.cloud());
    EXPECT_GT(static_cast<double>(f.statistics.sides.points),
              0.99 * static_cast<double>(f.store.size()));
    EXPECT_FALSE(f.surface.info.sides_in_doubt);
    EXPECT_LT(near.rms(f), 1.25 * far) << noise;
  }
}

TEST(FitSides, WideLeavesDoNotReachAPlateFarBehind) {
  const Plates plates{12, 0.3};
  const Cloud cloud = plates.cloud(70);
  FitParams params;
  const Fitted with = fitted(cloud, params);
  params.sides = false;
  const Fitted without = fitted(cloud, params);
  EXPECT_GT(with.statistics.sides.points, 0u);
  EXPECT_LT(with.statistics.leaves, 0.8 * static_cast<double>(without.statistics.leaves));
  EXPECT_LT(plates.rms(with), 0.85 * plates.rms(without));
}

TEST(FitSides, FacesOutward) {
  const Plates plates{3, 0.3};
  const Fitted f = fitted(plates.cloud(), {});
  std::size_t outward = 0;
  for (std::size_t i = 0; i < f.store.size(); ++i) {
    const auto& n = f.projection.normal[i];
    const double side = dot(f.world(f.projection.position[i]), plates.w);
    outward += side * dot({n[0], n[1], n[2]}, plates.w) > 0;
  }
  EXPECT_GT(outward, f.store.size() * 98 / 100);
}

TEST(FitSides, FindsTheNoiseOnceSidesAreKnown) {
  const Plates plates{3, 0.3};
  const Fitted f = fitted(plates.cloud(), {});
  const double sigma = std::sqrt(f.statistics.lambda) * f.store.diagonal() * f.store.scale();
  EXPECT_NEAR(sigma, 0.3, 0.03);
}

TEST(FitSides, DoNotDependOnScale) {
  const Plates plates{3, 0.3};
  for (const double scale : {1e-3, 37.0}) {
    const Fitted f = fitted(plates.cloud(50, scale), {});
    EXPECT_GT(f.statistics.sides.points, 0u) << scale;
    EXPECT_LT(plates.rms(f, scale), 0.09) << scale;
  }
}

TEST(FitSides, TurnAndThinningDoNotDecide) {
  Plates plates{3, 0.3};
  plates.u = {1, 0, 0};
  plates.v = {0, 1, 0};
  plates.w = {0, 0, 1};
  EXPECT_LT(plates.rms(fitted(plates.cloud(), {})), 0.09);
  const Plates turned{3, 0.3};
  Cloud cloud = turned.cloud(70), half;
  for (std::size_t i = 0; i < cloud.size(); i += 2)
    half.add(cloud.points[3 * i], cloud.points[3 * i + 1], cloud.points[3 * i + 2]);
  const Fitted f = fitted(half, {});
  EXPECT_GT(f.statistics.sides.points, 0u);
  EXPECT_LT(turned.rms(f), 0.08);
}

TEST(FitSides, AThickCloudIsFittedAsWithoutThem) {
  const Cloud cloud = sceneCloud(measure::Shape::kTorus, 8000, 0.001).withoutNormals();
  FitParams params;
  const Fitted with = fitted(cloud, params);
  params.sides = false;
  const Fitted without = fitted(cloud, params);
  EXPECT_EQ(with.statistics.sides.points, 0u);
  EXPECT_LT(with.statistics.sides.thin_places, 0.1);
  EXPECT_EQ(with.surface.coefficients, without.surface.coefficients);
  EXPECT_EQ(with.surface.nx, without.surface.nx);
  EXPECT_EQ(with.projection.position, without.projection.position);
}

TEST(FitSides, AnyNumberOfThreadsGivesTheSame) {
  const Plates plates{2, 0.2};
  SLIMSurface surfaces[2];
  for (const int i : {0, 1}) {
    PointStore store = storeOf(plates.cloud());
    FitParams params;
    params.threads = i == 0 ? 1 : 4;
    FitStatistics statistics;
    ASSERT_FALSE(fitSurface(store, params, surfaces[i], &statistics));
    EXPECT_GT(statistics.sides.points, 0u);
  }
  EXPECT_EQ(surfaces[0].coefficients, surfaces[1].coefficients);
  EXPECT_EQ(surfaces[0].nx, surfaces[1].nx);
}

TEST(FitSides, ViewpointsAndGivenNormalsWin) {
  const Plates plates{3, 0.3};
  FitParams params;
  params.viewpoint = {{0, 0, 1000}};
  EXPECT_EQ(fitted(plates.cloud(), params).statistics.sides.points, 0u);
  Cloud cloud = plates.cloud();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double side = 2 * i < cloud.size() ? 1 : -1;
    for (const double n : plates.w) cloud.normals.push_back(static_cast<float>(side * n));
  }
  const Fitted given = fitted(cloud, {});
  EXPECT_EQ(given.statistics.sides.points, 0u);
  EXPECT_TRUE(given.store.hasNormals());
}

TEST(FitSides, AConstStoreStaysAsItIs) {
  const Plates plates{3, 0.3};
  PointStore store = storeOf(plates.cloud());
  const PointStore& fixed = store;
  SLIMSurface surface, again;
  FitStatistics statistics;
  ASSERT_FALSE(fitSurface(fixed, {}, surface, &statistics));
  EXPECT_GT(statistics.sides.points, 0u);
  EXPECT_FALSE(store.hasSides());
  ASSERT_FALSE(fitSurface(store, {}, again));
  EXPECT_TRUE(store.hasSides());
  EXPECT_EQ(surface.coefficients, again.coefficients);
  FitParams off;
  off.sides = false;
  ASSERT_FALSE(fitSurface(store, off, again, &statistics));
  EXPECT_FALSE(store.hasSides());
}

}  // namespace

// SPDX-License-Identifier: BSD-3-Clause
// Sheets that are closer together than a ball is wide.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/clouds.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

constexpr std::size_t kPoints = 30000;
const double kDiagonal = std::sqrt(8.0);

/** Two square sheets, gently waved, gap apart; even points are on the upper one. */
Cloud twoSheets(double gap, double noise, bool opposed, std::uint32_t seed) {
  Cloud cloud;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double x = place(random), y = place(random);
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    const double z = 0.05 * std::sin(2 * x) + 0.5 * side * gap + noise * normal(random);
    const double slope = 0.1 * std::cos(2 * x), length = std::hypot(1.0, slope);
    const double sign = opposed ? side : 1.0;
    cloud.add({x, y, z}, {-sign * slope / length, 0.0, sign / length});
  }
  return cloud;
}

/** RMS distance of projected points to their own sheet, and how many crossed to the other. */
struct SheetErrors {
  double rms = 0;
  std::size_t crossed = 0;
};

SheetErrors sheetErrors(const Fitted& f, double gap) {
  SheetErrors e;
  for (std::size_t i = 0; i < f.store.size(); ++i) {
    const auto p = f.world(f.projection.position[i]);
    const double side = f.store.orderOfStore()[i] % 2 == 0 ? 1.0 : -1.0;
    const double off = p[2] - 0.05 * std::sin(2 * p[0]) - 0.5 * side * gap;
    e.rms += off * off;
    e.crossed += side * off < -0.5 * gap;
  }
  e.rms = std::sqrt(e.rms / static_cast<double>(f.store.size()));
  return e;
}

TEST(FitSheets, StayApartWithOpposedNormals) {
  const double gap = 0.0035 * kDiagonal, noise = 1e-4 * kDiagonal;
  const auto f = fitted(twoSheets(gap, noise, true, 71));
  expectSound(f);
  const SheetErrors e = sheetErrors(f, gap);
  EXPECT_EQ(e.crossed, 0u);
  EXPECT_LT(e.rms, 0.5 * noise);
}

TEST(FitSheets, StayApartWithoutNormals) {
  const double gap = 0.0035 * kDiagonal, noise = 1e-4 * kDiagonal;
  FitParams params;
  // Given, as every neighbourhood contains both sheets and shows their gap in place of the noise.
  params.lambda = 1e-8;
  const auto f = fitted(twoSheets(gap, noise, false, 72).withoutNormals(), params);
  expectSound(f);
  const SheetErrors e = sheetErrors(f, gap);
  EXPECT_EQ(e.crossed, 0u);
  EXPECT_LT(e.rms, 0.5 * noise);
}

TEST(FitSheets, StayApartInAThinPlate) {
  const double gap = 0.001 * kDiagonal;
  const auto f = fitted(twoSheets(gap, 0.0, true, 73));
  expectSound(f);
  const SheetErrors e = sheetErrors(f, gap);
  EXPECT_EQ(e.crossed, 0u);
  EXPECT_LT(e.rms, 0.01 * gap);
  for (std::size_t i = 0; i < f.store.size(); ++i) {
    const float side = f.store.orderOfStore()[i] % 2 == 0 ? 1.0f : -1.0f;
    ASSERT_GT(side * f.projection.normal[i][2], 0.5f);
  }
}

/** Points on the octahedron |x| + |y| + |z| = 1 with the true normals of its faces, which meet at
 * 109 degrees. */
Cloud octahedron(std::size_t count) {
  Cloud cloud;
  std::mt19937_64 random(74);
  std::uniform_real_distribution<double> place(0.0, 1.0);
  for (std::size_t i = 0; i < count; ++i) {
    double a = place(random), b = place(random);
    if (a + b > 1.0) a = 1.0 - a, b = 1.0 - b;
    const double sx = i & 1 ? 1 : -1, sy = i & 2 ? 1 : -1, sz = i & 4 ? 1 : -1;
    const double n = std::sqrt(1.0 / 3.0);
    cloud.add({sx * a, sy * b, sz * (1.0 - a - b)}, {sx * n, sy * n, sz * n});
  }
  return cloud;
}

/** RMS distance to the octahedron's own face of the points that started within reach of an edge. */
double edgeError(const Fitted& f, double reach) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < f.store.size(); ++i) {
    auto p = f.world(f.store.position(i));
    double least = 1.0;
    for (const double value : p) least = std::min(least, std::abs(value));
    if (least > reach) continue;
    p = f.world(f.projection.position[i]);
    const double off = (std::abs(p[0]) + std::abs(p[1]) + std::abs(p[2]) - 1.0) / std::sqrt(3.0);
    sum += off * off;
    ++count;
  }
  return std::sqrt(sum / static_cast<double>(count));
}

/** Both sides of a wedge of 60 degrees whose ridge is waved. */
Cloud wavedWedge(std::size_t points, std::uint32_t seed) {
  Cloud cloud;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (std::size_t i = 0; i < points; ++i) {
    const double y = uniform(random), slant = uniform(random), side = i % 2 == 0 ? 1.0 : -1.0;
    const double z = 0.02 * std::sin(40.0 * y) - slant * std::sqrt(0.75);
    cloud.add(0.5 * side * slant, y, z);
  }
  return cloud;
}

TEST(FitSheets, LeavesOfThinRidgesPassTheirCenters) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    const SLIMSurface surface = fitted(wavedWedge(10000, seed)).surface;
    for (std::size_t i = 0; i < surface.size(); ++i) {
      if (!surface.isLeaf(i) || (surface.flags[i] & kSurfelSupportLimited) != 0) continue;
      EXPECT_LE(std::abs(surface.coefficientsOf(i)[0]), 0.3f) << seed << " " << i;
    }
  }
}

TEST(FitSheets, SharpFeaturesNeedNormals) {
  const PointStore store =
      storeOf(sceneCloud(measure::Shape::kTorus, 5000, 0.001).withoutNormals());
  FitParams params;
  params.threads = 1;
  SLIMSurface plain, sharp;
  ASSERT_FALSE(fitSurface(store, params, plain));
  params.sharp_features = true;
  ASSERT_FALSE(fitSurface(store, params, sharp));
  EXPECT_EQ(plain.radius, sharp.radius);
  EXPECT_EQ(plain.coefficients, sharp.coefficients);
}

TEST(FitSheets, SharpFeaturesKeepEdges) {
  const Cloud cloud = octahedron(12000);
  FitParams sharp;
  sharp.sharp_features = true;
  const auto kept = fitted(cloud, sharp), rounded = fitted(cloud);
  expectSound(kept);
  const double with = edgeError(kept, 0.03), without = edgeError(rounded, 0.03);
  EXPECT_LT(with, 0.1 * without);
  EXPECT_LT(with, 1e-6);
}

}  // namespace
}  // namespace pcl_slim

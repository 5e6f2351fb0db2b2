// SPDX-License-Identifier: BSD-3-Clause
// Whether a cloud needs sides: docs/sides.md, "Sides before the cover".
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pcl_slim/cloud/detail/sides.h"
#include "pcl_slim/core/vector3.h"
#include "support/clouds.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

/** Two plates a gap apart, one point for each squared unit of each, with noise. */
PointStore plates(double gap, double noise, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> uniform(0, 70);
  std::normal_distribution<double> gauss(0, noise);
  Cloud cloud;
  for (int i = 0; i < 9800; ++i) {
    const double x = uniform(rng), y = uniform(rng);
    cloud.addNoisy({x, y, (i % 2 ? gap : -gap) / 2}, gauss, rng);
  }
  return storeOf(cloud);
}

// Cubics fit both with a residual of 1.7 to 1.9 spacings.
TEST(ThinPlaces, TwoSheetsAreNotOneRoughSheet) {
  const detail::SideConstants sides;
  const detail::NoiseConstants noise;
  for (const unsigned seed : {1u, 2u, 3u}) {
    const detail::ThinPlaces two = detail::findThinPlaces(plates(3.2, 0.9, seed), sides, noise, 1);
    EXPECT_GT(two.share, 0.5) << seed;
    EXPECT_NEAR(two.noise / two.spacing, 0.9, 0.3) << seed;
    const detail::ThinPlaces one =
        detail::findThinPlaces(plates(0, 1.84 / std::sqrt(2), seed), sides, noise, 1);
    EXPECT_LT(one.share, 0.035) << seed;
  }
}

/** A sphere of radius 1 with bumps of .1. */
Cloud bumpySphere(double noise) {
  std::mt19937_64 rng(1);
  std::normal_distribution<double> gauss;
  Cloud cloud;
  for (int i = 0; i < 20000; ++i) {
    Vector3 d = normalized({gauss(rng), gauss(rng), gauss(rng)});
    const double radius = 1 + 0.1 * std::sin(6 * d[0]) * std::sin(6 * d[1]) + noise * gauss(rng);
    cloud.add(radius * d[0], radius * d[1], radius * d[2]);
  }
  return cloud;
}

/** Heights of a bump's top and of its slopes are two clusters. */
TEST(ThinPlaces, BumpsAreOneSheet) {
  for (const double noise : {0.0, 0.002}) {
    const detail::ThinPlaces found = detail::findThinPlaces(storeOf(bumpySphere(noise)), {}, {}, 2);
    EXPECT_LT(found.share + found.facing, 0.04) << noise;
  }
}

TEST(ThinPlaces, AnyNumberOfThreadsFindsTheSame) {
  const detail::SideConstants sides;
  const detail::NoiseConstants noise;
  const PointStore store = plates(3.2, 0.9, 1);
  const detail::ThinPlaces expected = detail::findThinPlaces(store, sides, noise, 1);
  for (const int threads : {1, 2, 5}) {
    const detail::ThinPlaces found = detail::findThinPlaces(store, sides, noise, threads);
    EXPECT_EQ(found.share, expected.share);
    EXPECT_EQ(found.noise, expected.noise);
    EXPECT_EQ(found.thin, expected.thin);
  }
}

}  // namespace

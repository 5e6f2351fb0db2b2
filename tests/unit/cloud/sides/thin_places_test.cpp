// SPDX-License-Identifier: BSD-3-Clause
// Whether a cloud needs sides: docs/theory.md, "Sides before the cover".
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pcl_slim/cloud/detail/sides.h"
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

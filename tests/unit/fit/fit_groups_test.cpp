// SPDX-License-Identifier: BSD-3-Clause
// Groups of points so far apart that one set of units cannot represent them all.
#include <gtest/gtest.h>

#include <cmath>

#include "pcl_slim/fit/fit.h"
#include "support/clouds.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

/** Two wavy sheets of unit width, so far apart. \param[in] share of 8000 points in the first */
Cloud twoGroups(double distance, double share) {
  Cloud cloud;
  for (int i = 0; i < 8000; ++i) {
    const double x = std::fmod(i * 0.6180339887, 1.0), y = (i + 0.5) / 8000;
    const double offset = std::fmod(i * 0.7548776662, 1.0) < share ? 0 : distance;
    cloud.add(offset + x, y, 0.1 * std::sin(6 * x) * std::cos(5 * y));
  }
  return cloud;
}

TEST(FitGroups, NoLeafIsFinerThanTheUnitsTell) {
  for (const double distance : {1e3, 1e4, 1e5, 1e7, 1e9, 1e12}) {
    for (const double share : {0.5, 0.7}) {
      const PointStore store = storeOf(twoGroups(distance, share));
      SLIMSurface surface;
      FitStatistics statistics;
      const Error error = fitSurface(store, {}, surface, &statistics);
      EXPECT_LE(surface.size(), store.size()) << distance;
      EXPECT_LE(statistics.gathered, 3000 * store.size()) << distance;
      for (std::size_t i = 0; i < surface.size(); ++i) {
        ASSERT_GT(surface.radius[i], store.centerGrid()) << distance;
      }
      if (distance < 1e5) {
        ASSERT_FALSE(error) << error.message;
        EXPECT_EQ(statistics.unresolved, 0u);
        EXPECT_EQ(statistics.uncovered, 0u);
      }
      // Beyond, a group is hardly more than a place: an error, or right to the cloud's own scale.
      EXPECT_TRUE(error ? error.code == ErrorCode::kNoSurface : statistics.rms_error < 1e-7);
    }
  }
}

TEST(FitGroups, AFarPointMakesNoCoverCoarser) {
  const auto fitWith = [](double far, FitStatistics& statistics) {
    Cloud cloud = twoGroups(0.0, 1.0);
    if (far > 0) cloud.add(far, 0, 0);
    SLIMSurface surface;
    const Error error = fitSurface(storeOf(cloud), {}, surface, &statistics);
    EXPECT_FALSE(error) << error.message;
  };
  FitStatistics alone;
  fitWith(0.0, alone);
  const auto expected = static_cast<double>(alone.leaves);
  for (const double far : {1e1, 1e2, 1e3, 1e4, 1e6, 1e12, 1e38}) {
    FitStatistics statistics;
    fitWith(far, statistics);
    // Wider units turn and shift the cells in whose order centres are tried.
    EXPECT_NEAR(static_cast<double>(statistics.leaves), expected, 0.1 * expected) << far;
    EXPECT_LE(statistics.uncovered, 1u) << far;
    EXPECT_LE(statistics.gathered, 2 * alone.gathered) << far;
  }
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// SLIMSurface on its own: what counts as valid, flipping, counting; and what a fit promises of it.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "pcl_slim/surface/surface_io.h"
#include "support/clouds.h"
#include "support/sphere_surface.h"

namespace pcl_slim {
namespace {

using measure::Shape;
using namespace pcl_slim_test;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

TEST(Surface, NamesItsDefects) {
  EXPECT_FALSE(sphereSurface(4, 40).validate());
  EXPECT_FALSE(SLIMSurface().validate());
  const std::function<void(SLIMSurface&)> defects[] = {
      [](SLIMSurface& s) { s.info.degree = 5; },
      [](SLIMSurface& s) { s.info.degree = 0; },
      [](SLIMSurface& s) { s.cy.pop_back(); },
      [](SLIMSurface& s) { s.effective_count.push_back(1.0f); },
      [](SLIMSurface& s) { s.level.pop_back(); },
      [](SLIMSurface& s) { s.coefficients.pop_back(); },
      [](SLIMSurface& s) { s.degree[7] = 0; },
      [](SLIMSurface& s) { s.degree[7] = 5; },
      [](SLIMSurface& s) { s.radius[7] = 0.0f; },
      [](SLIMSurface& s) { s.radius[7] = -1.0f; },
      [](SLIMSurface& s) { s.radius[7] = kInf; },
      [](SLIMSurface& s) { s.radius[7] = kNan; },
      [](SLIMSurface& s) { s.nx[7] = 3.0f; },
      [](SLIMSurface& s) { s.nz[7] = kNan; },
      [](SLIMSurface& s) { s.cz[7] = kNan; },
      [](SLIMSurface& s) { s.coefficients[7 * 15 + 14] = kInf; },
      // Finite, but beyond what squares in single precision bear.
      [](SLIMSurface& s) { s.radius[7] = 1e38f; },
      [](SLIMSurface& s) { s.radius[7] = 1e20f; },
      [](SLIMSurface& s) { s.radius[7] = 1e-38f; },
      [](SLIMSurface& s) { s.cx[7] = -1e38f; },
      [](SLIMSurface& s) { s.coefficients[7 * 15 + 3] = 1e30f; },
      [](SLIMSurface& s) { s.error[7] = kNan; },
      [](SLIMSurface& s) { s.error[7] = -1.0f; },
      [](SLIMSurface& s) { s.effective_count[7] = kInf; },
      [](SLIMSurface& s) { s.info.scale = 0.0; },
      [](SLIMSurface& s) { s.info.scale = 1e-310; },
      [](SLIMSurface& s) { s.info.scale = kInf; },
      [](SLIMSurface& s) { s.info.origin[1] = kNan; },
      [](SLIMSurface& s) { s.info.origin[2] = -1e308; },
      [](SLIMSurface& s) { s.info.diagonal = kInf; },
      [](SLIMSurface& s) { s.info.lambda = -1.0; },
      [](SLIMSurface& s) { s.info.correlation = 0.5; },
      [](SLIMSurface& s) { s.info.correlation = kNan; },
      [](SLIMSurface& s) { s.info.cover_radius = 0.0; },
      [](SLIMSurface& s) { s.info.cover_radius = kNan; },
      [](SLIMSurface& s) { s.info.cover_threshold = 1.5; },
  };
  for (std::size_t i = 0; i < std::size(defects); ++i) {
    SLIMSurface surface = sphereSurface(4, 40);
    defects[i](surface);
    const Error error = surface.validate();
    EXPECT_EQ(error.code, ErrorCode::kBadInput) << i;
    EXPECT_FALSE(error.message.empty()) << i;
  }
}

TEST(Surface, FlippingKeepsTheZeroSet) {
  SLIMSurface s = sphereSurface(4, 30);
  const SLIMSurface before = s;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const LocalFrame frame({s.nx[i], s.ny[i], s.nz[i]});
    s.flip(i);
    const LocalFrame turned({s.nx[i], s.ny[i], s.nz[i]});
    for (const double u : {-0.6, 0.1, 0.5}) {
      for (const double v : {-0.3, 0.4}) {
        // The point at height h over (u, v), seen from the turned frame.
        const double h = evaluateHeight(s.degree[i], before.coefficientsOf(i), u, v);
        double there[3] = {};
        for (std::size_t a = 0; a < 3; ++a) {
          const double p = u * frame.u[a] + v * frame.v[a] + h * frame.w[a];
          there[0] += p * turned.u[a];
          there[1] += p * turned.v[a];
          there[2] += p * turned.w[a];
        }
        ASSERT_NEAR(evaluateHeight(s.degree[i], s.coefficientsOf(i), there[0], there[1]), there[2],
                    1e-6);
      }
    }
    s.flip(i);
    ASSERT_EQ(s.nx[i], before.nx[i]);
  }
  EXPECT_EQ(s.coefficients, before.coefficients);
}

TEST(Surface, CountsLeavesAndLevels) {
  const SLIMSurface s = sphereSurface(3, 100);
  EXPECT_EQ(s.numLeaves(), 80u);
  EXPECT_EQ(s.numLevels(), 2u);
  EXPECT_EQ(SLIMSurface().numLevels(), 0u);
}

TEST(Surface, CentresAreExactInTheFloatsOfTheWorld) {
  auto cloud = pcl_slim_test::sceneCloud(Shape::kTorus, 3000, 0.001);
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    cloud.points[i] = 3.7 * cloud.points[i] + 41.3;
  const auto f = pcl_slim_test::fitted(cloud);
  const SLIMSurface& s = f.surface;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double x = s.info.origin[0] + s.info.scale * s.cx[i];
    ASSERT_EQ(static_cast<double>(static_cast<float>(x)), x);
  }
}

/** Sum of blending weights of the leaves at every stored point; 0: no leaf's ball contains it. */
TEST(Surface, LeavesHoldEveryCoveredPoint) {
  for (const bool normals : {true, false}) {
    auto cloud = pcl_slim_test::sceneCloud(Shape::kRelief, 5000, 0.0005);
    if (!normals) cloud = cloud.withoutNormals();
    const auto f = pcl_slim_test::fitted(cloud);
    const SLIMSurface& s = f.surface;
    std::uint64_t outside = 0;
    for (std::size_t i = 0; i < f.store.size(); ++i) {
      const auto p = f.store.position(i);
      bool held = false;
      for (std::size_t j = 0; j < s.size() && !held; ++j) {
        held =
            s.isLeaf(j) && std::hypot(p[0] - s.cx[j], p[1] - s.cy[j], p[2] - s.cz[j]) < s.radius[j];
      }
      outside += !held;
    }
    EXPECT_LE(outside, f.statistics.unsupported);
    EXPECT_EQ(f.statistics.leaves, s.numLeaves());
    EXPECT_EQ(f.statistics.leaves + f.statistics.internals, s.size());
    std::uint64_t by_level = 0;
    for (const std::uint64_t count : f.statistics.leaves_per_level) by_level += count;
    EXPECT_EQ(by_level, f.statistics.leaves);
  }
}

TEST(Surface, RadiiShrinkWithTheLevels) {
  const auto f = pcl_slim_test::fitted(pcl_slim_test::sceneCloud(Shape::kRelief, 8000, 0.0));
  const SLIMSurface& s = f.surface;
  ASSERT_GT(s.numLevels(), 2u);
  std::vector<double> largest(256, 0.0);
  for (std::size_t i = 0; i < s.size(); ++i)
    largest[s.level[i]] = std::max(largest[s.level[i]], double(s.radius[i]));
  const double golden = 0.6180339887498949;
  int first = 0;
  for (int k = 255; k > 0; --k) first = largest[static_cast<std::size_t>(k)] > 0 ? k : first;
  for (int k = first; k < 256; ++k) {
    const double most = largest[static_cast<std::size_t>(first)] * std::pow(golden, k - first);
    // A ball that found too few points grows to the radius of the level before.
    EXPECT_LE(largest[static_cast<std::size_t>(k)], most / golden * 1.001) << k;
  }
}

TEST(Surface, LeavesThatAllOverlapAreRefused) {
  SLIMSurface surface = sphereSurface(4, 3000);
  EXPECT_FALSE(surface.checkOverlap());
  for (std::size_t i = 0; i < surface.size(); ++i) {
    surface.cx[i] = surface.cx[0];
    surface.cy[i] = surface.cy[0];
    surface.cz[i] = surface.cz[0];
  }
  EXPECT_NE(surface.checkOverlap().message.find("overlap"), std::string::npos);
  const auto bytes = encodeSlim(surface);
  EXPECT_FALSE(decodeSlim(bytes.data(), bytes.size()));
}

}  // namespace
}  // namespace pcl_slim

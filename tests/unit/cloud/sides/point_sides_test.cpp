// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/detail/sides.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "support/clouds.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using Normals = std::vector<std::array<float, 3>>;

/** Two planes that meet in an edge at 30 degrees, spacing 1, and which of them a point is on. */
struct Blade {
  double slope = std::tan(M_PI / 12);
  PointStore store;

  explicit Blade(double noise) {
    std::mt19937_64 rng(5);
    std::normal_distribution<double> gauss(0, noise);
    Cloud cloud;
    for (int i = 0; i < 2500; ++i) {
      const double x = (i + 0.5) / 50, y = 50 * std::fmod(i * 0.6180339887498949, 1.0);
      for (const double way : {1.0, -1.0}) {
        cloud.addNoisy({x, y, way * slope * x}, gauss, rng);
        upper.push_back(way > 0);
        from_edge.push_back(x);
      }
    }
    store = storeOf(cloud);
  }

  bool isUpper(std::size_t stored) const { return upper[store.orderOfStore()[stored]]; }
  double fromEdge(std::size_t stored) const { return from_edge[store.orderOfStore()[stored]]; }

  /** Outward normals, but for those of points near the edge, which all face up, as those of one
   * cell. */
  Normals normalsOfCells(double near) const {
    const auto z = static_cast<float>(1 / std::hypot(1, slope));
    Normals normals(store.size());
    for (std::size_t i = 0; i < normals.size(); ++i) {
      const float way = isUpper(i) || fromEdge(i) < near ? 1.0f : -1.0f;
      normals[i] = {-z * static_cast<float>(slope), 0, way * z};
    }
    return normals;
  }

  std::size_t wrongBeyond(double least, const Normals& normals) const {
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < normals.size(); ++i)
      wrong += fromEdge(i) > least && (normals[i][2] > 0) != isUpper(i);
    return wrong;
  }

  std::vector<bool> upper;
  std::vector<double> from_edge;
};

/** The greatest angle between the normals of points that have both. */
double greatestAngle(const Normals& normals, const Normals& others) {
  double least = 1;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (others[i] == std::array<float, 3>{}) continue;
    double cosine = 0;
    for (std::size_t a = 0; a < 3; ++a) cosine += double{normals[i][a]} * others[i][a];
    least = std::min(least, cosine);
  }
  return std::acos(std::clamp(least, -1.0, 1.0));
}

TEST(SettleSides, SpreadToTheEdgeOfABlade) {
  const Blade clean(0), noisy(0.1);
  for (const Blade* blade : {&clean, &noisy}) {
    Normals normals = blade->normalsOfCells(6);
    ASSERT_GT(blade->wrongBeyond(2, normals), 150u);
    detail::settleSides(blade->store, {}, 1, normals);
    EXPECT_LE(blade->wrongBeyond(2, normals), 2u);
  }
}

TEST(SettleSides, AnyNumberOfThreadsGivesTheSame) {
  const Blade blade(0.1);
  Normals one = blade.normalsOfCells(6), three = one;
  detail::settleSides(blade.store, {}, 1, one);
  detail::settleSides(blade.store, {}, 3, three);
  EXPECT_EQ(one, three);
}

TEST(SettleSides, RightSidesStayAndPointsWithoutASideGetNone) {
  const Blade blade(0);
  Normals normals = blade.normalsOfCells(0);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (blade.fromEdge(i) > 40) normals[i] = {0, 0, 0};
  }
  const Normals before = normals;
  detail::settleSides(blade.store, {}, 1, normals);
  EXPECT_LT(greatestAngle(normals, before), 1e-3);
}

/** Two plates 2 spacings apart, noise .1, and outward normals of their points. */
struct Plates {
  PointStore store;
  Normals outward;

  Plates() {
    std::mt19937_64 rng(6);
    std::normal_distribution<double> gauss(0, 0.1);
    Cloud cloud;
    for (int i = 0; i < 1600; ++i) {
      const double x = i % 40, y = i / 40;
      for (const double way : {1.0, -1.0}) cloud.addNoisy({x, y, way}, gauss, rng);
    }
    store = storeOf(cloud);
    for (std::size_t i = 0; i < store.size(); ++i)
      outward.push_back({0, 0, store.orderOfStore()[i] % 2 == 0 ? 1.0f : -1.0f});
  }
};

TEST(SettleSides, NormalsAcrossThoseOfTheirNeighboursAreStraightened) {
  const Plates plates;
  Normals normals = plates.outward;
  std::mt19937_64 rng(7);
  for (std::size_t i = 0; i < normals.size(); i += 40) {
    const double angle = std::uniform_real_distribution<double>(0, 2 * M_PI)(rng);
    normals[i] = {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0};
  }
  detail::settleSides(plates.store, {}, 1, normals);
  EXPECT_LT(greatestAngle(normals, plates.outward), 0.15);
}

TEST(SettleSides, PointsHaveTheNormalsOfTheirNeighboursOnTheSheet) {
  const Plates plates;
  Normals normals = plates.outward;
  std::mt19937_64 rng(8);
  std::uniform_real_distribution<float> tilt(-0.5f, 0.5f);
  for (auto& n : normals) {
    const std::array<float, 3> tilted = {tilt(rng), tilt(rng), n[2]};
    const float size = std::hypot(tilted[0], tilted[1], tilted[2]);
    for (std::size_t a = 0; a < 3; ++a) n[a] = tilted[a] / size;
  }
  ASSERT_GT(greatestAngle(normals, plates.outward), 0.5);
  detail::settleSides(plates.store, {}, 1, normals);
  EXPECT_LT(greatestAngle(normals, plates.outward), 0.15);
}

// Sheets of all directions have none in common: the normals of a tube of radius 2 stay.
TEST(SettleSides, NormalsOfATubeAreNotStraightened) {
  Cloud cloud;
  for (int ring = 0; ring < 60; ++ring) {
    for (int i = 0; i < 12; ++i) {
      const double angle = (i + 0.5 * (ring % 2)) * M_PI / 6;
      cloud.add(2 * std::cos(angle), 2 * std::sin(angle), 0.9 * ring);
    }
  }
  const PointStore store = storeOf(cloud);
  Normals outward;
  for (std::size_t i = 0; i < store.size(); ++i) {
    const std::uint32_t at = store.orderOfStore()[i];
    const double angle = (at % 12 + 0.5 * (at / 12 % 2)) * M_PI / 6;
    outward.push_back(
        {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0});
  }
  Normals normals = outward;
  detail::settleSides(store, {}, 1, normals);
  EXPECT_LT(greatestAngle(normals, outward), 0.5);
}

}  // namespace
}  // namespace pcl_slim

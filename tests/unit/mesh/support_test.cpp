// SPDX-License-Identifier: BSD-3-Clause
// A surface exists where points are: thin and noisy bodies, and what floats away from a scan.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "support/clouds.h"

namespace {

using namespace pcl_slim;
using pcl_slim_test::Cloud;

TriangleMesh meshOf(const SLIMSurface& surface, MeshParams params = {},
                    MeshStatistics* statistics = nullptr) {
  params.threads = 1;
  TriangleMesh mesh;
  const Error error = extractMesh(surface, params, mesh, statistics);
  EXPECT_FALSE(error) << error.message;
  return mesh;
}

/** The share of a mesh's area whose triangles have their middle where a test says so. */
template <typename Test>
double shareOfArea(const TriangleMesh& mesh, const Test& test) {
  double all = 0, share = 0;
  for (const auto& t : mesh.triangles) {
    const Vector3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double area = 0.5 * length(cross(subtract(b, a), subtract(c, a)));
    all += area;
    if (test(scaled(along(along(a, 1, b), 1, c), 1.0 / 3))) share += area;
  }
  return share / all;
}

// Wide leaves see a thin branch as a band and leave it across the band, steeply. The share varies with
// the draw and with the rounding of a system's functions.
TEST(Support, AThinBranchHasNoStraySheets) {
  constexpr double kRadius = 0.03, kNoise = 0.004, kTurn = 6.283185307179586;
  std::vector<double> shares;
  for (std::uint64_t seed = 1; seed <= 9; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform;
    std::normal_distribution<double> gauss(0, kNoise);
    Cloud cloud;
    double farthest = 0;
    for (int i = 0; i < 3000; ++i) {
      const double angle = kTurn * uniform(random), z = 2 * uniform(random);
      const double radius = kRadius + gauss(random);
      farthest = std::max(farthest, radius);
      cloud.add(radius * std::cos(angle), radius * std::sin(angle), z);
    }
    const auto f = pcl_slim_test::fitted(cloud);
    const TriangleMesh mesh = meshOf(f.surface);
    const auto isStray = [&](const Vector3& p) { return std::hypot(p[0], p[1]) > farthest; };
    shares.push_back(shareOfArea(mesh, isStray));
    EXPECT_LT(shares.back(), 0.05) << seed;
  }
  EXPECT_LT(median(shares), 1e-2);
}

TEST(Support, NoisyBodiesAreOnePieceWithoutBorder) {
  for (const std::size_t count : {10000, 30000}) {
    const auto f = pcl_slim_test::fitted(
        pcl_slim_test::sceneCloud(measure::Shape::kBumpy, count, 1e-3).withoutNormals());
    MeshStatistics statistics;
    meshOf(f.surface, {}, &statistics);
    EXPECT_EQ(statistics.census.components, 1u) << count;
    EXPECT_EQ(statistics.census.border_edges, 0u) << count;
    EXPECT_EQ(statistics.left_out.components, 0u) << count;
  }
}

/** Points of a disc at a height above a plate, spread as a sunflower's seeds are. */
void addDisc(int count, const Vector3& center, double radius, Cloud& cloud) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, 0.05);
  for (int i = 0; i < count; ++i) {
    const double r = radius * std::sqrt((i + 0.5) / count), turn = 2.39996323 * i;
    const double shift = noise(random);
    cloud.add(center[0] + r * std::cos(turn), center[1] + r * std::sin(turn), center[2] + shift);
  }
}

constexpr Vector3 kCluster{-20, -20, 30}, kObject{25, 25, 30};
constexpr double kObjectRadius = 2.2;

/** A plate of spacing 1, a cluster of 20 points that floats over it, and a ball of 60. */
Cloud plateWithFloats() {
  Cloud cloud;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-0.3, 0.3);
  std::normal_distribution<double> noise(0, 0.05);
  for (int i = 0; i < 8100; ++i) {
    const double x = i % 90 - 45 + uniform(random), y = i / 90 - 45 + uniform(random);
    cloud.add(x, y, noise(random));
  }
  addDisc(20, kCluster, std::sqrt(20 / M_PI), cloud);
  for (int i = 0; i < 60; ++i) {
    const double z = (2 * i + 1) / 60.0 - 1, r = std::sqrt(1 - z * z), turn = 2.39996323 * i;
    cloud.add(kObject[0] + kObjectRadius * r * std::cos(turn),
              kObject[1] + kObjectRadius * r * std::sin(turn), kObject[2] + kObjectRadius * z);
  }
  return cloud;
}

/** Leaves whose centre is near a place. */
std::size_t leavesAt(const SLIMSurface& surface, const Vector3& place) {
  const auto leaves = surface.leaves();
  return static_cast<std::size_t>(std::count_if(leaves.begin(), leaves.end(), [&](std::uint32_t i) {
    const Vector3 center = along(surface.info.origin, surface.info.scale,
                                 {surface.cx[i], surface.cy[i], surface.cz[i]});
    return length(subtract(center, place)) < 8;
  }));
}

TEST(Support, WhatFewPointsAreConnectedToIsLeftOut) {
  const auto f = pcl_slim_test::fitted(plateWithFloats());
  ASSERT_GT(leavesAt(f.surface, kCluster), 0u);
  ASSERT_GT(leavesAt(f.surface, kObject), 0u);
  SLIMSurface drawn = f.surface;
  const DroppedComponents dropped = dropComponents(kLeastComponentPoints, drawn);
  EXPECT_EQ(dropped.components, 1u);
  EXPECT_NEAR(dropped.points, 30, 20) << "closed leaves do not show how bunched their points are";
  EXPECT_EQ(drawn.size() + dropped.leaves, f.surface.size());
  EXPECT_FALSE(drawn.validate());
  EXPECT_EQ(leavesAt(drawn, kCluster), 0u);
  EXPECT_EQ(leavesAt(drawn, kObject), leavesAt(f.surface, kObject));
  const auto isFloating = [](const Vector3& p) { return p[2] > 15 && p[0] < 0; };
  const auto isObject = [](const Vector3& p) { return p[2] > 15 && p[0] > 0; };
  const TriangleMesh mesh = meshOf(f.surface);
  EXPECT_EQ(shareOfArea(mesh, isFloating), 0);
  EXPECT_GT(shareOfArea(mesh, isObject), 0.004);
  MeshParams all;
  all.min_component_points = 0;
  EXPECT_GT(shareOfArea(meshOf(f.surface, all), isFloating), 0.001);
}

TEST(Support, AComponentThatReachesIntoWhatIsNotLoadedStays) {
  const auto f = pcl_slim_test::fitted(plateWithFloats());
  SLIMSurface drawn = f.surface;
  const DroppedComponents dropped =
      dropComponents(50, drawn, 1, {{{{-30, -30, 25}, {-19, -19, 40}}}});
  EXPECT_EQ(dropped.components, 0u);
  EXPECT_EQ(drawn.size(), f.surface.size());
}

TEST(Support, SmallComponentsAreTheSameForAnyNumberOfThreads) {
  const auto f = pcl_slim_test::fitted(plateWithFloats());
  SLIMSurface one = f.surface, four = f.surface, none = f.surface;
  dropComponents(50, one, 1);
  dropComponents(50, four, 4);
  EXPECT_EQ(one.cx, four.cx);
  EXPECT_EQ(one.trim_maps, four.trim_maps);
  EXPECT_EQ(one.children, four.children);
  EXPECT_EQ(dropComponents(0, none).components, 0u);
  EXPECT_EQ(none.size(), f.surface.size());
  EXPECT_EQ(dropComponents(1e9, none).components, 2u) << "the largest stays";
  EXPECT_GT(none.size(), 0u);
}

}  // namespace

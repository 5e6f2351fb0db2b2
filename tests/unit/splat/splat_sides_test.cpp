// SPDX-License-Identifier: BSD-3-Clause
// Splats and the surface of one scan have the same side.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/splat/splat_sampling.h"
#include "support/side_scans.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim_test;

constexpr double kJarHalfHeight = 0.2, kJarWall = 0.012, kJarInner = 0.06;

double jarRadius(double z) {
  return 0.05 + 0.09 * std::exp(-std::pow((z + 0.03) / 0.11, 2));
}

/** A jar with a bottom, open at the top: its inner side is seen a little deep. Outward normals. */
Cloud jarCloud(std::size_t count, std::uint64_t seed) {
  Cloud cloud;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> gauss(0, 0.0003);
  const auto add = [&](double r, double z, double nr, double nz) {
    const double turn = 2 * M_PI * unit(random), c = std::cos(turn), s = std::sin(turn);
    const double size = std::hypot(nr, nz), off = gauss(random) / size;
    r += off * nr;
    cloud.add({r * c, r * s, z + off * nz}, {nr * c / size, nr * s / size, nz / size});
  };
  const double top = jarRadius(kJarHalfHeight), bottom = jarRadius(-kJarHalfHeight);
  while (cloud.size() < count) {
    // A place in the cylinder about the jar, .14 wide, chosen in proportion to the profile's area.
    const double z = kJarHalfHeight * (2 * unit(random) - 1), step = 1e-6;
    const double slope = (jarRadius(z + step) - jarRadius(z - step)) / (2 * step);
    const double area = jarRadius(z) * std::hypot(1, slope);
    if (unit(random) * 0.2 < area) add(jarRadius(z), z, 1, -slope);
    const bool inner = z > kJarHalfHeight - kJarInner;
    if (inner && unit(random) * 0.2 < area) add(jarRadius(z) - kJarWall, z, -1, slope);
    // The rim and the bottom, per .4 of height: their areas are those of rings.
    const double r = 0.14 * unit(random);
    const bool rim = r < top && r > top - kJarWall;
    if (rim && unit(random) * 0.2 < r * 0.35) add(r, kJarHalfHeight, 0, 1);
    if (r < bottom && unit(random) * 0.2 < r * 0.35) add(r, -kJarHalfHeight, 0, -1);
  }
  return cloud;
}

Vector3 splatNormal(const SplatSet& s, std::size_t i) {
  return {s.nx[i], s.ny[i], s.nz[i]};
}

Vector3 splatCenter(const SplatSet& s, std::size_t i) {
  return along(s.origin, 1, {s.x[i], s.y[i], s.z[i]});
}

/** The share of splats whose normal is on the side of the nearest leaf's. */
double shareLikeLeaves(const SplatSet& splats, const SLIMSurface& surface) {
  const auto leaves = surface.leaves();
  double same = 0;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const Vector3 p =
        scaled(subtract(splatCenter(splats, i), surface.info.origin), 1 / surface.info.scale);
    const auto distance = [&](std::uint32_t k) {
      return length(subtract({surface.cx[k], surface.cy[k], surface.cz[k]}, p)) / surface.radius[k];
    };
    const std::uint32_t k = *std::min_element(
        leaves.begin(), leaves.end(),
        [&](std::uint32_t a, std::uint32_t b) { return distance(a) < distance(b); });
    same += dot(splatNormal(splats, i), {surface.nx[k], surface.ny[k], surface.nz[k]}) > 0;
  }
  return same / static_cast<double>(splats.size());
}

/** \param[in] source a fit without any evidence may have given thin parts their sides first */
SLIMSurface surfaceWithSides(const CloudView& view, SideSource source) {
  SLIMSurface surface;
  const auto store = PointStore::build(view, 1);
  EXPECT_TRUE(store);
  FitParams params;
  params.threads = 1;
  params.trim = false;
  FitStatistics statistics;
  const Error error = fitSurface(*store, params, surface, &statistics);
  EXPECT_FALSE(error) << error.message;
  if (statistics.sides.source == SideSource::kThinParts)
    statistics.sides.source = SideSource::kOutward;
  EXPECT_EQ(statistics.sides.source, source);
  return surface;
}

SplatSet splatsOf(const CloudView& view, std::size_t most, SideSource source) {
  SplatSet splats;
  SplatParams params;
  params.threads = 1;
  params.max_splats = most;
  SplatStatistics statistics;
  const Error error = sampleSplats(view, {}, params, splats, &statistics);
  EXPECT_FALSE(error) << error.message;
  EXPECT_EQ(statistics.sides, source);
  return splats;
}

TEST(SplatSides, OfAJarAreThoseOfItsSurface) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Cloud jar = jarCloud(40000, seed).withoutNormals();
    const SLIMSurface surface = surfaceWithSides(jar.view(), SideSource::kOutward);
    for (const std::size_t most : {2000, 5000, 20000}) {
      const SplatSet splats = splatsOf(jar.view(), most, SideSource::kOutward);
      EXPECT_GE(shareLikeLeaves(splats, surface), 0.99) << most << " splats, seed " << seed;
    }
  }
}

TEST(SplatSides, OfAJarAreOutward) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Cloud truth = jarCloud(40000, seed);
    const Cloud jar = truth.withoutNormals();
    for (const std::size_t most : {2000, 5000, 20000}) {
      const SplatSet splats = splatsOf(jar.view(), most, SideSource::kOutward);
      double out = 0;
      for (std::size_t i = 0; i < splats.size(); ++i) {
        const float* n = &truth.normals[3 * splats.kept[i]];
        out += dot(splatNormal(splats, i), {n[0], n[1], n[2]}) > 0;
      }
      EXPECT_GE(out / static_cast<double>(splats.size()), 0.99) << most << " splats, seed " << seed;
    }
  }
}

TEST(SplatSides, OfARoomFaceTheOrigin) {
  const Cloud room = scannedRoom();
  const SLIMSurface surface = surfaceWithSides(room.view(), SideSource::kOrigin);
  for (const std::size_t most : {2000, 5000}) {
    const SplatSet splats = splatsOf(room.view(), most, SideSource::kOrigin);
    EXPECT_GE(shareLikeLeaves(splats, surface), 0.99) << most;
    std::size_t away = 0;
    for (std::size_t i = 0; i < splats.size(); ++i)
      away += dot(splatNormal(splats, i), splatCenter(splats, i)) > 0;
    EXPECT_EQ(away, 0u) << most;
  }
}

TEST(SplatSides, FollowAViewpointAndTheCloudsSensor) {
  const Cloud room = scannedRoom();
  CloudView view = room.view();
  view.sensor = std::array<double, 3>{1, 1, 0};
  const SplatSet splats = splatsOf(view, 2000, SideSource::kViewpoint);
  SplatParams params;
  params.threads = 1;
  params.max_splats = 2000;
  params.viewpoint = {{1, 1, 0}};
  view.sensor.reset();
  SplatSet given;
  ASSERT_FALSE(sampleSplats(view, {}, params, given));
  EXPECT_EQ(given.nx, splats.nx);
  EXPECT_EQ(given.nz, splats.nz);
  for (std::size_t i = 0; i < splats.size(); ++i)
    ASSERT_LE(dot(splatNormal(splats, i), subtract(splatCenter(splats, i), {1, 1, 0})), 0) << i;
}

TEST(SplatSides, GivenNormalsThatContradictAgreeAfterwards) {
  const Cloud truth = jarCloud(40000, 1);
  for (const double share : {0.0, 0.02, 0.3}) {
    Cloud cloud = truth;
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> unit(0, 1);
    for (std::size_t i = 0; i < cloud.normals.size(); i += 3) {
      const float sign = unit(random) < share ? -1 : 1;
      for (std::size_t a = 0; a < 3; ++a) cloud.normals[i + a] *= sign;
    }
    SplatSet splats;
    SplatParams params;
    params.threads = 1;
    params.max_splats = 5000;
    SplatStatistics statistics;
    ASSERT_FALSE(sampleSplats(cloud.view(), {}, params, splats, &statistics));
    EXPECT_EQ(statistics.sides, SideSource::kNormals);
    double out = 0;
    for (std::size_t i = 0; i < splats.size(); ++i) {
      const float* n = &truth.normals[3 * splats.kept[i]];
      out += dot(splatNormal(splats, i), {n[0], n[1], n[2]}) > 0;
    }
    EXPECT_GE(out / static_cast<double>(splats.size()), 0.99) << share << " flipped";
  }
}

}  // namespace

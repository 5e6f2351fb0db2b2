// SPDX-License-Identifier: BSD-3-Clause
// Which surfels get trim maps, and where these put the border.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pcl_slim/query/surface_samples.h"
#include "pcl_slim/surface/surface_io.h"
#include "support/clouds.h"
#include "support/finger.h"

namespace pcl_slim {
namespace {

using measure::Shape;
using namespace pcl_slim_test;

/** A jittered grid of 80 x 80 on the plane, where holds(x, y), at spacing 1 or finer. */
template <typename Holds>
Cloud flatScan(const Holds& holds, int points_a_unit = 1) {
  const int side = 80 * points_a_unit;
  const double spacing = 1.0 / points_a_unit;
  Cloud cloud;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> jitter(-0.25, 0.25);
  for (int k = 0; k < side * side; ++k) {
    const double x = (k % side + jitter(random) + 0.5) * spacing - 40.0,
                 y = (k / side + jitter(random) + 0.5) * spacing - 40.0;
    if (holds(x, y)) cloud.add(x, y, 0.02 * jitter(random) + 1e-3 * (x * x - y * y));
  }
  return cloud;
}

/** Whether a place of the sheet is inside the drawn border: places are projected, in world
 * coordinates. */
std::vector<bool> insideAt(const Fitted& f, const Cloud& places) {
  const PointStore store = storeOf(places);
  Projection projection;
  EXPECT_FALSE(projectPoints(store, f.surface, {}, projection));
  std::vector<bool> inside(places.size());
  for (std::size_t i = 0; i < store.size(); ++i) {
    inside[store.orderOfStore()[i]] = projection.inside[i] != 0;
  }
  return inside;
}

/** Evenly spaced points of the unit sphere, as a golden spiral lays them. */
Cloud latticeSphere() {
  Cloud cloud;
  constexpr int kCount = 10000;
  for (int i = 0; i < kCount; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kCount, r = std::sqrt(1.0 - z * z),
                 turn = 2.39996323 * i;
    const std::array<double, 3> p{r * std::cos(turn), r * std::sin(turn), z};
    cloud.add(p, p);
  }
  return cloud;
}

double sheet(double x, double y) {
  return 1e-3 * (x * x - y * y);
}

/** The share of a surface's area that is farther than a bound from the finger. */
double shareBeyond(const SLIMSurface& surface, const Finger& finger, double bound) {
  SurfaceSampleParams params;
  params.count = 5000;
  SurfaceSamples samples;
  EXPECT_FALSE(sampleSurface(surface, params, samples));
  const auto far = std::count_if(
      samples.position.begin(), samples.position.end(),
      [&](const std::array<double, 3>& p) { return std::abs(finger.distance(p)) > bound; });
  return static_cast<double>(far) / static_cast<double>(samples.size());
}

// Where a finger leaves a sphere, wide leaves of noisy points extend into empty space, though the
// data do not end there: they continue on the finger.
TEST(TrimMaps, NoSailsStandOffANoisyBody) {
  constexpr double kNoise = 0.03;
  const Finger finger{0.1};
  FitParams params;
  params.sides = false;  // they would keep most leaves at the finger
  Fitted f = fitted(finger.cloud(30000, kNoise), params);
  EXPECT_LT(shareBeyond(f.surface, finger, 4 * kNoise), 0.01);
  std::size_t inside = 0;
  for (const std::uint8_t is : f.projection.inside) inside += is;
  EXPECT_GT(inside, f.store.size() * 99 / 100);
  f.surface.dropTrimMaps();
  EXPECT_GT(shareBeyond(f.surface, finger, 4 * kNoise), 0.05);
}

TEST(TrimMaps, ClosedSurfacesLoseNothing) {
  for (const Shape shape : {Shape::kSphere, Shape::kTorus, Shape::kBumpy}) {
    for (const double noise : {0.0, 0.002, 0.005}) {
      const Fitted f = fitted(sceneCloud(shape, 20000, noise));
      EXPECT_EQ(f.projection.inside, f.projection.supported);
      EXPECT_LE(f.statistics.open_leaves, 2u) << noise;
    }
  }
}

// One half has twenty times as many points as the other: between those of the other half a disc
// fits that is as wide as a hole in the first.
TEST(TrimMaps, StepsOfDensityOpenNoLeaf) {
  const Cloud all = sceneCloud(Shape::kSphere, 60000, 0.001);
  std::mt19937_64 random(3);
  Cloud stepped;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double* p = all.points.data() + 3 * i;
    if (p[0] < 0.1 || random() % 20 == 0) stepped.add(p[0], p[1], p[2]);
  }
  const Fitted f = fitted(stepped);
  EXPECT_EQ(f.statistics.open_leaves, 0u);
  EXPECT_EQ(f.projection.inside, f.projection.supported);
}

TEST(TrimMaps, ClosedGridsHaveNone) {
  const Fitted f = fitted(latticeSphere());
  EXPECT_EQ(f.statistics.open_leaves, 0u);
  EXPECT_TRUE(f.surface.trim_maps.empty());
}

TEST(TrimMaps, BordersStandWhereDataEnd) {
  const auto disc = [](double x, double y) { return std::hypot(x, y) < 30.0; };
  const Fitted f = fitted(flatScan(disc));
  EXPECT_GT(f.statistics.open_leaves, 0u);
  EXPECT_LT(f.statistics.open_leaves, f.statistics.leaves);
  Cloud within, beyond;
  for (int k = 0; k < 100; ++k) {
    const double c = std::cos(0.0628 * k), s = std::sin(0.0628 * k);
    within.add(28.5 * c, 28.5 * s, sheet(28.5 * c, 28.5 * s));
    beyond.add(31.5 * c, 31.5 * s, sheet(31.5 * c, 31.5 * s));
  }
  for (const bool inside : insideAt(f, within)) EXPECT_TRUE(inside);
  for (const bool inside : insideAt(f, beyond)) EXPECT_FALSE(inside);
}

// A leaf as wide as the scan: with 64 nodes a side its border was drawn two spacings off.
TEST(TrimMaps, WideLeavesOfManyPointsHaveFineMaps) {
  constexpr int kPointsAUnit = 3;
  const auto disc = [](double x, double y) { return std::hypot(x, y) < 30.0; };
  const Fitted f = fitted(flatScan(disc, kPointsAUnit));
  int finest = 0;
  for (std::size_t i = 0; i < f.surface.size(); ++i) {
    finest = std::max(finest, f.surface.trimMap(i).side);
  }
  EXPECT_GT(finest, 64);
  Cloud within, beyond;
  for (int k = 0; k < 400; ++k) {
    const double c = std::cos(0.0157 * k), s = std::sin(0.0157 * k);
    for (const double off : {-1.5 / kPointsAUnit, 1.5 / kPointsAUnit}) {
      const double r = 30.0 + off;
      (off < 0.0 ? within : beyond).add(r * c, r * s, sheet(r * c, r * s));
    }
  }
  for (const bool inside : insideAt(f, within)) EXPECT_TRUE(inside);
  for (const bool inside : insideAt(f, beyond)) EXPECT_FALSE(inside);
}

TEST(TrimMaps, HolesAreKeptAsTheirSizeAsks) {
  const auto holed = [](double x, double y) {
    return std::hypot(x - 10.0, y) > 5.0 && std::hypot(x + 15.0, y) > 1.25;
  };
  const auto holes = [&](double hole_size) {
    FitParams params;
    params.hole_size = hole_size;
    Cloud middles;
    middles.add(10.0, 0.0, sheet(10.0, 0.0));
    middles.add(-15.0, 0.0, sheet(-15.0, 0.0));
    const auto inside = insideAt(fitted(flatScan(holed), params), middles);
    return std::array<bool, 2>{!inside[0], !inside[1]};
  };
  EXPECT_EQ(holes(5.0), (std::array<bool, 2>{true, false}));  // 10 wide is open, 2.5 is closed
  EXPECT_EQ(holes(14.0), (std::array<bool, 2>{false, false}));
}

TEST(TrimMaps, ChangeNothingElseOfAFit) {
  const Cloud cloud = flatScan([](double x, double y) { return x + 0.3 * y < 12.0; });
  FitParams plain;
  plain.trim = false;
  const Fitted with = fitted(cloud), without = fitted(cloud, plain);
  EXPECT_TRUE(with.surface.hasTrimMaps());
  EXPECT_FALSE(without.surface.hasTrimMaps());
  SLIMSurface dropped = with.surface;
  dropped.dropTrimMaps();
  EXPECT_EQ(encodeSlim(dropped), encodeSlim(without.surface));
  EXPECT_EQ(with.projection.position, without.projection.position);
  EXPECT_EQ(with.projection.supported, without.projection.supported);
  EXPECT_EQ(without.projection.inside, without.projection.supported);
}

TEST(TrimMaps, SameForAnyNumberOfThreads) {
  const Cloud cloud = flatScan([](double x, double y) { return std::sin(x) + std::cos(y) > -1.2; });
  const PointStore store = storeOf(cloud);
  SLIMSurface surfaces[3];
  for (int t = 0; t < 3; ++t) {
    FitParams params;
    params.threads = 1 << 2 * t;
    ASSERT_FALSE(fitSurface(store, params, surfaces[t]));
    EXPECT_GT(surfaces[t].trim_maps.size(), 100u);
    EXPECT_EQ(surfaces[t].trim_maps, surfaces[0].trim_maps);
    EXPECT_EQ(surfaces[t].trim_begin, surfaces[0].trim_begin);
  }
}

TEST(TrimMaps, SizesOutOfRangeAreRefused) {
  for (const double size : {1.9, 51.0, -1.0, std::nan("")}) {
    FitParams params;
    params.hole_size = size;
    EXPECT_NE(params.validate().message.find("hole"), std::string::npos) << size;
  }
}

}  // namespace
}  // namespace pcl_slim

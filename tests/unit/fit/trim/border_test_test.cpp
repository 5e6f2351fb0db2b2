// SPDX-License-Identifier: BSD-3-Clause
// Where data end in a point's own tangent plane, on surfaces whose borders are known. Spacing 1.
#include "trim/trim.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "support/clouds.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

constexpr double kHole = 4.0;

/** One random point a unit of area of a square of 40, where it is kept, and shifted by noise. */
Cloud square(const std::function<bool(double, double)>& kept, double noise = 0.0,
             double per_unit = 1.0, std::uint64_t seed = 5) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-20.0, 20.0);
  std::normal_distribution<double> gauss(0.0, noise > 0.0 ? noise : 1.0);
  const auto shift = [&] { return noise > 0.0 ? gauss(random) : 0.0; };
  Cloud cloud;
  for (int k = 0; k < static_cast<int>(1600 * per_unit); ++k) {
    const double x = uniform(random), y = uniform(random);
    if (!kept(x, y)) continue;
    const double dx = shift(), dy = shift(), dz = shift();
    cloud.add(x + dx, y + dy, dz);
  }
  return cloud;
}

/** Of the points of a cloud at chosen places, how many there are and at how many the data end. */
struct Count {
  int points = 0, ends = 0;

  double share() const { return static_cast<double>(ends) / points; }
  void add(const Count& other) {
    points += other.points;
    ends += other.ends;
  }
};

constexpr Vector3 kUp{0, 0, 1};

Vector3 upwards(const Vector3&) {
  return kUp;
}

/** \param[in] normal of the surface at a place */
Count countEnds(const Cloud& cloud, double noise, const std::function<bool(const Vector3&)>& chosen,
                double spacing = 1.0,
                const std::function<Vector3(const Vector3&)>& normal = upwards,
                float min_dot = -2.0f) {
  const PointStore store = storeOf(cloud);
  const detail::BorderConstants constants;
  detail::PointBorders borders(store.size());
  detail::BorderTest test(store, constants, noise / store.scale(), kHole, min_dot, borders);
  Count count;
  for (std::size_t i = 0; i < store.size(); ++i) {
    const Vector3 world = along(store.origin(), store.scale(), store.position(i));
    if (!chosen(world)) continue;
    ++count.points;
    count.ends += test.endsAt(i, spacing / store.scale(), normal(world));
  }
  return count;
}

bool isInner(const Vector3& p) {
  return std::abs(p[0]) < 15.0 && std::abs(p[1]) < 15.0;
}

/** A face that normals part from the next one ends at the edge between them. */
TEST(BorderTest, NormalsPartTheFacesOfABox) {
  const Cloud box = boxCloud({10, 10, 10}, 2400, 0.0);
  const auto at_edge = [](const Vector3& p) {
    return std::max(std::abs(p[0]), std::abs(p[1])) > 9.999 && std::abs(p[2]) < 8 &&
           std::min(std::abs(p[0]), std::abs(p[1])) > 9.6;
  };
  const auto rounded = [](const Vector3& p) { return normalized({p[0], p[1], 0}); };
  const auto face = [](const Vector3& p) {
    return std::abs(p[0]) > std::abs(p[1]) ? Vector3{1, 0, 0} : Vector3{0, 1, 0};
  };
  const Count one = countEnds(box, 0.0, at_edge, 1.0, rounded, -0.25f);
  EXPECT_GT(one.points, 20);
  EXPECT_EQ(one.ends, 0);
  EXPECT_GT(countEnds(box, 0.0, at_edge, 1.0, face, 0.5f).share(), 0.35);
}

TEST(BorderTest, FindsTheEdgeOfASheetAndNothingElse) {
  for (const double noise : {0.0, 0.3}) {
    Count rim, inside;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const Cloud half = square([](double x, double) { return x < 0.0; }, noise, 1.0, seed);
      rim.add(countEnds(half, noise, [](const Vector3& p) { return isInner(p) && p[0] > (-0.4); }));
      inside.add(
          countEnds(half, noise, [](const Vector3& p) { return isInner(p) && p[0] < -3.0; }));
    }
    EXPECT_GT(rim.points, 80);
    EXPECT_GT(rim.share(), 0.2) << noise;  // others hide the rest; a hundred points: +- .05
    EXPECT_GT(inside.points, 2500);
    EXPECT_LE(inside.ends, 1) << noise;
  }
}

TEST(BorderTest, FindsHolesThatChanceDoesNotLeave) {
  const auto rimOf = [](double hole) {  // of nine holes
    const auto distance = [](double x, double y) {
      return std::hypot(x - 13.0 * std::round(x / 13.0), y - 13.0 * std::round(y / 13.0));
    };
    const Cloud cloud =
        square([&](double x, double y) { return distance(x, y) > 0.5 * hole; }, 0.0, 2.0);
    return countEnds(
        cloud, 0.0, [&](const Vector3& p) { return distance(p[0], p[1]) < 0.5 * hole + 0.4; },
        std::sqrt(0.5));
  };
  const Count wide = rimOf(7.0);
  EXPECT_GT(wide.points, 100);
  EXPECT_GT(wide.share(), 0.2);
  EXPECT_EQ(rimOf(2.0).ends, 0);
}

TEST(BorderTest, ATubeHasNoBorderAtItsSilhouette) {
  const auto outward = [](const Vector3& p) { return normalized(Vector3{p[0], p[1], 0}); };
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> uniform;
  for (const double noise : {0.0, 0.5}) {
    std::normal_distribution<double> gauss(0.0, noise > 0.0 ? noise : 1.0);
    const auto shift = [&] { return noise > 0.0 ? gauss(random) : 0.0; };
    constexpr double kRadius = 6.0, kTurn = 6.283185307179586;
    Cloud tube;
    for (int k = 0; k < 2000; ++k) {
      const double angle = kTurn * uniform(random), z = 54.0 * uniform(random) - 27.0;
      tube.add(kRadius * std::cos(angle) + shift(), kRadius * std::sin(angle) + shift(),
               z + shift());
    }
    const Count middle = countEnds(
        tube, noise, [](const Vector3& p) { return std::abs(p[2]) < 20.0; }, 1.0, outward);
    EXPECT_GT(middle.points, 1000);
    EXPECT_EQ(middle.ends, 0) << noise;
    const Count end = countEnds(
        tube, noise, [](const Vector3& p) { return std::abs(p[2]) > 26.7; }, 1.0, outward);
    EXPECT_GT(end.share(), 0.3) << noise;
  }
}

TEST(BorderTest, DensityThatFallsIsNoBorder) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> uniform;
  const Cloud thinning =
      square([&](double x, double) { return uniform(random) < std::pow(0.05, (x + 20.0) / 40.0); },
             0.0, 4.0);
  const Count inner = countEnds(thinning, 0.0, isInner, 0.5);
  EXPECT_GT(inner.points, 1000);
  EXPECT_LT(inner.share(), 0.003);
}

// A surfel of the floor that continues past the foot of a wall leaves the data there.
TEST(BorderTest, EndsSurfelsThatLeaveTheDataAtAnEdge) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> uniform(-20.0, 20.0);
  Cloud corner;
  for (int k = 0; k < 800; ++k) {
    const double along_edge = uniform(random), across = 0.5 * (uniform(random) + 20.0);
    if (k % 2 == 0) corner.add(-across, along_edge, 0.0);
    if (k % 2 == 1) corner.add(0.0, along_edge, across);
  }
  const auto nextTo = [](double from, double to) {
    return [=](const Vector3& p) { return isInner(p) && p[0] <= -from && p[0] > -to; };
  };
  EXPECT_GT(countEnds(corner, 0.0, nextTo(0.0, 0.5)).share(), 0.5);
  EXPECT_EQ(countEnds(corner, 0.0, nextTo(5.0, 10.0)).ends, 0);
  // Noise tilts planes as much: there an edge decides nothing.
  EXPECT_LT(countEnds(corner, 0.3, nextTo(0.0, 0.5)).share(), 0.4);
}

// Surfels of different spacing share the points' values: who comes first must not matter.
TEST(BorderTest, DoesNotDependOnWhoTestsFirst) {
  const Cloud cloud =
      square([](double x, double y) { return x < 0.0 && std::hypot(x + 9.0, y) > 5.0; });
  const PointStore store = storeOf(cloud);
  const detail::BorderConstants constants;
  detail::PointBorders borders(store.size()), other_borders(store.size());
  detail::BorderTest test(store, constants, 0.0, kHole, -2.0f, borders);
  detail::BorderTest other(store, constants, 0.0, kHole, -2.0f, other_borders);
  int ends = 0;
  for (std::size_t i = 0; i < store.size(); ++i) {
    const double unit = 1.0 / store.scale();
    const bool at_fine = test.endsAt(i, 0.2 * unit, kUp),
               at_coarse = other.endsAt(i, 3.0 * unit, kUp);
    EXPECT_EQ(borders[i].spacing.load(), other_borders[i].spacing.load()) << i;
    EXPECT_LE(at_coarse, at_fine) << i;
    ends += at_fine;
  }
  EXPECT_GT(ends, 10);
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Whether the data end at a point, on surfaces whose borders are known. Spacing 1.
#include "trim/border_test.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "support/clouds.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

constexpr double kHole = 5.0;
constexpr double kTurn = 6.283185307179586;

using Kept = std::function<bool(double, double)>;

/** Random points of a square of 80, where they are kept, shifted by noise. */
Cloud square(const Kept& kept, double noise = 0.0, double per_unit = 1.0, std::uint64_t seed = 5) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-40.0, 40.0);
  std::normal_distribution<double> gauss;
  Cloud cloud;
  for (int k = 0; k < static_cast<int>(6400 * per_unit); ++k) {
    const double x = uniform(random), y = uniform(random);
    if (!kept(x, y)) continue;
    const double dx = noise * gauss(random), dy = noise * gauss(random);
    cloud.add(x + dx, y + dy, noise * gauss(random));
  }
  return cloud;
}

/** How many points there are at chosen places, and at how many of them the data end. */
struct Count {
  int points = 0, ends = 0;

  double share() const { return static_cast<double>(ends) / points; }
  void add(const Count& other) {
    points += other.points;
    ends += other.ends;
  }
};

using Chosen = std::function<bool(const Vector3&)>;

/** What a border test of a store needs. */
struct Tested {
  Tested(const PointStore& store, double noise, float min_dot, bool edges_end)
      : spacing(store, constants, noise / store.scale()),
        borders(store.size()),
        test(store, constants, noise / store.scale(), kHole, min_dot, edges_end, spacing, borders) {
  }

  detail::BorderConstants constants;
  detail::LocalSpacing spacing;
  detail::PointBorders borders;
  detail::BorderTest test;
};

Count countEnds(const Cloud& cloud, double noise, const Chosen& chosen, float min_dot = -2.0f,
                bool edges_end = false) {
  const PointStore store = storeOf(cloud);
  Tested tested(store, noise, min_dot, edges_end);
  Count count;
  for (std::size_t i = 0; i < store.size(); ++i) {
    if (!chosen(along(store.origin(), store.scale(), store.position(i)))) continue;
    ++count.points;
    count.ends += tested.test.isBorder(i);
  }
  return count;
}

bool anywhere(const Vector3&) {
  return true;
}

bool isInner(const Vector3& p) {
  return std::abs(p[0]) < 30.0 && std::abs(p[1]) < 30.0;
}

TEST(BorderTest, ClosedBodiesHaveNoBorder) {
  for (const measure::Shape shape :
       {measure::Shape::kSphere, measure::Shape::kTorus, measure::Shape::kBumpy}) {
    for (const double noise : {0.0, 0.005}) {  // of the diagonal
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const measure::Scene scene = measure::makeScene(shape, 10000, noise, 0.0, seed);
        Cloud cloud;
        for (std::size_t i = 0; i + 2 < scene.points.size(); i += 3)
          cloud.add(scene.points[i], scene.points[i + 1], scene.points[i + 2]);
        EXPECT_LE(countEnds(cloud, noise * scene.diagonal, anywhere).ends, 1) << seed;
      }
    }
  }
}

TEST(BorderTest, EdgesOfABoxAreNoBorder) {
  const Cloud box = boxCloud({10, 10, 10}, 2400, 0.0);
  EXPECT_LE(countEnds(box, 0.0, anywhere).ends, 1);
  EXPECT_EQ(countEnds(box, 0.0, anywhere, -0.25f).ends, 0);
}

/** A face that normals part from the next one ends at the edge between them. */
TEST(BorderTest, SharpFacesEndAtTheirEdges) {
  const Cloud box = boxCloud({10, 10, 10}, 2400, 0.0);
  const auto at_edge = [](const Vector3& p) {
    return std::max(std::abs(p[0]), std::abs(p[1])) > 9.999 && std::abs(p[2]) < 8 &&
           std::min(std::abs(p[0]), std::abs(p[1])) > 9.6;
  };
  const Count ends = countEnds(box, 0.0, at_edge, 0.5f, true);
  EXPECT_GT(ends.points, 20);
  EXPECT_GT(ends.share(), 0.35);
}

TEST(BorderTest, FindsTheEdgeOfASheetAndNothingElse) {
  for (const double noise : {0.0, 0.3, 1.0}) {
    Count rim, inside;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Cloud half = square([](double x, double) { return x < 0.0; }, noise, 1.0, seed);
      rim.add(countEnds(half, noise, [](const Vector3& p) { return isInner(p) && p[0] > (-0.4); }));
      inside.add(countEnds(half, noise, [noise](const Vector3& p) {
        return isInner(p) && p[0] < -3.0 - 2.5 * noise;
      }));
    }
    EXPECT_GT(rim.points, 80);
    EXPECT_GT(rim.share(), 0.25) << noise;  // others hide the rest; a hundred points: +- .05
    EXPECT_GT(inside.points, 2500);
    EXPECT_LE(inside.ends, 1) << noise;
  }
}

// A ball of five sigma contains 12,000 points, of which a fourth is looked at.
TEST(BorderTest, APartOfDenseNoiseShowsWhatAllOfItDoes) {
  constexpr double kNoise = 2.5;
  int rim = 0, ends = 0, all_ends = 0, changed = 0, inside = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const PointStore store =
        storeOf(square([](double x, double) { return x < 0.0; }, kNoise, 25.0, seed));
    Tested part(store, kNoise, -2.0f, false), all(store, kNoise, -2.0f, false);
    all.constants.enough_blocks = store.numBlocks();
    for (std::size_t i = 0; i < store.size(); ++i) {
      const Vector3 p = along(store.origin(), store.scale(), store.position(i));
      if (isInner(p) && p[0] < -10.0 && p[0] > -14.0) inside += part.test.isBorder(i);
      if (!isInner(p) || p[0] < 5.0) continue;
      ++rim;
      ends += part.test.isBorder(i);
      all_ends += all.test.isBorder(i);
      changed += part.test.isBorder(i) != all.test.isBorder(i);
    }
  }
  EXPECT_EQ(inside, 0);
  EXPECT_GT(rim, 80);
  EXPECT_GT(all_ends, 20);
  EXPECT_NEAR(ends, all_ends, 0.3 * all_ends);
  EXPECT_LE(changed, rim / 6);  // those that a point more or less decides
}

/** Distance to the middle of the nearest of many holes. */
double toHole(double x, double y) {
  return std::hypot(x - 20.0 * std::round(x / 20.0), y - 20.0 * std::round(y / 20.0));
}

/** Share of points at the rims of holes of a diameter that are borders. */
double shareAtHoles(double diameter) {
  Count count;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Cloud plate =
        square([&](double x, double y) { return toHole(x, y) > 0.5 * diameter; }, 0.0, 1.0, seed);
    count.add(countEnds(plate, 0.0, [&](const Vector3& p) {
      return isInner(p) && toHole(p[0], p[1]) < 0.5 * diameter + 0.4;
    }));
  }
  EXPECT_GT(count.points, 50);
  return count.share();
}

TEST(BorderTest, FindsHolesThatChanceDoesNotLeave) {
  EXPECT_GT(shareAtHoles(10.0), 0.3);
  EXPECT_GT(shareAtHoles(7.0), 0.2);
  EXPECT_LT(shareAtHoles(3.0), 0.02);
}

TEST(BorderTest, ATubeHasNoBorderAtItsSilhouette) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> gauss;
  for (const double noise : {0.0, 0.5}) {
    constexpr double kRadius = 6.0;
    Cloud tube;
    for (int k = 0; k < 2000; ++k) {
      const double angle = kTurn * uniform(random), z = 54.0 * uniform(random) - 27.0;
      const double dx = noise * gauss(random), dy = noise * gauss(random);
      tube.add(kRadius * std::cos(angle) + dx, kRadius * std::sin(angle) + dy,
               z + noise * gauss(random));
    }
    const Count middle =
        countEnds(tube, noise, [](const Vector3& p) { return std::abs(p[2]) < 20.0; });
    EXPECT_GT(middle.points, 1000);
    EXPECT_EQ(middle.ends, 0) << noise;
    const Count end =
        countEnds(tube, noise, [](const Vector3& p) { return std::abs(p[2]) > 26.7; });
    EXPECT_GT(end.share(), 0.25) << noise;
  }
}

TEST(BorderTest, DensityThatFallsIsNoBorder) {
  const auto countOf = [](const std::function<double(double)>& density) {
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> uniform;
    const Cloud cloud =
        square([&](double x, double) { return uniform(random) < density(x); }, 0.0, 4.0);
    return countEnds(cloud, 0.0, isInner);
  };
  const Count ramp = countOf([](double x) { return std::pow(0.05, (x + 40.0) / 80.0); });
  EXPECT_GT(ramp.points, 3000);
  EXPECT_LE(ramp.ends, 1);
  const Count step = countOf([](double x) { return x < 0.0 ? 1.0 : 0.05; });
  EXPECT_GT(step.points, 3000);
  EXPECT_LE(step.ends, 1);
}

// A sheet under holes fills them in the plane, but normals part both.
TEST(BorderTest, NormalsFindHolesOverAnotherSheet) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(-40.0, 40.0);
  Cloud sheets;
  for (int k = 0; k < 12800; ++k) {
    const double x = uniform(random), y = uniform(random);
    const bool top = k % 2 == 0;
    if (top && toHole(x, y) < 6.0) continue;
    sheets.add({x, y, top ? 3.0 : 0.0}, {0, 0, top ? 1.0 : -1.0});
  }
  const auto shareOf = [&](float min_dot) {
    const Count count = countEnds(
        sheets, 0.0,
        [](const Vector3& p) { return isInner(p) && p[2] > 1.5 && toHole(p[0], p[1]) < 6.4; },
        min_dot);
    EXPECT_GT(count.points, 80);
    return count.share();
  };
  EXPECT_GT(shareOf(-0.25f), 0.25);
  EXPECT_LT(shareOf(-2.0f), 0.05);
}

// The tangent plane comes from the points: what they are turned by must not matter.
TEST(BorderTest, TurnedCloudsHaveTheSameBorders) {
  const Cloud flat = square([](double x, double y) { return std::hypot(x, y) < 30.0; });
  Cloud turned;
  const double c = std::cos(0.7), s = std::sin(0.7);
  for (std::size_t i = 0; i < flat.size(); ++i) {
    const double* p = flat.points.data() + 3 * i;
    turned.add(100.0 + c * p[0] - s * p[1], s * c * p[0] + c * c * p[1] - s * p[2],
               s * s * p[0] + s * c * p[1] + c * p[2]);
  }
  const int ends = countEnds(flat, 0.0, anywhere).ends;
  EXPECT_GT(ends, 40);
  // Blocks, whose points give the spacing, divide a turned cloud elsewhere.
  EXPECT_NEAR(countEnds(turned, 0.0, anywhere).ends, ends, 0.1 * ends);
}

// A disc of radius 30 with a hole of 10: the data end at its rims, whatever the digits and the number of points.
TEST(BorderTest, RoundedAndThinnedCloudsHaveTheSameBorders) {
  const auto radius = [](const Vector3& p) { return std::hypot(p[0], p[1]); };
  const auto isInside = [&](const Vector3& p) { return radius(p) > 9.0 && radius(p) < 26.0; };
  const Cloud cloud = square([](double x, double y) {
    const double r = std::hypot(x, y);
    return r > 5.0 && r < 30.0;
  });
  Cloud rounded, thinned;
  std::mt19937_64 random(3);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double* p = cloud.points.data() + 3 * i;
    const auto round = [](double x) { return std::round(20 * x) / 20; };  // to .05 spacings
    rounded.add(round(p[0]), round(p[1]), round(p[2]));
    if (std::uniform_real_distribution<double>()(random) < 0.8) thinned.add(p[0], p[1], p[2]);
  }
  const int ends = countEnds(cloud, 0.0, anywhere).ends;
  EXPECT_GT(ends, 60);
  EXPECT_NEAR(countEnds(rounded, 0.0, anywhere).ends, ends, 0.1 * ends);
  // Spacings are wider, and points along a rim as many fewer.
  const double expected = std::sqrt(0.8) * ends;
  EXPECT_NEAR(countEnds(thinned, 0.0, anywhere).ends, expected, 0.15 * expected);
  for (const Cloud& made : {cloud, rounded, thinned})
    EXPECT_LE(countEnds(made, 0.0, isInside).ends, 1);
}

// Threads share the points' values: who comes first must not matter.
TEST(BorderTest, DoesNotDependOnWhoTestsFirst) {
  const Cloud cloud =
      square([](double x, double y) { return x < 0.0 && std::hypot(x + 19.0, y) > 8.0; });
  const PointStore store = storeOf(cloud);
  Tested forward(store, 0.0, -2.0f, false), backward(store, 0.0, -2.0f, false);
  const std::size_t n = store.size();
  std::vector<bool> first(n), second(n);
  for (std::size_t i = 0; i < n; ++i) {
    first[i] = forward.test.isBorder(i);
    second[n - 1 - i] = backward.test.isBorder(n - 1 - i);
  }
  EXPECT_EQ(first, second);
  EXPECT_GT(std::count(first.begin(), first.end(), true), 20);
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Textures of a fitted surface: as sharp as the points, calm where nothing varies, of one object.
#include <gtest/gtest.h>

#include <cmath>

#include "pcl_slim/core/cielab.h"
#include "pcl_slim/fit/fit_colors.h"
#include "pcl_slim/query/surface_probe.h"
#include "support/clouds.h"
#include "support/colors.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

using Rgb = std::array<double, 3>;

/** The height of a paraboloid, of which a few leaves are enough. */
double heightAt(double x, double y) {
  return 0.1 * x * x - 0.05 * y * y;
}

/** Points at random over the square [-1, 1]^2, near the paraboloid. */
Cloud bentSquare(std::size_t points) {
  Cloud cloud;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> noise(0.0, 0.003);
  for (std::size_t i = 0; i < points; ++i) {
    const double x = uniform(random), y = uniform(random);
    cloud.add(x, y, heightAt(x, y) + noise(random));
  }
  return cloud;
}

template <typename Color>
Fitted painted(const Cloud& cloud, const Color& color, int threads = 1) {
  Fitted f = fitted(cloud);
  const std::vector<std::uint8_t> bgr = bgrOf(cloud.points, color);
  const Error error = fitColors(f.store, cloud.view(), {bgr.data(), 3}, threads, f.surface);
  EXPECT_FALSE(error) << error.message;
  EXPECT_FALSE(f.surface.validate());
  return f;
}

double deltaE(const Rgb& a, const std::array<std::uint8_t, 3>& b) {
  const auto first = labFromRgb({a[0] / 255, a[1] / 255, a[2] / 255}),
             second = labFromRgb({b[0] / 255.0, b[1] / 255.0, b[2] / 255.0});
  return std::hypot(first[0] - second[0], first[1] - second[1], first[2] - second[2]);
}

/** The colours at places over the square. */
std::vector<std::array<std::uint8_t, 3>> colorsAt(const SLIMSurface& surface,
                                                  const std::vector<std::array<double, 2>>& at) {
  std::vector<Vector3> places;
  for (const auto& [x, y] : at) places.push_back({x, y, heightAt(x, y)});
  return surfaceColors(surface, places, std::vector(at.size(), std::array<float, 3>{0, 0, 1}), 1);
}

/** A checker's colour. */
Rgb checkerAt(double x, double y, double field) {
  const bool dark = (static_cast<int>(std::floor(x / field) + std::floor(y / field)) & 1) != 0;
  return dark ? Rgb{40, 40, 40} : Rgb{220, 200, 180};
}

/** Share of places, 1.5 spacings from a checker's lines, whose colour is within 20 Delta E of it. */
double shareRight(const SLIMSurface& surface, double field, double spacing) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> uniform(-0.9, 0.9);
  const auto off = [&](double at) { return std::abs(at / field - std::round(at / field)) * field; };
  std::vector<std::array<double, 2>> places;
  while (places.size() < 1000) {
    const double x = uniform(random), y = uniform(random);
    if (std::min(off(x), off(y)) >= 1.5 * spacing) places.push_back({x, y});
  }
  const auto colors = colorsAt(surface, places);
  double right = 0;
  for (std::size_t i = 0; i < places.size(); ++i)
    right += deltaE(checkerAt(places[i][0], places[i][1], field), colors[i]) < 20;
  return right / static_cast<double>(places.size());
}

TEST(TextureFit, KeepsTheFieldsOfACheckerThatPointsShow) {
  const Cloud cloud = bentSquare(20000);
  const double spacing = 2 / std::sqrt(20000.0);
  // Random points leave places of a field of 4 spacings without any near.
  const struct {
    double spacings, least, polynomials;
  } rows[] = {{4.0, 0.85, 0.5}, {8.0, 0.97, 0.5}, {16.0, 0.99, 0.9}};
  for (const auto& [spacings, least, polynomials] : rows) {
    const double field = spacings * spacing;
    Fitted f = painted(cloud, [&](const Vector3& p) { return checkerAt(p[0], p[1], field); });
    EXPECT_GT(shareRight(f.surface, field, spacing), least) << spacings;
    f.surface.dropTextures();
    EXPECT_LT(shareRight(f.surface, field, spacing), polynomials) << spacings;
  }
}

TEST(TextureFit, SmoothColoursNeedNone) {
  const Fitted f = painted(bentSquare(10000), [](const Vector3& p) {
    return Rgb{128 + 20 * p[0], 128 + 20 * p[1], 100};
  });
  EXPECT_FALSE(f.surface.hasTextures());
}

TEST(TextureFit, AveragesNoiseWhereNothingVaries) {
  // Grey with noise of 10, but for a sharp disc in the middle.
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 10.0);
  const auto noisy = [&](const Vector3& p) {
    const double grey = (std::hypot(p[0], p[1]) < 0.3 ? 60.0 : 160.0) + noise(random);
    return Rgb{grey, grey, grey};
  };
  const Fitted f = painted(bentSquare(20000), noisy);
  ASSERT_TRUE(f.surface.hasTextures());
  std::vector<std::array<double, 2>> places;
  for (double x = -0.9; x < 0.9; x += 0.03)
    for (double y = -0.9; y < 0.9; y += 0.03)
      if (std::abs(std::hypot(x, y) - 0.3) > 0.05) places.push_back({x, y});
  const auto colors = colorsAt(f.surface, places);
  double square = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double off = colors[i][1] - (std::hypot(places[i][0], places[i][1]) < 0.3 ? 60.0 : 160.0);
    square += off * off;
  }
  EXPECT_LT(std::sqrt(square / static_cast<double>(places.size())), 3.0) << "of the points' 10";
  const auto edge = colorsAt(f.surface, {{0.26, 0.0}, {0.34, 0.0}});
  EXPECT_NEAR(edge[0][0], 60, 15);
  EXPECT_NEAR(edge[1][0], 160, 15);
}

TEST(TextureFit, OfABallDoesNotBleedIntoTheWallBehind) {
  // A camera at the origin sees a red ball before a green wall.
  Cloud cloud;
  const double radius = 0.3, distance = 2.0, wall = 2.6;
  const int n = 180;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double x = (i + 0.5) / n - 0.5, y = (j + 0.5) / n - 0.5;  // of a ray with z = 1
      const double a = x * x + y * y + 1, c = distance * distance - radius * radius;
      const double root = distance * distance - a * c;
      const double t = root > 0 ? (distance - std::sqrt(root)) / a : wall;
      cloud.add(t * x, t * y, t);
    }
  }
  const auto isBall = [&](const Vector3& p) { return p[2] < 0.5 * (distance + wall); };
  const auto color = [&](const Vector3& p) {
    return isBall(p) ? Rgb{200, 30, 30} : Rgb{30, 150, 60};
  };
  const Fitted f = painted(cloud, color);
  std::vector<Vector3> places;
  for (const auto& p : f.projection.position) places.push_back(f.world(p));
  const auto made = surfaceColors(f.surface, places, f.projection.normal, 1);
  double worst = 0, sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double x = places[i][0] / places[i][2], y = places[i][1] / places[i][2];
    // Two spacings inside the outline as the camera sees it.
    const double outline = radius / std::sqrt(distance * distance - radius * radius);
    if (std::abs(std::hypot(x, y) - outline) < 2.0 / n) continue;
    const double off = deltaE(color(places[i]), made[i]);
    worst = std::max(worst, off);
    sum += off;
    ++count;
  }
  EXPECT_LT(worst, 3.0);
  EXPECT_LT(sum / static_cast<double>(count), 0.5);
}

TEST(TextureFit, IsTheSameForAnyThreads) {
  const auto stripes = [](const Vector3& p) {
    return std::sin(40 * p[0]) > 0 ? Rgb{200, 100, 50} : Rgb{20, 60, 90};
  };
  const Cloud cloud = bentSquare(8000);
  const Fitted once = painted(cloud, stripes, 1), again = painted(cloud, stripes, 3);
  ASSERT_TRUE(once.surface.hasTextures());
  EXPECT_EQ(once.surface.textures, again.surface.textures);
}

}  // namespace
}  // namespace pcl_slim

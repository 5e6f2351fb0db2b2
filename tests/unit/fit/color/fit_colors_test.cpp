// SPDX-License-Identifier: BSD-3-Clause
// Colours of a fitted surface: near the points', smooth, of the right sheet, the same for any
// threads.
#include "pcl_slim/fit/fit_colors.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pcl_slim/query/surface_probe.h"
#include "support/clouds.h"
#include "support/colors.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using measure::Shape;

template <typename Color>
void colorFitted(const Cloud& cloud, const Color& color, int threads, Fitted& f) {
  const std::vector<std::uint8_t> bgr = bgrOf(cloud.points, color);
  const Error error = fitColors(f.store, cloud.view(), {bgr.data(), 3}, threads, f.surface);
  ASSERT_FALSE(error) << error.message;
  ASSERT_EQ(f.surface.colors.size(), f.surface.size() * kColorBytes);
}

/** Root mean square difference of the surface's colours from the truth at its projected points. */
template <typename Color>
double colorError(const Fitted& f, const Color& color) {
  std::vector<Vector3> places;
  for (const auto& p : f.projection.position) places.push_back(f.world(p));
  const auto made = surfaceColors(f.surface, places, f.projection.normal, 1);
  double sum = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto truth = color(places[i]);
    for (std::size_t c = 0; c < 3; ++c) sum += (made[i][c] - truth[c]) * (made[i][c] - truth[c]);
  }
  return std::sqrt(sum / (3.0 * static_cast<double>(places.size())));
}

TEST(FitColors, FollowASmoothColour) {
  const Cloud cloud = sceneCloud(Shape::kSphere, 10000, 0.001);
  Fitted f = fitted(cloud);
  colorFitted(cloud, waveColor, 1, f);
  // Bytes round by .3 twice; balls are wide beside the waves of a clean sphere.
  EXPECT_LT(colorError(f, waveColor), 3.0);
}

TEST(FitColors, AverageNoise) {
  const Cloud cloud = sceneCloud(Shape::kSphere, 10000, 0.001);
  Fitted f = fitted(cloud);
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 20.0);
  const auto grey = [](const Vector3&) { return std::array<double, 3>{100, 120, 140}; };
  const auto noisy = [&](const Vector3&) {
    return std::array<double, 3>{100 + noise(random), 120 + noise(random), 140 + noise(random)};
  };
  colorFitted(cloud, noisy, 1, f);
  EXPECT_LT(colorError(f, grey), 5.0) << "a quarter of the points' noise";
}

TEST(FitColors, KeepTwoSidesApart) {
  // A plate with a red and a blue side, thinner than the balls that fit each.
  Cloud cloud;
  for (int i = 0; i < 80; ++i) {
    for (int j = 0; j < 80; ++j) {
      for (const double side : {1.0, -1.0})
        cloud.add({i / 79.0, j / 79.0, side * 0.01}, {0, 0, side});
    }
  }
  Fitted f = fitted(cloud);
  const auto twoSides = [](const Vector3& p) {
    return p[2] > 0 ? std::array<double, 3>{200, 0, 0} : std::array<double, 3>{0, 0, 200};
  };
  colorFitted(cloud, twoSides, 1, f);
  EXPECT_LT(colorError(f, twoSides), 1.0);
}

TEST(FitColors, AreTheSameForAnyThreads) {
  const Cloud cloud = sceneCloud(Shape::kTorus, 5000, 0.002);
  Fitted f = fitted(cloud);
  colorFitted(cloud, waveColor, 1, f);
  const std::vector<std::uint8_t> once = f.surface.colors;
  colorFitted(cloud, waveColor, 4, f);
  EXPECT_EQ(f.surface.colors, once);
}

TEST(FitColors, NeedColoursAndTheSurfacesOwnPoints) {
  const Cloud cloud = sceneCloud(Shape::kSphere, 2000, 0.001);
  Fitted f = fitted(cloud);
  ASSERT_FALSE(fitColors(f.store, cloud.view(), {}, 1, f.surface));
  EXPECT_FALSE(f.surface.hasColors());
  EXPECT_TRUE(surfaceColors(f.surface, {{0, 0, 0}}, {{0, 0, 1}}).empty());
  f.surface.info.scale *= 2;
  const std::vector<std::uint8_t> bgr = bgrOf(cloud.points, waveColor);
  EXPECT_TRUE(fitColors(f.store, cloud.view(), {bgr.data(), 3}, 1, f.surface));
  EXPECT_FALSE(f.surface.hasColors());
}

TEST(FitColors, IndicesNameTheColours) {
  Cloud cloud = sceneCloud(Shape::kSphere, 4000, 0.001);
  std::vector<std::int32_t> even;
  for (std::int32_t i = 0; i < 4000; i += 2) even.push_back(i);
  CloudView view = cloud.view();
  view.indices = even.data();
  view.num_indices = even.size();
  auto store = PointStore::build(view, 1);
  ASSERT_TRUE(store);
  SLIMSurface surface;
  ASSERT_FALSE(fitSurface(*store, {}, surface));
  // Points that are not among the indices are black.
  std::vector<std::uint8_t> bgr(3 * 4000, 0);
  for (const std::int32_t i : even) bgr[3 * static_cast<std::size_t>(i) + 1] = 250;
  ASSERT_FALSE(fitColors(*store, view, {bgr.data(), 3}, 1, surface));
  for (std::size_t i = 0; i < surface.size(); ++i)
    ASSERT_EQ(surface.colors[i * kColorBytes + 1], 250) << i;
}

}  // namespace
}  // namespace pcl_slim

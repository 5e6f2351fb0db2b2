// SPDX-License-Identifier: BSD-3-Clause
// Surfaces painted with another cloud's colours: near the truth, of the right sheet, kept where
// that cloud ends, the same for any threads.
#include <gtest/gtest.h>

#include <cmath>

#include "pcl_slim/fit/fit_colors.h"
#include "pcl_slim/query/surface_probe.h"
#include "support/clouds.h"
#include "support/colors.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;
using measure::Shape;

/** A colour for each side of a plate. */
std::array<double, 3> redAboveBlue(const Vector3& p) {
  return p[2] > 0 ? std::array<double, 3>{200, 0, 0} : std::array<double, 3>{0, 0, 200};
}

template <typename Color>
Result<PaintStatistics> paint(const Cloud& cloud, const Color& color, SLIMSurface& surface,
                              int threads = 1) {
  const std::vector<std::uint8_t> bgr = bgrOf(cloud.points, color);
  return paintColors(cloud.view(), {bgr.data(), 3}, threads, surface);
}

/** Root mean square difference of the surface's colours from the truth at the fitted points for
 * which which(place) is true. */
template <typename Color, typename Which>
double paintError(const Fitted& f, const Color& color, const Which& which) {
  std::vector<Vector3> places;
  for (const auto& p : f.projection.position) places.push_back(f.world(p));
  const auto made = surfaceColors(f.surface, places, f.projection.normal, 1);
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!which(places[i])) continue;
    const auto truth = color(places[i]);
    for (std::size_t c = 0; c < 3; ++c) sum += (made[i][c] - truth[c]) * (made[i][c] - truth[c]);
    count += 3;
  }
  return std::sqrt(sum / count);
}

bool everywhere(const Vector3&) {
  return true;
}

/** Points of a plate of side 1, with a sheet on either side of z = 0 and noise across. */
Cloud plate(double half, int side, double noise) {
  Cloud cloud;
  std::mt19937_64 random(4);
  std::normal_distribution<double> gauss(0.0, noise);
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      for (const double z : {half, -half}) {
        const double x = i / (side - 1.0), y = j / (side - 1.0),
                     off = noise > 0 ? gauss(random) : 0;
        cloud.add({x, y, z + off}, {0, 0, z > 0 ? 1.0 : -1.0});
      }
    }
  }
  return cloud;
}

TEST(PaintColors, FollowAnotherCloudOfTheSameObject) {
  Fitted f = fitted(sceneCloud(Shape::kSphere, 10000, 0.001));
  Cloud photo = sceneCloud(Shape::kSphere, 27000, 0.003);
  for (double& value : photo.points) value += 0.002;  // registration leaves an error
  const auto painted = paint(photo.withoutNormals(), waveColor, f.surface);
  ASSERT_TRUE(painted) << painted.error().message;
  EXPECT_EQ(painted->leaves, f.surface.numLeaves());
  EXPECT_EQ(painted->painted, painted->leaves);
  EXPECT_GT(painted->points, 26900u);
  EXPECT_FALSE(painted->normals_opposed);
  // That of the scan's own colours (FitColors.FollowASmoothColour) and what the shift changes.
  EXPECT_LT(paintError(f, waveColor, everywhere), 3.5);
}

TEST(PaintColors, KeepTheSidesOfAThinPlateApartWithoutNormals) {
  Fitted f = fitted(plate(0.01, 80, 0));
  const Cloud photo = plate(0.01, 120, 0.002);
  const std::vector<std::uint8_t> bgr = bgrOf(plate(0.01, 120, 0).points, redAboveBlue);
  const auto painted = paintColors(photo.withoutNormals().view(), {bgr.data(), 3}, 1, f.surface);
  ASSERT_TRUE(painted) << painted.error().message;
  EXPECT_LT(paintError(f, redAboveBlue, everywhere), 1.0);
}

TEST(PaintColors, OwnNormalsDecideWhereNoiseIsThickerThanThePlate) {
  Fitted f = fitted(plate(0.01, 80, 0));
  const Cloud photo = plate(0.01, 120, 0.01);  // one point in six is beyond the plate's middle
  const std::vector<std::uint8_t> bgr = bgrOf(plate(0.01, 120, 0).points, redAboveBlue);
  ASSERT_TRUE(paintColors(photo.view(), {bgr.data(), 3}, 1, f.surface));
  EXPECT_LT(paintError(f, redAboveBlue, everywhere), 1.0);

  Cloud inside_out = photo;
  for (float& value : inside_out.normals) value = -value;
  const auto painted = paintColors(inside_out.view(), {bgr.data(), 3}, 1, f.surface);
  ASSERT_TRUE(painted) << painted.error().message;
  EXPECT_TRUE(painted->normals_opposed);
  const double error = paintError(f, redAboveBlue, everywhere);
  EXPECT_GT(error, 1.0) << "without normals some points paint the other side ...";
  EXPECT_LT(error, 100.0) << "... but most their own";
}

TEST(PaintColors, EndWhereTheCloudEnds) {
  const Cloud scan = sceneCloud(Shape::kTorus, 40000, 0);
  const auto green = [](const Vector3&) { return std::array<double, 3>{0, 200, 0}; };
  const auto red = [](const Vector3&) { return std::array<double, 3>{200, 0, 0}; };
  const auto grey = [](const Vector3&) { return std::array<double, 3>{128, 128, 128}; };
  Cloud half;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (scan.points[3 * i] > 0)
      half.add(scan.points[3 * i], scan.points[3 * i + 1], scan.points[3 * i + 2]);
  }
  Fitted f = fitted(scan);
  double widest = 0;
  for (const float r : f.surface.radius) widest = std::max(widest, f.store.scale() * r);
  const auto beyond = [&](const Vector3& p) { return p[0] < -widest; };
  const auto within = [&](const Vector3& p) { return p[0] > widest; };

  ASSERT_TRUE(paint(half, red, f.surface));
  EXPECT_LT(paintError(f, red, within), 1.0);
  EXPECT_LT(paintError(f, grey, beyond), 1.0) << "the surface had no colours";

  const std::vector<std::uint8_t> bgr = bgrOf(scan.points, green);
  ASSERT_FALSE(fitColors(f.store, scan.view(), {bgr.data(), 3}, 1, f.surface));
  const auto painted = paint(half, red, f.surface);
  ASSERT_TRUE(painted) << painted.error().message;
  EXPECT_LT(paintError(f, red, within), 1.0);
  EXPECT_LT(paintError(f, green, beyond), 1.0) << "the scan's own colours";
  EXPECT_NEAR(static_cast<double>(painted->painted) / static_cast<double>(painted->leaves), 0.5,
              0.15);
}

TEST(PaintColors, ReachLeavesSmallerThanTheSpacingOfTheCloud) {
  // A scan whose balls are smaller than the spacing of the few points with colours.
  Fitted f = fitted(sceneCloud(Shape::kTorus, 60000, 0.0005));
  const auto painted =
      paint(sceneCloud(Shape::kTorus, 500, 0).withoutNormals(), waveColor, f.surface);
  ASSERT_TRUE(painted) << painted.error().message;
  EXPECT_GT(static_cast<double>(painted->painted), 0.99 * static_cast<double>(painted->leaves));
  // waveColor changes by 200 a unit at most; the points are some .2 apart.
  EXPECT_LT(paintError(f, waveColor, everywhere), 20.0);
}

TEST(PaintColors, KeepTheTexturesOfTheScan) {
  const Cloud scan = sceneCloud(Shape::kSphere, 20000, 0);
  const auto stripes = [](const Vector3& p) {
    const double value = std::sin(30 * p[1]) > 0 ? 230 : 20;
    return std::array<double, 3>{value, value, value};
  };
  const auto red = [](const Vector3&) { return std::array<double, 3>{200, 0, 0}; };
  Fitted f = fitted(scan);
  const std::vector<std::uint8_t> bgr = bgrOf(scan.points, stripes);
  ASSERT_FALSE(fitColors(f.store, scan.view(), {bgr.data(), 3}, 1, f.surface));
  ASSERT_TRUE(f.surface.hasTextures());
  const SLIMSurface before = f.surface;
  Cloud half;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (scan.points[3 * i] > 0)
      half.add(scan.points[3 * i], scan.points[3 * i + 1], scan.points[3 * i + 2]);
  }
  ASSERT_TRUE(paint(half, red, f.surface));
  std::size_t kept = 0, gone = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const SurfelTexture was = before.texture(i), is = f.surface.texture(i);
    if (was.empty()) continue;
    const double x = f.surface.info.origin[0] + f.surface.info.scale * before.cx[i],
                 r = f.surface.info.scale * before.radius[i];
    if (x > r) {
      ++gone;
      EXPECT_TRUE(is.empty()) << i;
    } else if (x < -r) {
      ++kept;
      ASSERT_EQ(is.side, was.side) << i;
      EXPECT_TRUE(std::equal(was.rgb, was.rgb + SurfelTexture::numBytes(was.side), is.rgb)) << i;
    }
  }
  EXPECT_GT(kept, 10u);
  EXPECT_GT(gone, 10u);
}

TEST(PaintColors, AreTheSameForAnyThreads) {
  Fitted f = fitted(sceneCloud(Shape::kTorus, 5000, 0.002));
  const Cloud photo = sceneCloud(Shape::kTorus, 9000, 0.002);
  ASSERT_TRUE(paint(photo, waveColor, f.surface));
  const SLIMSurface once = f.surface;
  f.surface.colors.clear();
  f.surface.dropTextures();
  ASSERT_TRUE(paint(photo, waveColor, f.surface, 4));
  EXPECT_EQ(f.surface.colors, once.colors);
  EXPECT_EQ(f.surface.textures, once.textures);
}

TEST(PaintColors, RefuseCloudsThatDoNotFit) {
  Fitted f = fitted(sceneCloud(Shape::kSphere, 2000, 0.001));
  f.surface.colors.assign(f.surface.size() * kColorBytes, 7);
  const std::vector<std::uint8_t> before = f.surface.colors;
  Cloud far = sceneCloud(Shape::kSphere, 2000, 0.001);
  const auto message = [](const Result<PaintStatistics>& result) {
    EXPECT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kBadInput);
    return result.error().message;
  };
  EXPECT_NE(message(paintColors(far.view(), {}, 1, f.surface)).find("no colours"),
            std::string::npos);
  for (double& value : far.points) value += 10;
  EXPECT_NE(message(paint(far, waveColor, f.surface)).find("register both"), std::string::npos);
  for (double& value : far.points) value = std::nan("");
  message(paintColors(far.view(), {before.data(), 0}, 1, f.surface));
  message(paint(Cloud(), waveColor, f.surface));
  EXPECT_EQ(f.surface.colors, before);
  SLIMSurface none;
  EXPECT_NE(message(paint(sceneCloud(Shape::kSphere, 20, 0), waveColor, none)).find("no surface"),
            std::string::npos);
}

}  // namespace
}  // namespace pcl_slim

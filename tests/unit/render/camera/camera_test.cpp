// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/surface_renderer.h"
#include "unit/render/camera/sphere_objects.h"
#include "unit/render/sphere_view.h"
#include "unit/render/test_surfaces.h"

namespace pcl_slim {
namespace {

using namespace test;

/** \brief Bounds of the covered pixels: x0, y0, x1, y1. */
std::array<int, 4> coveredBounds(const GBuffer& buffer) {
  std::array<int, 4> bounds{buffer.width, buffer.height, -1, -1};
  for (int y = 0; y < buffer.height; ++y) {
    for (int x = 0; x < buffer.width; ++x) {
      if (!buffer.covered(buffer.index(x, y))) continue;
      bounds = {std::min(bounds[0], x), std::min(bounds[1], y), std::max(bounds[2], x),
                std::max(bounds[3], y)};
    }
  }
  return bounds;
}

TEST(MayBeSeen, HoldsForEveryBoxThatIsInThePicture) {
  const SLIMSurface surface = sphereSurface(4, 0.25, 600, 0.07);
  std::size_t hidden = 0;
  for (const bool parallel : {false, true}) {
    Camera camera = fitCamera(spheresOf(surface), viewFromAngles(UpAxis::kZ, 30, 20), {160, 120});
    if (parallel) {
      camera.projection = Camera::Projection::kOrthographic;
      camera.view_height = 0.2;
    } else {
      camera.fov = 5.0;
    }
    const GBuffer all = rendered(surface, camera);
    for (std::uint32_t i = 0; i < surface.size(); ++i) {
      const std::array<double, 3> c{surface.cx[i], surface.cy[i], surface.cz[i]};
      std::array<std::array<double, 3>, 2> box{c, c};
      for (std::size_t a = 0; a < 3; ++a) {
        box[0][a] -= double{surface.radius[i]};
        box[1][a] += double{surface.radius[i]};
      }
      const bool drawn = std::find(all.surfel.begin(), all.surfel.end(), i) != all.surfel.end();
      const bool seen = mayBeSeen(camera, box);
      EXPECT_TRUE(seen || !drawn) << i;
      hidden += !seen;
    }
  }
  EXPECT_GT(hidden, surface.size() / 2);
  Camera behind;
  behind.position = {0, 0, -9};
  behind.look_at = {0, 0, -10};
  EXPECT_FALSE(mayBeSeen(behind, {{{-1, -1, -1}, {1, 1, 1}}}));
  EXPECT_TRUE(mayBeSeen(behind, {{{-1, -1, -20}, {1, 1, 1}}}));
}

TEST(FitCamera, FramesTheWholeObjectTightlyAndCentred) {
  SLIMSurface surface = sphereSurface(4, 0.25, 600, 0.07, {0.1, -0.2, 0.05});
  surface.info.origin = {5000.0, 300.0, -20.0};
  surface.info.scale = 4.0;
  for (const double azimuth : {0.0, 77.0, 200.0}) {
    const Camera camera =
        fitCamera(spheresOf(surface), viewFromAngles(UpAxis::kZ, azimuth, 35.0), {160, 120});
    const auto b = coveredBounds(rendered(surface, camera));
    EXPECT_GT(b[1], 0);
    EXPECT_LT(b[3], 119);
    EXPECT_GT(b[3] - b[1], 95);        // 92 % of the height less the leaves' own reach
    EXPECT_NEAR(b[1] + b[3], 119, 3);  // centred
    EXPECT_NEAR(b[0] + b[2], 159, 3);
  }
}

TEST(FitCamera, OrthographicFramesAsWell) {
  const SLIMSurface surface = sphereSurface(4, 0.25, 600, 0.07, {0.1, -0.2, 0.05});
  const Camera camera =
      fitOrthographicCamera(spheresOf(surface), viewFromAngles(UpAxis::kY, 20.0, 10.0), {120, 160});
  const auto b = coveredBounds(rendered(surface, camera));
  EXPECT_GT(b[0], 0);
  EXPECT_LT(b[2], 119);
  EXPECT_GT(b[2] - b[0], 95);
  EXPECT_NEAR(b[0] + b[2], 119, 3);
  EXPECT_NEAR(b[1] + b[3], 159, 3);
}

TEST(FitCamera, OneStrayLeafDoesNotShrinkTheObject) {
  SLIMSurface surface = sphereSurface(4, 0.25, 600, 0.07);
  const ViewDirection view = viewFromAngles(UpAxis::kZ, 0.0, 0.0);
  const Camera before = fitCamera(spheresOf(surface), view, {160, 120});
  surface.cx[17] = 40.0f;
  const Camera after = fitCamera(spheresOf(surface), view, {160, 120});
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(before.position[k], after.position[k], 0.02);
}

// Of two spheres none is a stray, along whichever axes they are apart.
TEST(FitCamera, TwoSpheresAreBothFramed) {
  BoundingSpheres object;
  object.scale = 1e-38;
  object.spheres = {{{0.0f, 0.01f, 0.0f}, 0.2f, {0.0f, 0.0f, 1.0f}},
                    {{0.0f, 0.0f, 0.01f}, 0.2f, {0.0f, 0.0f, 1.0f}}};
  const Camera camera = fitCamera(object, viewFromAngles(UpAxis::kZ, 20.0, 30.0), {160, 120});
  EXPECT_LT(std::abs(camera.position[0]), 1e-36);
  EXPECT_FALSE(camera.validate());
}

TEST(FitCamera, APieceApartIsNotFramedButLargeOnesAre) {
  const SLIMSurface sphere = sphereSurface(4, 0.25, 600, 0.07);
  const ViewDirection view = viewFromAngles(UpAxis::kZ, 0.0, 0.0);
  const Camera before = fitCamera(spheresOf(sphere), view, {160, 120});
  // Four leaves aside, near enough to count by their distance.
  BoundingSpheres strays = spheresOf(sphere);
  for (std::size_t i = 0; i < 4; ++i) strays.spheres[i].center = {0.5f, 0.0f, 0.01f * i};
  const Camera with_strays = fitCamera(strays, view, {160, 120});
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(before.position[k], with_strays.position[k], 0.03);
  }
  BoundingSpheres two = spheresOf(sphere);
  for (const BoundingSphere& sphere_part : spheresOf(sphere).spheres) {
    two.spheres.push_back(sphere_part);
    two.spheres.back().center[0] += 1.0f;
  }
  EXPECT_NEAR(fitCamera(two, view, {160, 120}).position[0], 0.5, 0.03);
}

TEST(FitCamera, AMarginAtTheRightStaysFree) {
  const SLIMSurface surface = sphereSurface(4, 0.25, 600, 0.07, {0.1, -0.2, 0.05});
  const ViewDirection view = viewFromAngles(UpAxis::kZ, 30.0, 20.0);
  for (const bool parallel : {false, true}) {
    const Camera camera =
        parallel ? fitOrthographicCamera(spheresOf(surface), view, {120, 120}, 0.04, 0.3)
                 : fitCamera(spheresOf(surface), view, {120, 120}, 30.0, 0.04, 0.3);
    const auto b = coveredBounds(rendered(surface, camera));
    EXPECT_GT(b[0], 0) << parallel;
    EXPECT_LT(b[2], 84) << parallel;
    EXPECT_GT(b[2] - b[0], 60) << parallel;
  }
}

TEST(FitCamera, EmptySurfaceAndSinglePointGiveValidCameras) {
  SLIMSurface surface;
  EXPECT_FALSE(cameraFor(chooseView(spheresOf(surface)), spheresOf(surface), {80, 60}).validate());
  EXPECT_FALSE(
      fitOrthographicCamera(spheresOf(surface), chooseView(spheresOf(surface)).direction, {80, 60})
          .validate());
  surface = sphereSurface(2, 0.25, 1, 0.07);
  EXPECT_FALSE(cameraFor(chooseView(spheresOf(surface)), spheresOf(surface), {80, 60}).validate());
  EXPECT_FALSE(
      fitOrthographicCamera(spheresOf(surface), chooseView(spheresOf(surface)).direction, {80, 60})
          .validate());
}

TEST(FitCamera, SeesWhatLiesWhereAUnitIsLost) {
  SLIMSurface surface = stretched(0.25, 0.25, 0.4);
  surface.info.scale = 1e24;
  surface.info.origin = {3e25, -1e24, 2e24};
  const BoundingSpheres spheres = spheresOf(surface);
  const Camera camera = cameraFor(chooseView(spheres), spheres, {40, 30});
  EXPECT_FALSE(camera.validate()) << camera.validate().message;
}

TEST(FitCamera, FramesWhereThePointsAreNotTheFarEnd) {
  // A lidar: most points near by, few of large discs far away; and a spit off a coast.
  BoundingSpheres coast;
  addBox({0, 0, 0}, {1, 1, 0.05}, 0.02, coast);
  const ViewDirection above = viewFromAngles(UpAxis::kZ, 0.0, 42.0);
  const Camera land = fitCamera(coast, above, {160, 120});
  for (int k = 0; k < 60; ++k) {
    const float x = 1.0f + 0.08f * static_cast<float>(k);
    coast.spheres.push_back({{x, 0.5f, 0.0f}, 0.1f, {0.0f, 0.0f, 1.0f}});
  }
  const auto far = [](const Camera& c) { return length(subtract(c.position, {0.5, 0.5, 0.0})); };
  EXPECT_LT(far(fitCamera(coast, above, {160, 120})), 1.7 * far(land));
  // The same by the points behind few large spheres.
  BoundingSpheres scan = coast;
  for (BoundingSphere& sphere : scan.spheres) sphere.points = sphere.center[0] > 1 ? 1.0f : 40.0f;
  EXPECT_LT(far(fitCamera(scan, above, {160, 120})), 1.7 * far(land));
  // Where the far end has the points, it is what the picture shows.
  for (BoundingSphere& sphere : scan.spheres) sphere.points = sphere.center[0] > 1 ? 400.0f : 1.0f;
  EXPECT_GT(fitCamera(scan, above, {160, 120}).position[0], 2.0);
}

}  // namespace
}  // namespace pcl_slim

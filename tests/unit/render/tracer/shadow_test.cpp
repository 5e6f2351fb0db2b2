// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "pcl_slim/render/ray_tracer.h"
#include "traced_scenes.h"
#include "unit/render/sphere_view.h"

namespace pcl_slim {
namespace {

using namespace test;

/** A floor at z = 0 from -.5 to .5. */
SLIMSurface floorSurface() {
  SLIMSurface surface = emptySurface(2);
  addRectangle(surface, {-0.5, -0.5, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, 0.025,
               0.05);
  return surface;
}

/** A camera straight above that sees the floor from -.4 to .4. */
Camera cameraAbove(int size) {
  Camera camera;
  camera.projection = Camera::Projection::kOrthographic;
  camera.position = {0.0, 0.0, 2.0};
  camera.view_height = 0.8;
  camera.size = {size, size};
  return camera;
}

struct Frame {
  GBuffer buffer;
  LightBuffer light;
  TraceStatistics counts;

  Frame(const SLIMSurface& surface, const Camera& camera, const TraceParams& params) {
    RayTracer tracer(surface);
    const Error error = tracer.trace(camera, params, buffer, light, &counts);
    EXPECT_FALSE(error) << error.message;
  }
};

void addSphere(SLIMSurface& surface, const Point& center, double radius, int count, double ball) {
  const SLIMSurface sphere = sphereSurface(2, radius, count, ball, center);
  for (std::size_t i = 0; i < sphere.size(); ++i) {
    float* c = addLeaf(surface, {sphere.cx[i], sphere.cy[i], sphere.cz[i]},
                       {sphere.nx[i], sphere.ny[i], sphere.nz[i]}, ball);
    for (int k = 0; k < 6; ++k) c[k] = sphere.coefficientsOf(i)[k];
  }
}

// The shadow of a sphere is an ellipse: points of the floor whose line to the light passes within
// the radius. Rays within 5 % of the rim may go either way.
TEST(Shadows, OfASphereOnAFloorAreAnEllipse) {
  constexpr double kRadius = 0.1;
  const Point center{0.05, -0.05, 0.25}, light{0.6, 0.0, 0.8};
  SLIMSurface surface = floorSurface();
  addSphere(surface, center, kRadius, 600, 0.028);
  const Frame frame(surface, cameraAbove(80), litFrom(light));
  std::size_t shadowed = 0, lit = 0;
  for (std::size_t i = 0; i < frame.buffer.numPixels(); ++i) {
    ASSERT_TRUE(frame.buffer.covered(i));
    const auto& p = frame.buffer.position[i];
    if (p[2] > 0.01) continue;  // the sphere itself
    const Point to_center{center[0] - p[0], center[1] - p[1], center[2] - p[2]};
    const double t = to_center[0] * light[0] + to_center[1] * light[1] + to_center[2] * light[2];
    const double distance = std::sqrt(to_center[0] * to_center[0] + to_center[1] * to_center[1] +
                                      to_center[2] * to_center[2] - t * t);
    if (distance < 0.95 * kRadius) {
      EXPECT_EQ(frame.light.visible[i], 0.0f) << p[0] << " " << p[1];
      ++shadowed;
    } else if (distance > 1.05 * kRadius) {
      EXPECT_EQ(frame.light.visible[i], 1.0f) << p[0] << " " << p[1];
      ++lit;
    }
  }
  EXPECT_GT(shadowed, 150u);
  EXPECT_GT(lit, 3000u);
}

// Leaves of a convex shape do not stand in each other's light, down to rays that graze it by 2
// degrees.
TEST(Shadows, AConvexShapeCastsNoneOnItself) {
  for (const bool oriented : {true, false}) {
    SLIMSurface surface = sphereSurface(2, kSphere, 600, 0.05);
    surface.info.oriented = oriented;
    const double length = std::sqrt(0.49 + 0.25 + 0.09);
    const Frame frame(surface, frontCamera(120, 90), litFrom({0.7, 0.5, 0.3}));
    std::size_t lit = 0;
    for (std::size_t i = 0; i < frame.buffer.numPixels(); ++i) {
      if (!frame.buffer.covered(i)) continue;
      const auto& n = frame.buffer.normal[i];
      const double cosine = (0.7 * n[0] + 0.5 * n[1] + 0.3 * n[2]) / length;
      if (cosine < -0.001) {
        EXPECT_EQ(frame.light.visible[i], 0.0f);
      }
      if (cosine < 0.035) continue;
      EXPECT_EQ(frame.light.visible[i], 1.0f) << "oriented " << oriented << " cosine " << cosine;
      ++lit;
    }
    EXPECT_GT(lit, 1000u);
  }
}

// A sheet shades the surface behind it whichever way it faces, although a camera there would see
// through it.
TEST(Shadows, ASheetThatIsTurnedAwayBlocksLight) {
  for (const double side : {1.0, -1.0}) {
    SLIMSurface surface = floorSurface();
    addRectangle(surface, {-0.2, -0.2, 0.3}, {0.4, 0.0, 0.0}, {0.0, 0.4, 0.0}, {0.0, 0.0, side},
                 0.025, 0.05);
    const RayTracer tracer(surface);
    std::vector<WorldRay> rays(3);
    for (WorldRay& ray : rays) ray.origin = {0.05, 0.03, 0.01};
    rays[1].direction = {1.0, 0.0, 0.1};
    rays[2].farthest = 0.2;
    std::vector<std::uint8_t> blocked;
    ASSERT_FALSE(tracer.castShadows(rays, blocked));
    EXPECT_EQ(blocked, (std::vector<std::uint8_t>{1, 0, 0}));
  }
}

TEST(Shadows, OfAWideLightHaveSoftRims) {
  SLIMSurface surface = floorSurface();
  addRectangle(surface, {-0.5, -0.5, 0.2}, {0.5, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}, 0.025,
               0.05);
  // The edge at x = 0 stands .2 above the floor; seen from there the light is 10 degrees wide, so
  // that half of it is hidden below the edge and none .2 tan 10 = .035 aside. The sheet's leaves
  // reach on by what they cover, at most .03.
  Camera camera = cameraAbove(80);
  camera.position = {0.0, 0.0, 0.1};
  double sum = 0.0;
  std::size_t half_lit = 0;
  constexpr int kFrames = 16;
  std::vector<float> mean(80 * 80, 0.0f);
  for (unsigned sample = 0; sample < kFrames; ++sample) {
    TraceParams params = litFrom({0.0, 0.0, 1.0}, 10.0);
    params.sample = sample;
    const Frame frame(surface, camera, params);
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += frame.light.visible[i] / kFrames;
  }
  for (std::size_t i = 0; i < mean.size(); ++i) {
    const double x = (static_cast<double>(i % 80) - 39.5) * 0.01;
    sum += mean[i];
    half_lit += mean[i] > 0.2f && mean[i] < 0.8f;
    if (x < -0.04) {
      EXPECT_EQ(mean[i], 0.0f) << x;
    }
    if (x > 0.07) {
      EXPECT_EQ(mean[i], 1.0f) << x;
    }
  }
  EXPECT_NEAR(sum / 6400.0, 0.5, 0.05);
  EXPECT_GT(half_lit, 200u);
}

TEST(Occlusion, OfAPlaneIsNone) {
  TraceParams params;
  params.occlusion_rays = 16;
  const Frame frame(floorSurface(), cameraAbove(40), params);
  EXPECT_EQ(frame.counts.rays_occlusion, 40u * 40u * 16u);
  for (const float open : frame.light.open) EXPECT_EQ(open, 1.0f);
}

// Beside a long wall of height h a share (1 - d / sqrt(d^2 + h^2)) / 2 of the light from above is
// hidden at distance d.
TEST(Occlusion, BesideAWallIsTheAnalyticShare) {
  constexpr double kHeight = 0.3;
  SLIMSurface surface = floorSurface();
  addRectangle(surface, {-0.2, -3.0, 0.02}, {0.0, 6.0, 0.0}, {0.0, 0.0, kHeight - 0.03},
               {1.0, 0.0, 0.0}, 0.03, 0.06);
  TraceParams params;
  params.occlusion_rays = 256;
  params.occlusion_reach = 20.0;
  Camera camera = cameraAbove(16);
  camera.view_height = 0.2;
  const Frame frame(surface, camera, params);
  for (int x = 0; x < 16; ++x) {
    double mean = 0.0;
    for (int y = 0; y < 16; ++y) mean += frame.light.open[frame.buffer.index(x, y)] / 16.0;
    const double d = frame.buffer.position[frame.buffer.index(x, 0)][0] + 0.2;
    // 4096 rays a column: a standard deviation of .007; the wall's rims and ends add as much.
    EXPECT_NEAR(mean, 0.5 + 0.5 * d / std::hypot(d, kHeight), 0.03) << d;
  }
}

TEST(Occlusion, LooksNoFartherThanItsReach) {
  SLIMSurface surface = floorSurface();
  addRectangle(surface, {-0.5, -0.5, 0.2}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, -1.0},
               0.025, 0.05);
  Camera camera = cameraAbove(20);
  camera.position = {0.0, 0.0, 0.1};
  camera.view_height = 0.2;
  TraceParams params;
  params.occlusion_rays = 32;
  params.occlusion_reach = 0.15;
  for (const float open : Frame(surface, camera, params).light.open) EXPECT_EQ(open, 1.0f);
  params.occlusion_reach = 5.0;
  for (const float open : Frame(surface, camera, params).light.open) EXPECT_LT(open, 0.5f);
}

}  // namespace
}  // namespace pcl_slim

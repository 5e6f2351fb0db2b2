// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "pcl_slim/render/disc_rasterizer.h"
#include "pcl_slim/render/ray_tracer.h"
#include "unit/render/discs/test_discs.h"

namespace pcl_slim {
namespace {

using namespace test;

// The same discs are met by the same rays in double precision; only the order of sums differs.
void expectRasterised(const SplatSet& set, const Camera& camera, bool filtered,
                      VisibleSides sides) {
  GBuffer drawn, traced;
  LightBuffer light;
  DiscRenderParams render;
  render.filtered = filtered;
  render.sides = sides;
  TraceParams params;
  params.filtered = filtered;
  params.sides = sides;
  ASSERT_FALSE(renderDiscs(set, camera, render, drawn));
  RayTracer tracer(set);
  ASSERT_FALSE(tracer.trace(camera, params, traced, light));
  EXPECT_GT(drawn.numCovered(), 400u);
  EXPECT_EQ(drawn.surfel, traced.surfel);
  for (std::size_t i = 0; i < drawn.numPixels(); ++i) {
    if (!drawn.covered(i)) continue;
    EXPECT_NEAR(drawn.depth[i], traced.depth[i], 1e-6);
    EXPECT_NEAR(drawn.weight[i], traced.weight[i], 1e-5);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(drawn.color[i][k], traced.color[i][k], 1e-6);
      EXPECT_NEAR(drawn.normal[i][k], traced.normal[i][k], 1e-6);
    }
  }
}

TEST(TracedDiscs, ShowWhatTheRasteriserShows) {
  const SplatSet set = discSphere(0.4, 900, 0.035);
  for (const bool filtered : {true, false}) {
    expectRasterised(set, discCamera(160, 120), filtered, VisibleSides::kAuto);
    expectRasterised(set, discCamera(160, 120), filtered, VisibleSides::kFront);
  }
}

TEST(TracedDiscs, SmallerThanAPixelAreNotLost) {
  const SplatSet set = discSphere(0.4, 20000, 0.001);
  expectRasterised(set, discCamera(80, 60), true, VisibleSides::kAuto);
  Camera parallel = discCamera(80, 60);
  parallel.projection = Camera::Projection::kOrthographic;
  expectRasterised(set, parallel, true, VisibleSides::kAuto);
}

TEST(TracedDiscs, CastShadows) {
  SplatSet set;
  for (int i = -20; i <= 20; ++i) {
    for (int j = -20; j <= 20; ++j) {
      addDisc(set, {0.02 * i, 0.02 * j, 0.0}, {0.0, 0.0, 1.0}, 0.02, 0xffffff);
    }
  }
  addDisc(set, {0.1, 0.0, 0.3}, {0.0, 0.0, -1.0}, 0.1, 0xff0000);
  Camera camera;
  camera.projection = Camera::Projection::kOrthographic;
  camera.position = {0.0, 0.0, 0.2};
  camera.view_height = 0.6;
  camera.size = {60, 60};
  TraceParams params;
  params.lights.resize(1);
  GBuffer buffer;
  LightBuffer light;
  RayTracer tracer(set);
  ASSERT_FALSE(tracer.trace(camera, params, buffer, light));
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    ASSERT_TRUE(buffer.covered(i));
    const double distance = std::hypot(buffer.position[i][0] - 0.1, buffer.position[i][1]);
    if (std::abs(distance - 0.1) < 1e-4) continue;
    EXPECT_EQ(light.visible[i], distance < 0.1 ? 0.0f : 1.0f) << distance;
  }
}

TEST(TracedDiscs, RaysOfNoCameraMeetThemAsTheyAre) {
  SplatSet set;
  addDisc(set, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.1, 0x336699);
  const RayTracer tracer(set);
  std::vector<WorldRay> rays(2);
  rays[0].origin = {0.09, 0.0, 1.0};
  rays[1].origin = {0.11, 0.0, 1.0};
  for (WorldRay& ray : rays) ray.direction = {0.0, 0.0, -1.0};
  std::vector<WorldHit> hits;
  ASSERT_FALSE(tracer.cast(rays, VisibleSides::kAuto, hits));
  ASSERT_TRUE(hits[0].met());
  EXPECT_NEAR(hits[0].depth, 1.0, 1e-7);
  EXPECT_NEAR(hits[0].color[0], 0.2, 1e-6);
  EXPECT_FALSE(hits[1].met());
}

}  // namespace
}  // namespace pcl_slim

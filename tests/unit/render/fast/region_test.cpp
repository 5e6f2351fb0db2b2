// SPDX-License-Identifier: BSD-3-Clause
// Half spaces cut a picture: beside an exact sphere, both rasterisers and the ray tracer beside
// each other, and what is left out.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/disc_rasterizer.h"
#include "support/clouds.h"
#include "unit/render/same_buffers.h"
#include "unit/render/sphere_view.h"
#include "unit/render/tracer/traced_scenes.h"

namespace pcl_slim {
namespace {

using namespace test;

SLIMSurface bumps() {
  const auto cloud = pcl_slim_test::sceneCloud(measure::Shape::kBumpy, 12000, 0.0, 0.02);
  return pcl_slim_test::fitted(cloud, FitParams()).surface;
}

/** The six sides of a box about the origin. */
std::vector<HalfSpace> boxOf(double x, double y, double z) {
  const double half[3] = {x, y, z};
  std::vector<HalfSpace> sides;
  for (std::size_t a = 0; a < 3; ++a) {
    for (const double sign : {1.0, -1.0}) {
      HalfSpace side{{0.0, 0.0, 0.0}, -half[a]};
      side.normal[a] = sign;
      sides.push_back(side);
    }
  }
  return sides;
}

Camera obliqueView(const SLIMSurface& surface, bool perspective) {
  const BoundingSpheres object = spheresOf(surface);
  const ViewDirection direction = viewFromAngles(UpAxis::kZ, 25.0, 35.0);
  return perspective ? fitCamera(object, direction, {173, 131})
                     : fitOrthographicCamera(object, direction, {173, 131});
}

TEST(Region, ACutOpensASphereToItsInnerSide) {
  const SLIMSurface sphere = sphereSurface(4, kSphere, 600, 0.07);
  const Camera camera = frontCamera();
  RenderParams params;
  params.cuts = {{{0.0, 0.0, -2.0}, 0.0}};  // keeps z <= 0: the farther half
  for (const bool reference : {false, true}) {
    const GBuffer cut =
        reference ? referenceFrame(sphere, camera, params) : rendered(sphere, camera, params);
    std::size_t met = 0;
    for (int y = 0; y < cut.height; ++y) {
      for (int x = 0; x < cut.width; ++x) {
        const auto d = rayDirection(camera, x, y);
        const double b = camera.position[2] * d[2];
        const double off_sq = camera.position[2] * camera.position[2] - b * b;
        const double aside = std::hypot(d[0], d[1]) / -d[2] * camera.position[2];  // at z = 0
        const std::size_t i = cut.index(x, y);
        EXPECT_FALSE(aside > 1.1 * kSphere && cut.covered(i)) << x << ' ' << y;
        if (aside > 0.95 * kSphere) continue;
        ASSERT_TRUE(cut.covered(i)) << x << ' ' << y;
        ++met;
        EXPECT_NEAR(cut.depth[i], -b + std::sqrt(kSphere * kSphere - off_sq), 1e-3 * kSphere);
        EXPECT_TRUE(cut.back_face[i]);
      }
    }
    EXPECT_GT(met, 300u);
  }
}

TEST(Region, WhatARayHasLeftIsNotDrawn) {
  RenderParams params;
  params.cuts = {{{0.0, 0.0, 1.0}, 2.0 * kSphere}};  // in front of all of the sphere
  const SLIMSurface sphere = sphereSurface(4, kSphere, 600, 0.07);
  EXPECT_EQ(rendered(sphere, frontCamera(), params).numCovered(), 0u);
  EXPECT_EQ(referenceFrame(sphere, frontCamera(), params).numCovered(), 0u);
}

class RegionViews : public testing::TestWithParam<bool> {};

TEST_P(RegionViews, RasterisersAndTracerAgree) {
  const SLIMSurface surface = bumps();
  const Camera camera = obliqueView(surface, GetParam());
  RenderParams params;
  params.cuts = boxOf(0.9, 1.2, 0.6);
  params.cuts.push_back({{1.0, 2.0, 3.0}, -0.1});
  RenderStatistics statistics;
  const GBuffer fast = rendered(surface, camera, params, &statistics);
  const GBuffer exact = referenceFrame(surface, camera, params);
  GBuffer traced;
  LightBuffer light;
  TraceParams tracing;
  tracing.cuts = params.cuts;
  tracing.close_gaps = false;
  ASSERT_FALSE(RayTracer(surface).trace(camera, tracing, traced, light));

  EXPECT_GT(statistics.outside_region, surface.numLeaves() / 4);
  EXPECT_GT(fast.numCovered(), 500u);
  const GBuffer whole = rendered(surface, camera);
  EXPECT_LT(fast.numCovered(), whole.numCovered());
  std::size_t differ = 0, outside = 0;
  for (std::size_t i = 0; i < fast.numPixels(); ++i) {
    for (const GBuffer* other : {&exact, &std::as_const(traced)}) {
      const bool both = fast.covered(i) && other->covered(i);
      differ += fast.covered(i) != other->covered(i) ||
                (both && std::abs(fast.depth[i] - other->depth[i]) > 1e-3f);
    }
    if (!fast.covered(i)) continue;
    for (const HalfSpace& cut : params.cuts) {
      double inside = -cut.offset;
      for (std::size_t a = 0; a < 3; ++a) {
        inside += cut.normal[a] *
                  (surface.info.origin[a] + surface.info.scale * double{fast.position[i][a]});
      }
      outside += inside < -3e-3;  // blends move points along their rays
    }
  }
  EXPECT_LT(differ, fast.numCovered() / 200);  // beside cuts and silhouettes
  EXPECT_EQ(outside, 0u);
}

TEST_P(RegionViews, ThreadsSkippingAndLevelsOfDetailKeepTheirPromises) {
  const SLIMSurface surface = bumps();
  const Camera camera = obliqueView(surface, GetParam());
  RenderParams params;
  params.cuts = {{{1.0, 0.2, 0.0}, 0.0}};
  params.threads = 1;
  const GBuffer first = rendered(surface, camera, params);
  params.threads = 3;
  params.skip = false;
  expectSame(first, rendered(surface, camera, params));
  params.lod = 1e-3;  // finer than any leaf is seen
  expectSame(first, rendered(surface, camera, params));
}

INSTANTIATE_TEST_SUITE_P(Projections, RegionViews, testing::Bool(),
                         [](const auto& view) { return view.param ? "Perspective" : "Parallel"; });

TEST(Region, SplatsAreKeptByTheirCentres) {
  SplatSet splats;
  splats.resize(3, false);
  splats.origin = {100.0, 0.0, 0.0};
  splats.x = {-1.0f, 0.0f, 1.0f};
  splats.radius = {1.0f, 2.0f, 3.0f};
  splats.confidence = {4.0f, 5.0f, 6.0f};
  splats.kept = {7, 8, 9};
  const SplatSet part = splatsWithin(splats, {{{2.0, 0.0, 0.0}, 200.0}});
  ASSERT_EQ(part.size(), 2u);
  EXPECT_EQ(part.radius, (std::vector<float>{2.0f, 3.0f}));
  EXPECT_EQ(part.confidence, (std::vector<float>{5.0f, 6.0f}));
  EXPECT_EQ(part.kept, (std::vector<std::uint32_t>{8, 9}));
}

TEST(Region, ASpaceWithoutADirectionIsRefused) {
  RenderParams params;
  params.cuts = {{{0.0, 0.0, 0.0}, 0.0}};
  EXPECT_TRUE(params.validate());
  TraceParams tracing;
  tracing.cuts = {{{0.0, 1.0, 0.0}, HUGE_VAL}};
  EXPECT_TRUE(tracing.validate());
}

}  // namespace
}  // namespace pcl_slim

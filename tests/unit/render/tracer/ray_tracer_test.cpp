// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/ray_tracer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/trim_maps.h"
#include "traced_scenes.h"
#include "unit/render/same_buffers.h"
#include "unit/render/sphere_view.h"

namespace pcl_slim {
namespace {

using namespace test;

GBuffer traced(const SLIMSurface& surface, const Camera& camera, TraceParams params = {},
               TraceStatistics* statistics = nullptr) {
  GBuffer buffer;
  LightBuffer light;
  RayTracer tracer(surface);
  const Error error = tracer.trace(camera, params, buffer, light, statistics);
  EXPECT_FALSE(error) << error.message;
  return buffer;
}

/** What two frames differ by, where both met the surface. */
struct FrameDifference {
  std::size_t coverage = 0, both = 0;
  bool finite = true;  ///< all of a
  double depth = 0.0, normal = 0.0, mean = 0.0;

  FrameDifference(const GBuffer& a, const GBuffer& b) {
    for (std::size_t i = 0; i < a.numPixels(); ++i) {
      coverage += a.covered(i) != b.covered(i);
      if (!a.covered(i) || !b.covered(i)) continue;
      ++both;
      finite = finite && std::isfinite(a.normal[i][0]) && std::isfinite(a.mean_curvature[i]);
      depth = std::max(depth, double{std::abs(a.depth[i] - b.depth[i])});
      mean = std::max(mean, double{std::abs(a.mean_curvature[i] - b.mean_curvature[i])});
      for (std::size_t k = 0; k < 3; ++k) {
        normal = std::max(normal, double{std::abs(a.normal[i][k] - b.normal[i][k])});
      }
    }
  }
};

// The tracer works in single precision within blocks of leaves, the reference in double. q^ moves
// by rounding, 1e-7, and everything that is blended moves with it.
void expectReference(const SLIMSurface& surface, const Camera& camera, VisibleSides sides) {
  RenderParams render;
  render.sides = sides;
  TraceParams trace;
  trace.sides = sides;
  const FrameDifference d(traced(surface, camera, trace), referenceFrame(surface, camera, render));
  EXPECT_GT(d.both, 500u);
  EXPECT_EQ(d.coverage, 0u);
  EXPECT_TRUE(d.finite);
  EXPECT_LT(d.depth, 1e-5);
  EXPECT_LT(d.normal, 1e-3);
  EXPECT_LT(d.mean, 0.05);
}

class TracedSphere : public testing::TestWithParam<int> {};

TEST_P(TracedSphere, MeetsWhatTheReferenceMeets) {
  const SLIMSurface surface = sphereSurface(GetParam(), kSphere, 600, 0.07);
  expectReference(surface, frontCamera(), VisibleSides::kAuto);
  expectReference(surface, frontCamera(), VisibleSides::kBoth);
}

TEST_P(TracedSphere, OfAParallelCameraToo) {
  const SLIMSurface surface = sphereSurface(GetParam(), kSphere, 600, 0.07);
  Camera camera = frontCamera();
  camera.projection = Camera::Projection::kOrthographic;
  camera.view_height = 0.6;
  expectReference(surface, camera, VisibleSides::kAuto);
}

TEST_P(TracedSphere, EndsWhereTrimMapsDo) {
  SLIMSurface surface = sphereSurface(GetParam(), kSphere, 600, 0.07);
  const std::size_t whole = rendered(surface, frontCamera()).numCovered();
  pcl_slim_test::setRandomTrimMaps(surface);
  const GBuffer reference = referenceFrame(surface, frontCamera());
  TraceParams trace;
  trace.close_gaps = false;  // the reference closes none
  const FrameDifference d(traced(surface, frontCamera(), trace), reference);
  EXPECT_LT(reference.numCovered(), whole);
  EXPECT_GT(d.both, whole / 3);
  EXPECT_LE(d.coverage, d.both / 200) << "rays that rounding decides";
}

INSTANTIATE_TEST_SUITE_P(Degrees, TracedSphere, testing::Values(1, 2, 3, 4));

TEST(RayTracer, AFrameMeetsTheAnalyticSphereWithoutAGap) {
  SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07, {0.125, -0.25, 0.0625});
  surface.info.scale = 8.0;
  surface.info.origin = {-1.0, 2.0, -0.5};  // the sphere's centre becomes the world's origin
  Camera camera = frontCamera(97, 61);
  camera.position = {7.0, -4.0, 5.0};
  camera.up = {0.3, 1.0, 2.0};
  camera.fov = 34.0;
  TraceStatistics counts;
  const GBuffer buffer = traced(surface, camera, {}, &counts);
  const Deviation d = compareWithSphere(buffer, camera, 8.0 * kSphere, 8.0);
  EXPECT_GT(d.covered, 500u);
  EXPECT_EQ(d.missed + d.extra, 0u);
  EXPECT_LT(d.depth, 8.0 * 3e-5);
  EXPECT_LT(d.normal, 1e-3);
  EXPECT_EQ(counts.rays_primary, 97u * 61u);
  EXPECT_EQ(counts.rays_shadow + counts.rays_occlusion, 0u);
  EXPECT_EQ(counts.covered_pixels, buffer.numCovered());
  EXPECT_EQ(counts.leaves, 600u);
  EXPECT_GT(counts.testedPerRay(), 1.0);
}

// Rays from all around, some through the middle and some that graze the sphere: 1 % inside its rim
// they meet it, 4 % outside they do not, as balls reach over the rim by (r / R)^2 / 2 = 4 %.
TEST(RayTracer, RaysMeetTheAnalyticSphereFromAnywhere) {
  const SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07);
  const RayTracer tracer(surface);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<WorldRay> rays;
  std::vector<double> offset;
  for (int i = 0; i < 2000; ++i) {
    const Point d = randomDirection(random);
    const LocalFrame frame(d);
    const bool grazes = i % 2 == 0;
    offset.push_back(grazes ? 0.96 + 0.10 * share(random) : share(random));
    WorldRay ray;
    for (std::size_t k = 0; k < 3; ++k) {
      ray.origin[k] = kSphere * offset.back() * frame.u[k] - 2.0 * d[k];
      ray.direction[k] = 3.0 * d[k];
    }
    rays.push_back(ray);
  }
  const std::vector<WorldHit> hits = cast(tracer, rays);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (offset[i] > 1.04) {
      EXPECT_FALSE(hits[i].met()) << offset[i];
    }
    if (offset[i] > 0.99) continue;
    ASSERT_TRUE(hits[i].met()) << offset[i];
    const double t = 2.0 - kSphere * std::sqrt(1.0 - offset[i] * offset[i]);
    const double along = kSphere * 3e-4 / std::sqrt(1.0 - offset[i] * offset[i]);
    EXPECT_NEAR(hits[i].depth, t, along);
    const Point& p = hits[i].position;
    EXPECT_NEAR(std::hypot(p[0], p[1], p[2]), kSphere, 3e-5);
  }
}

TEST(RayTracer, RaysFromInsideMeetTheInnerSideIfBothAreShown) {
  const SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07);
  const RayTracer tracer(surface);
  std::mt19937 random(5);
  std::vector<WorldRay> rays(200);
  for (WorldRay& ray : rays) ray.direction = randomDirection(random);
  for (const WorldHit& hit : cast(tracer, rays)) EXPECT_FALSE(hit.met());
  for (const WorldHit& hit : cast(tracer, rays, VisibleSides::kBoth)) {
    ASSERT_TRUE(hit.met());
    EXPECT_NEAR(hit.depth, kSphere, 1e-5);
  }
}

TEST(RayTracer, ACameraInsideSeesTheInnerSideEverywhere) {
  const SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07);
  Camera camera = frontCamera(64, 48);
  camera.position = {0.03, -0.02, 0.05};
  camera.look_at = {1.0, 0.2, 0.1};
  camera.fov = 100.0;
  TraceParams params;
  params.sides = VisibleSides::kBoth;
  const GBuffer buffer = traced(surface, camera, params);
  EXPECT_EQ(buffer.numCovered(), buffer.numPixels());
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    const auto& p = buffer.position[i];
    EXPECT_NEAR(std::hypot(p[0], p[1], p[2]), kSphere, 1e-4);
    EXPECT_TRUE(buffer.back_face[i]);
  }
}

TEST(RayTracer, BothSidesAreSeenWhereSidesAreInDoubt) {
  SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07);
  surface.info.sides_in_doubt = true;
  Camera camera = frontCamera(48, 36);
  camera.position = {0.02, 0.01, -0.03};
  camera.look_at = {1.0, 0.2, 0.1};
  const GBuffer buffer = traced(surface, camera, {});
  EXPECT_EQ(buffer.numCovered(), buffer.numPixels());
  EXPECT_EQ(std::count(buffer.back_face.begin(), buffer.back_face.end(), 1), 0);
}

TEST(RayTracer, RaysBeginAndEndWhereTheyAreTold) {
  const SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07);
  const RayTracer tracer(surface);
  WorldRay ray;
  ray.origin = {0.0, 0.0, 1.0};
  ray.direction = {0.0, 0.0, -1.0};
  ray.farthest = 0.74;
  EXPECT_FALSE(cast(tracer, {ray})[0].met());
  ray.farthest = 0.76;
  EXPECT_NEAR(cast(tracer, {ray})[0].depth, 0.75, 1e-5);
  ray.farthest = 2.0;
  ray.nearest = 0.8;
  EXPECT_FALSE(cast(tracer, {ray})[0].met());
  EXPECT_NEAR(cast(tracer, {ray}, VisibleSides::kBoth)[0].depth, 1.25, 1e-5);
}

// Quadratic Taylor polynomials of radius .08 on a tube of radius .12 err by r^3 / R^2 / 6 at a
// ball's rim, 6e-3 of the tube, and by much less where leaves blend.
TEST(RayTracer, RaysMeetTheAnalyticTorus) {
  constexpr double kMajor = 0.33, kMinor = 0.12;
  const SLIMSurface surface = torusSurface(kMajor, kMinor, 72, 30, 0.08);
  const RayTracer tracer(surface);
  std::mt19937 random(9);
  std::vector<WorldRay> rays;
  for (int i = 0; i < 3000; ++i) {
    const Point from = randomDirection(random), to = randomDirection(random);
    WorldRay ray;
    for (std::size_t k = 0; k < 3; ++k) {
      ray.origin[k] = 2.0 * from[k];
      ray.direction[k] = 0.45 * to[k] - ray.origin[k];
    }
    rays.push_back(ray);
  }
  const std::vector<WorldHit> hits = cast(tracer, rays);
  std::size_t met = 0;
  for (const WorldHit& hit : hits) {
    if (!hit.met()) continue;
    ++met;
    const double rho = std::hypot(hit.position[0], hit.position[1]) - kMajor;
    EXPECT_NEAR(std::hypot(rho, hit.position[2]), kMinor, 6e-3 * kMinor);
  }
  EXPECT_GT(met, 600u);
}

TEST(RayTracer, SameBytesForAnyNumberOfThreads) {
  const SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07);
  const Camera camera = frontCamera(100, 90);
  TraceParams params = litFrom({1.0, 2.0, 0.5}, 5.0);
  params.occlusion_rays = 4;
  GBuffer buffers[2];
  LightBuffer lights[2];
  TraceStatistics counts[2];
  for (int i = 0; i < 2; ++i) {
    params.threads = i == 0 ? 1 : 3;
    RayTracer tracer(surface, params.threads);
    ASSERT_FALSE(tracer.trace(camera, params, buffers[i], lights[i], &counts[i]));
  }
  expectSame(buffers[0], buffers[1]);
  EXPECT_EQ(lights[0].visible, lights[1].visible);
  EXPECT_EQ(lights[0].open, lights[1].open);
  EXPECT_EQ(counts[0].tested_first, counts[1].tested_first);
  EXPECT_EQ(counts[0].nodes, counts[1].nodes);
}

TEST(RayTracer, CancelStopsAFrameAndLeavesNothing) {
  const SLIMSurface surface = sphereSurface(2, kSphere, 600, 0.07);
  RayTracer tracer(surface);
  int reports = 0;
  Progress progress([&](float done, const char*) {
    ++reports;
    if (done > 0.0f) progress.cancel();
  });
  GBuffer buffer;
  LightBuffer light;
  const Error error = tracer.trace(frontCamera(800, 600), {}, buffer, light, nullptr, &progress);
  EXPECT_EQ(error.code, ErrorCode::kCancelled);
  EXPECT_EQ(reports, 2);
  EXPECT_EQ(buffer.numPixels(), 0u);
  EXPECT_TRUE(light.open.empty());
  progress.reset();
  EXPECT_FALSE(tracer.trace(frontCamera(64, 48), {}, buffer, light, nullptr, &progress));
}

TEST(RayTracer, OneThatWasMovedFromSaysSo) {
  const SLIMSurface surface = sphereSurface(2, kSphere, 100, 0.15);
  RayTracer tracer(surface);
  RayTracer taken(std::move(tracer));
  GBuffer buffer;
  LightBuffer light;
  const Error error = tracer.trace(frontCamera(16, 12), {}, buffer, light);  // NOLINT: on purpose
  EXPECT_NE(error.message.find("moved"), std::string::npos) << error.message;
  std::vector<WorldHit> hits;
  EXPECT_TRUE(tracer.cast({WorldRay()}, VisibleSides::kAuto, hits));
  std::vector<std::uint8_t> blocked;
  EXPECT_TRUE(tracer.castShadows({WorldRay()}, blocked));
  EXPECT_FALSE(tracer.hasColors());
  EXPECT_EQ(tracer.scale(), 1.0);
  EXPECT_FALSE(taken.trace(frontCamera(16, 12), {}, buffer, light));
}

TEST(RayTracer, NamesWhatIsWrong) {
  const SLIMSurface surface = sphereSurface(2, kSphere, 100, 0.15);
  RayTracer tracer(surface);
  std::vector<WorldHit> hits;
  WorldRay ray;
  ray.direction = {0.0, 0.0, 0.0};
  EXPECT_EQ(tracer.cast({ray}, VisibleSides::kAuto, hits).code, ErrorCode::kBadArgument);
  ray.direction = {0.0, 0.0, NAN};
  std::vector<std::uint8_t> blocked;
  EXPECT_EQ(tracer.castShadows({ray}, blocked).code, ErrorCode::kBadArgument);
  TraceParams params;
  GBuffer buffer;
  LightBuffer light;
  params = litFrom({0.0, 0.0, 0.0});
  EXPECT_EQ(tracer.trace(frontCamera(), params, buffer, light).code, ErrorCode::kBadArgument);
  params = {};
  params.occlusion_rays = -1;
  EXPECT_EQ(tracer.trace(frontCamera(), params, buffer, light).code, ErrorCode::kBadArgument);
  SLIMSurface broken = surface;
  broken.cx[3] = NAN;
  EXPECT_EQ(RayTracer(broken).trace(frontCamera(), {}, buffer, light).code, ErrorCode::kBadInput);
}

TEST(RayTracer, AnEmptySurfaceIsSeenThrough) {
  const SLIMSurface surface = emptySurface(2);
  TraceParams params;
  params.lights.resize(1);
  EXPECT_EQ(traced(surface, frontCamera(), params).numCovered(), 0u);
}

}  // namespace
}  // namespace pcl_slim

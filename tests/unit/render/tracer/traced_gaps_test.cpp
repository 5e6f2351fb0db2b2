// SPDX-License-Identifier: BSD-3-Clause
// Gaps between shrunk balls are closed; holes, slits and rims stay open.
#include <gtest/gtest.h>

#include <cmath>

#include "pcl_slim/render/ray_tracer.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/surface/polynomial.h"
#include "support/lab/reference/reference_renderer.h"
#include "traced_scenes.h"
#include "unit/render/sphere_view.h"

namespace pcl_slim {
namespace {

using namespace test;

/** Pixels of a frame whose ray met nothing. */
std::size_t openPixels(const SLIMSurface& surface, const Camera& camera, bool close_gaps,
                       TraceStatistics* counts = nullptr) {
  TraceParams params;
  params.close_gaps = close_gaps;
  GBuffer buffer;
  LightBuffer light;
  RayTracer tracer(surface);
  const Error error = tracer.trace(camera, params, buffer, light, counts);
  EXPECT_FALSE(error) << error.message;
  return buffer.numPixels() - buffer.numCovered();
}

/** A sheet of leaves of radius .05, .024 apart, without the four around its middle, so that the
 * nearest are .76 radii off: beyond the cover radius of 2/3, but all around. */
SLIMSurface sheetWithGap() {
  SLIMSurface dense = emptySurface(2), surface = emptySurface(2);
  addRectangle(dense, {-0.348, -0.348, 0.0}, {0.696, 0.0, 0.0}, {0.0, 0.696, 0.0}, {0.0, 0.0, 1.0},
               0.024, 0.05);
  for (std::size_t i = 0; i < dense.size(); ++i) {
    if (std::hypot(dense.cx[i], dense.cy[i]) < 0.03) continue;
    addLeaf(surface, {dense.cx[i], dense.cy[i], 0.0}, {0.0, 0.0, 1.0}, 0.05);
  }
  return surface;
}

TEST(TracedGaps, GapsBetweenShrunkBallsAreClosed) {
  const SLIMSurface surface = sheetWithGap();
  Camera camera = frontCamera(100, 100);
  camera.fov = 10.0;
  TraceStatistics counts;
  const std::size_t open = openPixels(surface, camera, false, &counts);
  EXPECT_GT(open, 10u);
  EXPECT_EQ(counts.closed, 0u);
  EXPECT_EQ(openPixels(surface, camera, true, &counts), 0u);
  EXPECT_EQ(counts.closed, open);
}

TEST(TracedGaps, RasterisersCloseThemWhereAsked) {
  const SLIMSurface surface = sheetWithGap();
  Camera camera = frontCamera(100, 100);
  camera.fov = 10.0;
  const std::size_t open = openPixels(surface, camera, false);
  for (const auto draw : {renderSurface, lab::renderReference}) {
    RenderParams params;
    GBuffer buffer;
    RenderStatistics counts;
    ASSERT_FALSE(draw(surface, camera, params, buffer, &counts));
    EXPECT_EQ(buffer.numPixels() - buffer.numCovered(), open);
    EXPECT_EQ(counts.closed_pixels, 0u);
    params.close_gaps = true;
    ASSERT_FALSE(draw(surface, camera, params, buffer, &counts));
    EXPECT_EQ(buffer.numCovered(), buffer.numPixels());
    EXPECT_EQ(counts.closed_pixels, open);
    EXPECT_EQ(counts.covered_pixels, buffer.numPixels());
    for (std::size_t i = 0; i < buffer.numPixels(); ++i) EXPECT_GT(buffer.normal[i][2], 0.999f);
  }
}

TEST(TracedGaps, AreClosedInFramesThatSomethingElseDrew) {
  const SLIMSurface surface = sheetWithGap();
  Camera camera = frontCamera(100, 100);
  camera.fov = 10.0;
  SurfaceRenderer renderer(surface);
  RenderParams params;
  GBuffer open, closed;
  ASSERT_FALSE(renderer.render(camera, params, open));
  params.close_gaps = true;
  ASSERT_FALSE(renderer.render(camera, params, closed));
  GBuffer gaps = open;
  ASSERT_FALSE(renderer.closeGaps(camera, params, gaps));
  EXPECT_GT(gaps.numCovered(), 10u);
  for (std::size_t i = 0; i < open.numPixels(); ++i) {
    ASSERT_NE(gaps.covered(i), open.covered(i));
    if (!gaps.covered(i)) continue;
    EXPECT_EQ(gaps.depth[i], closed.depth[i]);
    EXPECT_EQ(gaps.normal[i], closed.normal[i]);
    EXPECT_EQ(gaps.residual[i], closed.residual[i]);
  }
  params.lod = 2.0;
  gaps = open;
  ASSERT_FALSE(renderer.closeGaps(camera, params, gaps));
  EXPECT_EQ(gaps.numCovered(), 0u);
  camera.size.width = 90;
  gaps = open;
  EXPECT_EQ(renderer.closeGaps(camera, params, gaps).code, ErrorCode::kBadInput);
  EXPECT_EQ(gaps.numPixels(), 0u);
}

/** Cuts a hole about the origin into a flat sheet, by a map for every leaf. */
void cutHole(SLIMSurface& surface, double hole_radius) {
  constexpr int kSide = 16;
  std::vector<std::uint8_t> bits;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const LocalFrame frame({surface.nx[i], surface.ny[i], surface.nz[i]});
    std::vector<std::uint8_t> map(TrimMap::numBytes(kSide));
    for (std::size_t k = 0; k < kSide * kSide; ++k) {
      const double u =
          surface.radius[i] * (2.0 * static_cast<double>(k % kSide) / (kSide - 1) - 1.0);
      const double v =
          surface.radius[i] * (2.0 * static_cast<double>(k / kSide) / (kSide - 1) - 1.0);
      const double x = surface.cx[i] + u * frame.u[0] + v * frame.v[0];
      const double y = surface.cy[i] + u * frame.u[1] + v * frame.v[1];
      if (std::hypot(x, y) > hole_radius) map[k >> 3] |= static_cast<std::uint8_t>(1 << (k & 7));
    }
    bits.insert(bits.end(), map.begin(), map.end());
  }
  surface.setTrimMaps(std::vector<std::uint8_t>(surface.size(), kSide), bits);
}

TEST(TracedGaps, HolesOfTrimMapsStayOpen) {
  SLIMSurface surface = emptySurface(2);
  addRectangle(surface, {-0.348, -0.348, 0.0}, {0.696, 0.0, 0.0}, {0.0, 0.696, 0.0},
               {0.0, 0.0, 1.0}, 0.024, 0.05);
  Camera camera = frontCamera(100, 100);
  camera.fov = 10.0;
  EXPECT_EQ(openPixels(surface, camera, true), 0u);
  cutHole(surface, 0.05);
  EXPECT_GT(openPixels(surface, camera, true), 300u);
  EXPECT_EQ(openPixels(surface, camera, true), openPixels(surface, camera, false));
}

TEST(TracedGaps, LightDoesNotLeakThroughGaps) {
  const SLIMSurface surface = sheetWithGap();
  const RayTracer tracer(surface);
  std::vector<WorldRay> rays;
  for (int i = 0; i < 400; ++i) {
    rays.emplace_back();
    rays.back().origin = {-0.1 + 0.01 * (i % 20) - 0.1, -0.1 + 0.01 * (i / 20) + 0.2, -1.0};
    rays.back().direction = {0.1, -0.2, 1.0};
  }
  std::vector<std::uint8_t> blocked;
  ASSERT_FALSE(tracer.castShadows(rays, blocked));
  for (const std::uint8_t one : blocked) EXPECT_EQ(one, 1);
}

// Between two balls a hundredth of a radius apart leaves of both are around the ray, but they face
// each other; and the rim of a sheet has leaves to one side only.
TEST(TracedGaps, SlitsAndRimsStayOpen) {
  SLIMSurface surface = sphereSurface(4, 0.1, 600, 0.02, {0.101, 0.0, 0.0});
  const SLIMSurface other = sphereSurface(4, 0.1, 600, 0.02, {-0.101, 0.0, 0.0});
  for (std::size_t i = 0; i < other.size(); ++i) {
    float* c = addLeaf(surface, {other.cx[i], other.cy[i], other.cz[i]},
                       {other.nx[i], other.ny[i], other.nz[i]}, other.radius[i]);
    for (int k = 0; k < other.stride(); ++k) c[k] = other.coefficientsOf(i)[k];
  }
  Camera camera = frontCamera(400, 80);
  camera.fov = 4.0;
  EXPECT_EQ(openPixels(surface, camera, true), openPixels(surface, camera, false));
  EXPECT_GT(openPixels(surface, camera, true), 100u);
  SLIMSurface sheet = emptySurface(2);
  addRectangle(sheet, {-0.2, -0.2, 0.0}, {0.4, 0.0, 0.0}, {0.0, 0.4, 0.0}, {0.0, 0.0, 1.0}, 0.025,
               0.05);
  EXPECT_EQ(openPixels(sheet, frontCamera(), true), openPixels(sheet, frontCamera(), false));
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Pictures of a coloured surface: every way of drawing gives the surface's own colours.
#include <gtest/gtest.h>

#include "pcl_slim/render/ray_tracer.h"
#include "pcl_slim/render/shading.h"
#include "pcl_slim/render/traced_picture.h"
#include "pcl_slim/surface/surfel_color.h"
#include "support/lab/reference/reference_renderer.h"
#include "unit/render/same_buffers.h"
#include "unit/render/sphere_view.h"
#include "unit/render/test_surfaces.h"

namespace pcl_slim::test {
namespace {

/** Red grows with x, green with y, blue with z: linear, so that leaves agree wherever they overlap.
 */
float channelAt(const std::array<float, 3>& p, std::size_t c) {
  return 128.0f + 400.0f * p[c];
}

SLIMSurface coloredSphere() {
  SLIMSurface s = sphereSurface(4, kSphere, 400, 0.08);
  s.colors.resize(s.size() * kColorBytes);
  for (std::size_t i = 0; i < s.size(); ++i) {
    const LocalFrame frame({s.nx[i], s.ny[i], s.nz[i]});
    const std::array<float, 3> center{s.cx[i], s.cy[i], s.cz[i]};
    ColorPolynomial color{};
    for (std::size_t c = 0; c < 3; ++c) {
      color[0][c] = channelAt(center, c);
      color[1][c] = static_cast<float>(400.0 * s.radius[i] * frame.u[c]);
      color[2][c] = static_cast<float>(400.0 * s.radius[i] * frame.v[c]);
      // Across the leaf the sphere falls away by u^2 r^2 / 2R.
      const double bend = -400.0 * s.radius[i] * s.radius[i] / (2.0 * kSphere) * frame.w[c];
      color[3][c] = color[5][c] = static_cast<float>(bend);
    }
    encodeColor(color, s.colors.data() + i * kColorBytes);
  }
  return s;
}

/** Largest difference of a frame's colours from the truth at its positions, 0..255. */
double worstColor(const GBuffer& buffer) {
  double worst = 0.0;
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    for (std::size_t c = 0; c < 3 && buffer.covered(i); ++c)
      worst = std::max(
          worst, double{std::abs(255.0f * buffer.color[i][c] - channelAt(buffer.position[i], c))});
  }
  return worst;
}

// Bytes round a colour and its slopes by half a step.
constexpr double kRounding = 2.0;

TEST(SurfaceColor, IsTheSurfacesOwnWhateverDrawsIt) {
  const SLIMSurface surface = coloredSphere();
  RenderParams params;
  params.columns = kColorColumn;
  for (const bool reference : {false, true}) {
    const auto draw = reference ? lab::renderReference : renderSurface;
    GBuffer buffer;
    ASSERT_FALSE(draw(surface, frontCamera(), params, buffer, nullptr));
    ASSERT_GT(buffer.numCovered(), 1000u);
    ASSERT_EQ(buffer.color.size(), buffer.numPixels());
    EXPECT_LT(worstColor(buffer), kRounding) << reference;
  }
  RayTracer tracer(surface);
  EXPECT_TRUE(tracer.hasColors());
  TraceParams traced;
  traced.columns = kColorColumn;
  GBuffer buffer;
  LightBuffer light;
  ASSERT_FALSE(tracer.trace(frontCamera(), traced, buffer, light));
  ASSERT_GT(buffer.numCovered(), 1000u);
  EXPECT_LT(worstColor(buffer), kRounding);
}

TEST(SurfaceColor, IsTheSameForAnyThreadsAndSkipping) {
  const SLIMSurface surface = coloredSphere();
  RenderParams params;
  params.columns = kColorColumn;
  params.threads = 1;
  GBuffer one, other;
  ASSERT_FALSE(renderSurface(surface, frontCamera(), params, one));
  params.threads = 3;
  params.skip = false;
  ASSERT_FALSE(renderSurface(surface, frontCamera(), params, other));
  expectSame(one, other);
}

TEST(SurfaceColor, IsSeenFromBehindToo) {
  const SLIMSurface surface = coloredSphere();
  RenderParams params;
  params.columns = kColorColumn;
  params.cuts = {{{0.0, 0.0, -1.0}, 0.0}};  // the half that faces the camera is cut away
  GBuffer buffer;
  ASSERT_FALSE(renderSurface(surface, frontCamera(), params, buffer));
  ASSERT_GT(buffer.numCovered(), 1000u);
  EXPECT_LT(worstColor(buffer), kRounding);
}

TEST(SurfaceColor, MakesPicturesOnlyOfColouredSurfaces) {
  SLIMSurface surface = coloredSphere();
  ShadingParams shading;
  shading.mode = ShadingMode::kColor;
  shading.lighting = false;
  const auto picture = renderPicture(surface, frontCamera(), {}, shading);
  ASSERT_TRUE(picture) << picture.error().message;
  const std::size_t middle = 3 * (30 * 80 + 40);
  EXPECT_NEAR(picture->rgb[middle + 2], 228, 3) << "blue at the pole";
  RayTracer tracer(surface);
  const auto traced = renderTracedPicture(tracer, frontCamera(), {}, shading);
  ASSERT_TRUE(traced) << traced.error().message;
  EXPECT_GT(traced->rgb[middle + 2], traced->rgb[middle]);

  surface.colors.clear();
  const auto none = renderPicture(surface, frontCamera(), {}, shading);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("no colours"), std::string::npos);
  RayTracer plain(surface);
  EXPECT_FALSE(renderTracedPicture(plain, frontCamera(), {}, shading));
}

}  // namespace
}  // namespace pcl_slim::test

// SPDX-License-Identifier: BSD-3-Clause
// Colours of surfaces in pages beside the renderer's.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/query/surface_probe.h"
#include "pcl_slim/render/auto_view.h"
#include "support/colors.h"
#include "support/lab/reference/reference_renderer.h"
#include "web/page_file.h"
#include "web/page_frame.h"

namespace pcl_slim {
namespace {

using namespace test;
using measure::Shape;

/** \brief A surface with random colours of each leaf, and random textures if asked for. */
SLIMSurface coloredSurface(Shape shape, int degree, bool oriented, bool textured) {
  SLIMSurface surface = fittedSurface(shape, degree, oriented);
  pcl_slim_test::setRandomColors(surface);
  if (textured) pcl_slim_test::setRandomTextures(surface);
  return surface;
}

PageParams unrounded() {
  PageParams params;
  params.precision = 0.0;
  params.color_error = 0;
  return params;
}

ShadingParams unlit() {
  ShadingParams shading;
  shading.mode = ShadingMode::kColor;
  shading.lighting = false;
  shading.supersampling = 1;
  return shading;
}

TEST(ColoredPage, DrawsTheSurfacesColours) {
  const std::string why = whyNoBrowser();
  if (!why.empty()) GTEST_SKIP() << why;
  for (const auto& [exact, textured] : {std::tuple{true, false}, std::tuple{false, false},
                                        std::tuple{true, true}, std::tuple{false, true}}) {
    const SLIMSurface surface = exact ? coloredSurface(Shape::kBumpy, 4, true, textured)
                                      : coloredSurface(Shape::kRelief, 1, false, textured);
    const Camera camera =
        fitCamera(spheresOf(surface), viewFromAngles(UpAxis::kZ, 30, 25), {kWidth, kHeight});
    const ShadingParams shading = unlit();
    const PageFile page(surface, camera, shading, unrounded());
    RenderParams rendering;
    rendering.columns = columnsFor(shading);
    GBuffer truth;
    ASSERT_FALSE(lab::renderReference(surface, camera, rendering, truth));
    const auto picture = shade(truth, camera, shading, surface.info.scale);
    ASSERT_TRUE(picture);
    const PageFrame frame = drawPage("gbuffer.mjs", page.path(), surface, {kWidth, kHeight}, 0.0,
                                     {"color", "shaded", "color"}, exact);
    ASSERT_EQ(frame.pictures.size(), 3u);
    const double most = exact ? 2e-3 : textured ? 0.03 : 6e-3;
    EXPECT_LT(shareOff(frame.pictures[0], *picture), most) << exact << textured;
    EXPECT_GT(shareOff(frame.pictures[1], *picture), 0.2);
    EXPECT_EQ(frame.pictures[0], frame.pictures[2]);
  }
}

TEST(ColoredPage, AnswersClicksWithTheColour) {
  if (std::string(PCL_SLIM_NODE).empty()) GTEST_SKIP() << "node is not installed";
  for (const auto& [oriented, textured] :
       {std::tuple{true, false}, std::tuple{false, false}, std::tuple{true, true}}) {
    const SLIMSurface surface = coloredSurface(Shape::kBumpy, 3, oriented, textured);
    const Camera camera =
        fitCamera(spheresOf(surface), viewFromAngles(UpAxis::kZ, 30, 25), {48, 36});
    const PageFile page(surface, camera, unlit(), unrounded());
    const PageFrame frame = drawPage("cast.mjs", page.path(), surface, {48, 36}, 0.0, {"color"});
    GBuffer truth;
    RenderParams rendering;
    rendering.columns |= kColorColumn;
    ASSERT_FALSE(lab::renderReference(surface, camera, rendering, truth));
    ASSERT_EQ(frame.pictures.size(), 1u);
    // Of places, which a click shows, not of pixels.
    std::vector<Vector3> places;
    std::vector<std::array<float, 3>> normals;
    std::vector<std::size_t> pixels;
    for (std::size_t i = 0; i < truth.numPixels(); ++i) {
      if (!truth.covered(i)) continue;
      const auto &p = truth.position[i], &n = truth.normal[i];
      const float sign = truth.back_face[i] ? -1.0f : 1.0f;
      places.push_back(along(surface.info.origin, surface.info.scale, Vector3{p[0], p[1], p[2]}));
      normals.push_back({sign * n[0], sign * n[1], sign * n[2]});
      pixels.push_back(i);
    }
    const auto colors = surfaceColors(surface, places, normals, 0);
    const std::size_t seen = pixels.size();  // both are rounded
    std::size_t off = 0;
    for (std::size_t k = 0; k < seen; ++k) {
      for (std::size_t c = 0; c < 3; ++c)
        off += std::abs(int{frame.pictures[0][4 * pixels[k] + c]} - int{colors[k][c]}) > 1;
    }
    EXPECT_GT(seen, 300u);
    EXPECT_EQ(off, 0u) << oriented << textured;
  }
}

TEST(ColoredPage, HasTexturesForSmallCards) {
  if (std::string(PCL_SLIM_NODE).empty()) GTEST_SKIP() << "node is not installed";
  SLIMSurface surface = coloredSurface(Shape::kBumpy, 3, true, false);
  pcl_slim_test::setTexturesOf(surface, 24, [](const std::array<double, 3>& p) {
    return pcl_slim_test::waveColor({8.0 * p[0], 8.0 * p[1], 2.0 * p[2]});
  });
  const PageFile page(surface, frontCamera(kWidth, kHeight), unlit(), unrounded());
  EXPECT_EQ(runScript("textures.mjs", page.path()), "");
}

}  // namespace
}  // namespace pcl_slim

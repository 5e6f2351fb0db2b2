// SPDX-License-Identifier: BSD-3-Clause
// Colours of surfaces in pages beside the renderer's.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

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
    EXPECT_LT(shareOff(frame.pictures[0], *picture), exact ? 2e-3 : 6e-3) << textured;
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
    std::size_t seen = 0, off = 0;
    for (std::size_t i = 0; i < truth.numPixels(); ++i) {
      seen += truth.covered(i);
      for (std::size_t c = 0; c < 3 && truth.covered(i); ++c)
        off += std::abs(frame.pictures[0][4 * i + c] - 255.0 * truth.color[i][c]) > 0.6;
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

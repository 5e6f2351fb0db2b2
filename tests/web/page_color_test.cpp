// SPDX-License-Identifier: BSD-3-Clause
// Colours of surfaces in pages beside the renderer's.
#include <gtest/gtest.h>

#include "pcl_slim/render/auto_view.h"
#include "support/colors.h"
#include "support/lab/reference/reference_renderer.h"
#include "web/page_file.h"
#include "web/page_frame.h"

namespace pcl_slim {
namespace {

using namespace test;
using measure::Shape;

TEST(ColoredPage, DrawsTheSurfacesColours) {
  const std::string why = whyNoBrowser();
  if (!why.empty()) GTEST_SKIP() << why;
  for (const bool exact : {true, false}) {
    SLIMSurface surface =
        exact ? fittedSurface(Shape::kBumpy, 4, true) : fittedSurface(Shape::kRelief, 1, false);
    pcl_slim_test::setRandomColors(surface);
    const Camera camera =
        fitCamera(spheresOf(surface), viewFromAngles(UpAxis::kZ, 30, 25), {kWidth, kHeight});
    const PageFile page(surface, camera, 0.0, 0.0, {}, ShadingMode::kColor);
    ShadingParams shading;
    shading.mode = ShadingMode::kColor;
    shading.lighting = false;
    shading.supersampling = 1;
    RenderParams rendering;
    rendering.columns = columnsFor(shading);
    GBuffer truth;
    ASSERT_FALSE(lab::renderReference(surface, camera, rendering, truth));
    const auto picture = shade(truth, camera, shading, surface.info.scale);
    ASSERT_TRUE(picture);
    const PageFrame frame = drawPage("gbuffer.mjs", page.path(), surface, {kWidth, kHeight}, 0.0,
                                     {"color", "shaded", "color"}, exact);
    ASSERT_EQ(frame.pictures.size(), 3u);
    EXPECT_LT(shareOff(frame.pictures[0], *picture), exact ? 2e-3 : 6e-3);
    EXPECT_GT(shareOff(frame.pictures[1], *picture), 0.2);
    EXPECT_EQ(frame.pictures[0], frame.pictures[2]);
  }
}

TEST(ColoredPage, AnswersClicksWithTheColour) {
  if (std::string(PCL_SLIM_NODE).empty()) GTEST_SKIP() << "node is not installed";
  for (const bool oriented : {true, false}) {
    SLIMSurface surface = fittedSurface(Shape::kBumpy, 3, oriented);
    pcl_slim_test::setRandomColors(surface);
    const Camera camera =
        fitCamera(spheresOf(surface), viewFromAngles(UpAxis::kZ, 30, 25), {48, 36});
    const PageFile page(surface, camera, 0.0, 0.0, {}, ShadingMode::kColor);
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
    EXPECT_EQ(off, 0u) << oriented;
  }
}

}  // namespace
}  // namespace pcl_slim

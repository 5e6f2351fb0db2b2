// SPDX-License-Identifier: BSD-3-Clause
// Pages in a browser without a graphics card: what the processor traces, and what is seen when.
#include <gtest/gtest.h>

#include "pcl_slim/render/auto_view.h"
#include "support/colors.h"
#include "web/page_file.h"
#include "web/page_frame.h"

namespace pcl_slim {
namespace {

using namespace test;
using measure::Shape;

TEST(PageWithoutCard, TracesWhatShadersDraw) {
  const std::string why = whyNoBrowser();
  if (!why.empty()) GTEST_SKIP() << why;
  for (const auto& [shape, degree, oriented] :
       {std::tuple{Shape::kBumpy, 4, true}, std::tuple{Shape::kRelief, 2, false}}) {
    SLIMSurface surface = fittedSurface(shape, degree, oriented);
    pcl_slim_test::setRandomColors(surface);
    if (!oriented) pcl_slim_test::setRandomTextures(surface);
    const Camera camera =
        fitCamera(spheresOf(surface), viewFromAngles(UpAxis::kZ, 30, 25), {kWidth, kHeight});
    const PageFile page(surface, camera, ShadingParams(), PageParams());
    EXPECT_EQ(runScript("software.mjs", page.path() + " shaded mean level size color"), "");
  }
}

TEST(PageWithoutCard, ShowsDiscs) {
  const std::string why = whyNoBrowser();
  if (!why.empty()) GTEST_SKIP() << why;
  ShadingParams shading;
  shading.mode = ShadingMode::kColor;
  const PageFile page(discsOnSphere(), frontCamera(kWidth, kHeight), shading);
  EXPECT_EQ(runScript("software.mjs", page.path() + " color"), "");
}

}  // namespace
}  // namespace pcl_slim

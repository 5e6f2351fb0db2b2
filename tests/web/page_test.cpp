// SPDX-License-Identifier: BSD-3-Clause
// Pages in a real browser beside the renderer in double. Small pictures: a processor draws them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/surface/surface_io.h"
#include "pcl_slim/web/page.h"
#include "support/clouds.h"
#include "support/frame_difference.h"
#include "support/lab/reference/reference_renderer.h"
#include "unit/render/sphere_view.h"
#include "web/page_file.h"
#include "web/page_frame.h"

namespace pcl_slim {
namespace {

using namespace test;
using measure::Shape;

class PageInBrowser : public testing::Test {
 protected:
  void SetUp() override {
    const std::string why = whyNoBrowser();
    if (!why.empty()) GTEST_SKIP() << why;
  }

  static Camera cameraFor(const SLIMSurface& surface) {
    return fitCamera(spheresOf(surface), viewFromAngles(UpAxis::kZ, 30, 25), {kWidth, kHeight});
  }

  /** \brief The browser's frame, and how it differs from the renderer's in double. */
  static FrameDifference draw(const SLIMSurface& surface, double precision, double lod,
                              const std::vector<std::string>& modes, PageFrame& frame,
                              bool exact = true) {
    return draw(surface, cameraFor(surface), precision, lod, modes, frame, exact);
  }
  static FrameDifference draw(const SLIMSurface& surface, const Camera& camera, double precision,
                              double lod, const std::vector<std::string>& modes, PageFrame& frame,
                              bool exact) {
    const PageFile page(surface, camera, precision, lod);
    frame = drawPage("gbuffer.mjs", page.path(), surface, {kWidth, kHeight}, lod, modes, exact);
    RenderParams rendering;
    rendering.lod = lod;
    const auto draw =
        lod == 0.0 ? lab::renderReference : renderSurface;  // the former: leaves alone
    GBuffer truth;
    EXPECT_FALSE(draw(surface, camera, rendering, truth, nullptr));
    if (frame.buffer.numPixels() != truth.numPixels()) return {};
    return compareFrames(frame.buffer, truth, surface.info.diagonal);
  }
};

TEST_F(PageInBrowser, DrawsWhatTheRendererDraws) {
  const std::vector<std::string> modes{"shaded", "normal", "mean", "gauss", "kmax",
                                       "kmin",   "level",  "size", "error", "reflection"};
  for (const auto& [shape, degree, oriented] :
       {std::tuple{Shape::kBumpy, 4, true}, std::tuple{Shape::kRelief, 2, false}}) {
    const SLIMSurface surface = fittedSurface(shape, degree, oriented);
    PageFrame frame;
    const FrameDifference d = draw(surface, 0.0, 0.0, modes, frame);
    EXPECT_GT(d.both, 2000u);
    EXPECT_LE(d.one, 2u);
    EXPECT_LT(d.normal_p99, 2e-3);  // floats beside doubles
    EXPECT_LT(d.depth_p99, 1e-6);
    EXPECT_LT(d.curvature_p95, 1e-4);
    EXPECT_LE(d.leaves, d.both / 1000);
    ASSERT_EQ(frame.pictures.size(), modes.size());
    SurfaceRenderer renderer(surface);
    ShadingParams shading;
    shading.ambient_occlusion = 0.0;
    shading.supersampling = 1;
    for (std::size_t k = 0; k < modes.size(); ++k) {
      shading.mode = *shadingModeOf(modes[k]);
      const auto picture = renderPicture(renderer, cameraFor(surface), {}, shading);
      ASSERT_TRUE(picture);
      EXPECT_LT(shareOff(frame.pictures[k], *picture), 2e-3) << modes[k];
    }
  }
}

TEST_F(PageInBrowser, DrawsInParallelProjection) {
  const SLIMSurface surface = fittedSurface(Shape::kRelief, 2, false);
  const Camera camera = fitOrthographicCamera(
      spheresOf(surface), viewFromAngles(UpAxis::kZ, 30, 25), {kWidth, kHeight});
  PageFrame frame;
  const FrameDifference d = draw(surface, camera, 0.0, 0.0, {}, frame, true);
  EXPECT_GT(d.both, 2000u);
  EXPECT_LE(d.one, 2u);
  EXPECT_LT(d.normal_p99, 2e-3);
  EXPECT_LT(d.depth_p99, 1e-6);
}

TEST_F(PageInBrowser, DrawsARoundedSurface) {
  const SLIMSurface surface = fittedSurface(Shape::kRelief, 4, true);
  ASSERT_TRUE(surface.hasTrimMaps());
  PageFrame frame;
  const FrameDifference d = draw(surface, PageParams().precision, 0.0, {}, frame);
  EXPECT_GT(d.both, 2000u);
  EXPECT_LE(d.one, 4u);
  EXPECT_LT(d.normal_p95, 0.06);
  EXPECT_LT(d.depth_p99, 4e-5);  // along rays that meet it at 25 degrees
}

/** The table of docs/web_page.md: surfaces named in PCL_SLIM_PAGES, separated by commas. */
TEST_F(PageInBrowser, DrawsGivenSurfaces) {
  const char* const files = std::getenv("PCL_SLIM_PAGES");
  if (!files) GTEST_SKIP() << "PCL_SLIM_PAGES names no .slim files";
  std::printf(
      "| surface | bytes | covered by one | normals p95 | p99 | position p99 | off by > 2 |\n");
  std::istringstream names(files);
  for (std::string name; std::getline(names, name, ',');) {
    const Result<SLIMSurface> loaded = loadSlim(name);
    ASSERT_TRUE(loaded) << name;
    const SLIMSurface& surface = *loaded;
    const ImageSize size{200, 150};
    const Camera camera = fitCamera(spheresOf(surface), viewFromAngles(UpAxis::kZ, 30, 25), size);
    const PageFile page(surface, camera, PageParams().precision);
    const PageFrame frame = drawPage("gbuffer.mjs", page.path(), surface, size, 0.0, {"shaded"});
    GBuffer truth;
    ASSERT_FALSE(lab::renderReference(surface, camera, {}, truth));
    ShadingParams shading;
    shading.ambient_occlusion = 0.0;
    const auto picture = shade(truth, camera, shading, surface.info.scale);
    ASSERT_TRUE(picture);
    ASSERT_EQ(frame.pictures.size(), 1u) << name;
    const FrameDifference d = compareFrames(frame.buffer, truth, surface.info.diagonal);
    const double off = shareOff(frame.pictures[0], *picture);
    std::printf("| %s | %zu | %zu | %.3f | %.3f | %.1e | %.1e |\n", name.c_str(), page.bytes(),
                d.one, d.normal_p95, d.normal_p99, d.depth_p99, off);
    EXPECT_LE(d.one, 2u) << name;
    EXPECT_LT(d.normal_p95, 0.06) << name;
    EXPECT_LT(d.depth_p99, 2e-5) << name;
    EXPECT_LT(off, 4e-4) << name;
  }
}

TEST_F(PageInBrowser, DrawsOnTheScreenInHalfFloats) {
  const SLIMSurface surface = fittedSurface(Shape::kBumpy, 4, true);
  PageFrame frame;
  const FrameDifference d = draw(surface, 0.0, 0.0, {"shaded"}, frame, false);
  EXPECT_GT(d.both, 2000u);
  EXPECT_LE(d.one, 4u);
  // Eleven bits of sums over some ten leaves.
  EXPECT_LT(d.normal_p95, 0.05);
  EXPECT_GT(d.normal_p95, 1e-3);
  EXPECT_LT(d.curvature_p95, 2e-3);
}

TEST_F(PageInBrowser, DrawsALevelOfDetail) {
  const SLIMSurface surface = fittedSurface(Shape::kBumpy, 2, true);
  PageFrame frame;
  const FrameDifference d = draw(surface, 0.0, 8.0, {}, frame);
  EXPECT_GT(d.both, 2000u);
  EXPECT_LE(d.one, 2u);
  EXPECT_LT(d.normal_p95, 0.1);
  EXPECT_LE(d.leaves, d.both / 100);
}

TEST_F(PageInBrowser, DrawsSplats) {
  const SplatSet splats = discsOnSphere();
  const Camera camera = frontCamera(kWidth, kHeight);
  ShadingParams shading;
  shading.mode = ShadingMode::kColor;
  shading.lighting = false;
  shading.ambient_occlusion = 0.0;
  shading.supersampling = 1;
  const PageFile page(splats, camera, shading);
  SLIMSurface units;
  const PageFrame frame =
      drawPage("gbuffer.mjs", page.path(), units, {kWidth, kHeight}, 0.0, {"color", "shaded"});
  GBuffer truth;
  ASSERT_FALSE(renderDiscs(splats, camera, {}, truth));
  ASSERT_EQ(frame.pictures.size(), 2u);
  const FrameDifference d = compareFrames(frame.buffer, truth, 2.0 * kSphere);
  EXPECT_GT(d.both, 2000u);
  EXPECT_LE(d.one, d.both / 200);  // radii and places are rounded
  EXPECT_LT(d.normal_p95, 0.3);
  EXPECT_LT(d.depth_p99, 1e-3);
  for (std::size_t k = 0; k < 2; ++k) {
    shading.mode = k == 0 ? ShadingMode::kColor : ShadingMode::kShaded;
    shading.lighting = k > 0;
    const auto picture = renderPicture(splats, camera, {}, shading);
    ASSERT_TRUE(picture);
    EXPECT_LT(shareOff(frame.pictures[k], *picture), 0.02) << k;
  }
}

TEST_F(PageInBrowser, DrawsLinesWhereTheyAreSeen) {
  // A circle on the sphere whose near half is the upper one.
  SpaceLine ring;
  ring.kind = PictureLineKind::kRidge;
  for (int k = 0; k <= 100; ++k) {
    const double angle = 2.0 * std::acos(-1.0) * k / 100.0, up = 0.5, near = std::sqrt(0.75);
    ring.points.push_back({kSphere * std::cos(angle), kSphere * up * std::sin(angle),
                           kSphere * near * std::sin(angle)});
  }
  const SLIMSurface sphere = sphereSurface(4, kSphere, 300, 0.07);
  const PageFile page(sphere, frontCamera(kWidth, kHeight), 640.0, 0.0, {ring});
  const PageFrame frame =
      drawPage("gbuffer.mjs", page.path(), sphere, {kWidth, kHeight}, 0.0, {"shaded"});
  ASSERT_EQ(frame.pictures.size(), 1u);
  int red[2] = {0, 0};  // below and above the middle, but for the sphere's sides
  for (int y = 0; y < kHeight; ++y) {
    for (int x = kWidth / 3; x < 2 * kWidth / 3; ++x) {
      const std::uint8_t* pixel =
          &frame.pictures[0][static_cast<std::size_t>(4 * (y * kWidth + x))];
      red[y >= kHeight / 2] += pixel[0] > 2 * pixel[1];
    }
  }
  EXPECT_GE(red[1], kWidth / 3);
  EXPECT_EQ(red[0], 0);
}

TEST_F(PageInBrowser, DoesWhatItsReaderDoes) {
  const SLIMSurface sphere = sphereSurface(4, kSphere, 300, 0.07);
  const PageFile page(sphere, frontCamera(kWidth, kHeight), 640.0);
  EXPECT_EQ(runScript("actions.mjs", page.path()), "");
}

TEST(PageInNode, AnswersClicksInDouble) {
  if (std::string(PCL_SLIM_NODE).empty()) GTEST_SKIP() << "node is not installed";
  for (const auto& [shape, degree] :
       {std::tuple{Shape::kBumpy, 4}, std::tuple{Shape::kRelief, 3}}) {
    const SLIMSurface surface = fittedSurface(shape, degree, shape == Shape::kBumpy);
    const Camera camera =
        fitCamera(spheresOf(surface), viewFromAngles(UpAxis::kZ, 30, 25), {48, 36});
    const PageFile page(surface, camera, 0.0);
    const PageFrame frame = drawPage("cast.mjs", page.path(), surface, {48, 36}, 0.0, {});
    GBuffer truth;
    ASSERT_FALSE(lab::renderReference(surface, camera, {}, truth));
    ASSERT_EQ(frame.buffer.numPixels(), truth.numPixels());
    const FrameDifference d = compareFrames(frame.buffer, truth, surface.info.diagonal);
    EXPECT_GT(d.both, 300u);
    EXPECT_EQ(d.one, 0u);
    // Both are rounded to float.
    EXPECT_LT(d.depth_p99, 3e-7);
    EXPECT_LT(d.normal_p99, 2e-5);
    EXPECT_LT(d.curvature_p95, 1e-5);
    EXPECT_EQ(d.leaves, 0u);
  }
}

}  // namespace
}  // namespace pcl_slim

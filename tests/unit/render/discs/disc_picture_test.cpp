// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/bounding_spheres.h"
#include "pcl_slim/render/shading.h"
#include "test_discs.h"
#include "unit/render/image_pixels.h"
#include "unit/render/test_surfaces.h"

namespace pcl_slim {
namespace {

using namespace test;

TEST(DiscPicture, UnlitColorsAreTheDiscsOwn) {
  SplatSet set;
  addDisc(set, {0.0, 0.0, 0.0}, {0.6, 0.0, 1.0}, 0.3, 0x1e90ff);
  ShadingParams shading;
  shading.mode = ShadingMode::kColor;
  shading.lighting = false;
  const auto flat = renderPicture(set, discCamera(60, 60), {}, shading);
  ASSERT_TRUE(flat) << flat.error().message;
  EXPECT_EQ(pixelOf(*flat, 30, 30), (std::array<int, 3>{0x1e, 0x90, 0xff}));
  shading.lighting = true;
  const auto lit = renderPicture(set, discCamera(60, 60), {}, shading);
  ASSERT_TRUE(lit);
  EXPECT_NE(pixelOf(*lit, 30, 30), pixelOf(*flat, 30, 30));
  EXPECT_EQ(pixelOf(*lit, 0, 0), pixelOf(*flat, 0, 0));
}

TEST(DiscPicture, SupersamplingSoftensTheRim) {
  SplatSet set;
  addDisc(set, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.4, 0x000000);
  ShadingParams shading;
  shading.mode = ShadingMode::kColor;
  shading.lighting = shading.gradient_background = false;
  for (const int n : {1, 4}) {
    shading.supersampling = n;
    const auto image = renderPicture(set, discCamera(60, 60), {}, shading);
    ASSERT_TRUE(image);
    std::size_t between = 0;
    for (const std::uint8_t value : image->rgb) between += value > 0 && value < 255;
    EXPECT_EQ(between > 0, n > 1);
  }
}

TEST(DiscPicture, ModesThatDiscsOrSurfacesLackAreRefused) {
  const SplatSet set = discSphere(0.5, 100, 0.1);
  ShadingParams shading;
  for (const ShadingMode mode : {ShadingMode::kMean, ShadingMode::kLevel}) {
    shading.mode = mode;
    EXPECT_FALSE(renderPicture(set, discCamera(20, 20), {}, shading));
  }
  for (const ShadingMode mode : {ShadingMode::kShaded, ShadingMode::kNormal, ShadingMode::kSize}) {
    shading.mode = mode;
    EXPECT_TRUE(renderPicture(set, discCamera(20, 20), {}, shading));
  }
  shading.mode = ShadingMode::kColor;
  const SLIMSurface surface = test::sphereSurface(2, 0.25, 100, 0.1);
  EXPECT_FALSE(renderPicture(surface, discCamera(20, 20), RenderParams(), shading));
  GBuffer buffer;
  ASSERT_FALSE(renderSurface(surface, discCamera(20, 20), {}, buffer));
  EXPECT_FALSE(shade(buffer, discCamera(20, 20), shading));
}

// The whole object is in view and fills most of it, wherever it is.
TEST(DiscPicture, CamerasFrameDiscs) {
  SplatSet set = discSphere(0.5, 2000, 0.04);
  set.origin = {637000.0, 851000.0, 500.0};
  const BoundingSpheres object = spheresOf(set);
  EXPECT_EQ(object.spheres.size(), set.size());
  const ImageSize size{64, 48};
  for (const Camera& camera : {cameraFor(chooseView(object), object, size),
                               fitOrthographicCamera(object, chooseView(object).direction, size)}) {
    GBuffer buffer;
    ASSERT_FALSE(renderDiscs(set, camera, {}, buffer));
    // A circle as high as the picture has pi/4 of a square's pixels.
    EXPECT_GT(buffer.numCovered(), static_cast<std::size_t>(0.6 * 48 * 48));
    for (int x = 0; x < 64; ++x) EXPECT_FALSE(buffer.covered(buffer.index(x, 0)));
  }
  EXPECT_TRUE(spheresOf(SplatSet()).spheres.empty());
  SplatSet point;
  addDisc(point, {1, 2, 3}, {0, 0, 1}, 0.0, 0);
  const BoundingSpheres one = spheresOf(point);
  EXPECT_GT(one.spheres[0].radius, 0.0f);
  EXPECT_FALSE(cameraFor(chooseView(one), one, size).validate());
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// The window's light against the pictures': the same camera, mode and model, pixel by pixel.
#include <vtkLight.h>

#include <string>
#include <tuple>

#include "pcl_slim/render/shading.h"
#include "pcl_slim/visualization/splat_mapper.h"
#include "pcl_slim/visualization/studio.h"
#include "support/colors.h"
#include "visualization/test_window.h"

namespace pcl_slim::test {
namespace {

/** \brief How two pictures differ where neither has an edge: both differ little from their
 * neighbours there. */
struct InnerDifference {
  double mean = 0.0;  ///< of all channels
  int most = 0;
  std::size_t pixels = 0;

  InnerDifference(const Image& a, const Image& b, const GBuffer& seen) {
    constexpr int kRim = 2;
    for (int y = kRim; y + kRim < a.height; ++y) {
      for (int x = kRim; x + kRim < a.width; ++x) {
        if (!inside(seen, x, y, kRim)) continue;
        ++pixels;
        const auto p = pixelOf(a, x, y), q = pixelOf(b, x, y);
        for (std::size_t k = 0; k < 3; ++k) {
          mean += std::abs(p[k] - q[k]) / 3.0;
          most = std::max(most, std::abs(p[k] - q[k]));
        }
      }
    }
    mean /= static_cast<double>(std::max<std::size_t>(1, pixels));
  }

 private:
  static bool inside(const GBuffer& seen, int x, int y, int rim) {
    for (int v = y - rim; v <= y + rim; ++v) {
      for (int u = x - rim; u <= x + rim; ++u) {
        if (!seen.covered(seen.index(u, v))) return false;
      }
    }
    return true;
  }
};

class StudioLightTest : public WindowTest {
 protected:
  StudioLightTest() {
    setStudioBackground(renderer);
    setClayLook(actor->GetProperty());
    // Lights that must not count.
    vtkNew<vtkLight> green;
    green->SetColor(0.0, 1.0, 0.0);
    renderer->AddLight(green);
    renderer->AddActor(actor);
  }

  void show(GBufferMapper* shown) {
    shown->setLight(ObjectLight::kStudio);
    actor->SetMapper(shown);
  }

  /** \brief The window's camera as the module has it. */
  Camera cameraOfWindow() const {
    vtkCamera* from = const_cast<vtkRenderer*>(renderer.Get())->GetActiveCamera();
    Camera camera;
    from->GetPosition(camera.position.data());
    from->GetFocalPoint(camera.look_at.data());
    from->GetViewUp(camera.up.data());
    camera.fov = from->GetViewAngle();
    if (from->GetParallelProjection()) {
      camera.projection = Camera::Projection::kOrthographic;
      camera.view_height = 2.0 * from->GetParallelScale();
    }
    camera.size = {160, 120};
    return camera;
  }

  /** \brief The window's picture against that of an object's module. */
  template <typename Object, typename Params>
  void expectThePicture(const Object& object, const Params& params, const GBuffer& seen,
                        GBufferMapper* shown, const std::string& mode) {
    SCOPED_TRACE(mode);
    ASSERT_TRUE(shown->setMode(*displayModeOf(mode)));
    ASSERT_TRUE(shown->fitRanges(renderer, actor));
    ShadingParams shading;
    shading.mode = *shadingModeOf(mode);
    // The window smooths stripes as four rays a pixel do.
    shading.supersampling = mode == "reflection" ? 2 : 1;
    shading.lighting = actor->GetProperty()->GetLighting();
    const auto expected = renderPicture(object, cameraOfWindow(), params, shading);
    ASSERT_TRUE(expected) << expected.error().message;
    const InnerDifference inner(picture(), *expected, seen);
    EXPECT_GT(inner.pixels, 1000u);
    // Bytes of colours are rounded twice. Normals change by more than their derivative within a pixel.
    EXPECT_LE(inner.mean, mode == "reflection" ? 4.0 : 1.0);
    EXPECT_LE(inner.most, mode == "reflection" ? 64 : 4);
  }

  void expectThePictures(const SLIMSurface& surface) {
    GBuffer seen;
    ASSERT_FALSE(renderSurface(surface, cameraOfWindow(), {}, seen));
    for (const char* mode :
         {"shaded", "normal", "mean", "gauss", "kmax", "kmin", "level", "size", "error", "color"}) {
      expectThePicture(surface, RenderParams{}, seen, mapper, mode);
    }
  }
};

std::shared_ptr<SLIMSurface> coloredUnevenSphere() {
  auto surface = unevenSphere(3);
  pcl_slim_test::setRandomColors(*surface);
  return surface;
}

TEST_F(StudioLightTest, ASurfaceLooksAsInAPicture) {
  mapper->setSurface(coloredUnevenSphere());
  show(mapper);
  renderer->GetActiveCamera()->Azimuth(30.0);
  renderer->GetActiveCamera()->Elevation(20.0);
  expectThePictures(*mapper->getSurface());
  renderer->GetActiveCamera()->SetParallelProjection(true);
  renderer->GetActiveCamera()->SetParallelScale(0.3);
  expectThePictures(*mapper->getSurface());
}

TEST_F(StudioLightTest, StripesAreMirroredAsInAPicture) {
  mapper->setSurface(smallSphere());
  show(mapper);
  GBuffer seen;
  ASSERT_FALSE(renderSurface(*mapper->getSurface(), cameraOfWindow(), {}, seen));
  expectThePicture(*mapper->getSurface(), RenderParams{}, seen, mapper, "reflection");
}

TEST_F(StudioLightTest, SeveralRaysAPixelAreAveragedAsInAPicture) {
  mapper->setSurface(coloredUnevenSphere());
  GBuffer seen;
  ASSERT_FALSE(renderSurface(*mapper->getSurface(), cameraOfWindow(), {}, seen));
  mapper->setSupersampling(2);
  show(mapper);
  for (const char* mode : {"shaded", "color", "mean", "level", "normal", "reflection"}) {
    SCOPED_TRACE(mode);
    mapper->setMode(*displayModeOf(mode));
    mapper->fitRanges(renderer, actor);
    ShadingParams shading;
    shading.mode = *shadingModeOf(mode);
    shading.range = {-mapper->getRange(), mapper->getRange()};
    const auto expected = renderPicture(*mapper->getSurface(), cameraOfWindow(), {}, shading);
    ASSERT_TRUE(expected) << expected.error().message;
    const Image image = picture();
    EXPECT_LE(InnerDifference(image, *expected, seen).mean, 0.5);
    // VTK blends the silhouette's pixels with the background as they are encoded: a third of the
    // range at most from blending light.
    EXPECT_LE(shareDifferent(image, *expected, 85), 4.0 / (160 * 120));
  }
  EXPECT_EQ(mapper->getStatistics().supersampling, 2);
}

TEST_F(StudioLightTest, AFineFrameIsKeptUntilSomethingMoves) {
  mapper->setSurface(smallSphere());
  show(mapper);
  picture();
  EXPECT_EQ(mapper->getStatistics().supersampling, 1);
  mapper->setSupersampling(2);
  picture();
  EXPECT_EQ(mapper->getStatistics().rasterized, 2u);
  mapper->setSupersampling(1);
  mapper->setMode(DisplayMode::kMean);
  picture();
  EXPECT_EQ(mapper->getStatistics().rasterized, 2u);
  EXPECT_EQ(mapper->getStatistics().supersampling, 2);
  renderer->GetActiveCamera()->Azimuth(10.0);
  picture();
  EXPECT_EQ(mapper->getStatistics().supersampling, 1);
  // VTK's lights light one ray a pixel, and lines are drawn with one.
  mapper->setSupersampling(2);
  picture();
  EXPECT_EQ(mapper->getStatistics().supersampling, 2);
  mapper->setLight(ObjectLight::kScene);
  picture();
  EXPECT_EQ(mapper->getStatistics().supersampling, 1);
  mapper->setLight(ObjectLight::kStudio);
  PictureLineParams lines;
  lines.contour = true;
  ASSERT_FALSE(mapper->setLines(lines));
  picture();
  EXPECT_EQ(mapper->getStatistics().supersampling, 1);
  EXPECT_FALSE(mapper->getError());
}

TEST_F(StudioLightTest, HollowsAreAsDarkAsInAPicture) {
  // Two spheres that run into each other, every other leaf on one of them.
  auto pair = std::make_shared<SLIMSurface>(sphereSurface(4, 0.15, 1200, 0.05));
  for (std::size_t i = 0; i < pair->size(); ++i) pair->cx[i] += i % 2 == 0 ? 0.12f : -0.12f;
  mapper->setSurface(pair);
  show(mapper);
  GBuffer seen;
  ASSERT_FALSE(renderSurface(*pair, cameraOfWindow(), {}, seen));
  expectThePicture(*pair, RenderParams{}, seen, mapper, "shaded");
  expectThePicture(*pair, RenderParams{}, seen, mapper, "mean");
  mapper->setMode(DisplayMode::kShaded);
  const Image shaded = picture();
  mapper->setAmbientOcclusion(0.0);
  EXPECT_GT(shareDifferent(shaded, picture(), 4), 0.004);
}

TEST_F(StudioLightTest, TheGraphicsCardsFrameIsLitAlike) {
  mapper->setSurface(coloredUnevenSphere());
  mapper->setBackend(RayBackend::kOpenGL);
  show(mapper);
  GBuffer seen;
  ASSERT_FALSE(renderSurface(*mapper->getSurface(), cameraOfWindow(), {}, seen));
  expectThePicture(*mapper->getSurface(), RenderParams{}, seen, mapper, "shaded");
  EXPECT_TRUE(mapper->getStatistics().on_card);
}

TEST_F(StudioLightTest, BareColoursAreThoseOfAPictureWithoutLight) {
  mapper->setSurface(coloredUnevenSphere());
  show(mapper);
  actor->GetProperty()->LightingOff();
  expectThePictures(*mapper->getSurface());
}

TEST_F(StudioLightTest, SplatsLookAsInAPicture) {
  SplatSet splats;
  const auto sphere = smallSphere();
  splats.resize(sphere->size(), false);
  for (std::size_t i = 0; i < splats.size(); ++i) {
    std::tie(splats.x[i], splats.y[i], splats.z[i]) =
        std::tie(sphere->cx[i], sphere->cy[i], sphere->cz[i]);
    std::tie(splats.nx[i], splats.ny[i], splats.nz[i]) =
        std::tie(sphere->nx[i], sphere->ny[i], sphere->nz[i]);
    splats.radius[i] = 0.03f;
    splats.rgb[i] = 0x804020u + static_cast<std::uint32_t>(i) * 0x10203u % 0x7f7f7fu;
  }
  vtkNew<SplatMapper> discs;
  ASSERT_TRUE(discs->setSplats(std::make_shared<SplatSet>(splats)));
  show(discs);
  GBuffer seen;
  ASSERT_FALSE(renderDiscs(splats, cameraOfWindow(), {}, seen));
  for (const char* mode : {"shaded", "color", "normal", "size"}) {
    expectThePicture(splats, DiscRenderParams{}, seen, discs, mode);
  }
}

TEST_F(StudioLightTest, TheBackgroundIsThePictures) {
  renderer->RemoveActor(actor);
  ShadingParams shading;
  GBuffer nothing;
  nothing.resize(160, 120);
  const auto expected = shade(nothing, cameraOfWindow(), shading);
  ASSERT_TRUE(expected);
  EXPECT_EQ(shareDifferent(picture(), *expected, 1), 0.0);
}

TEST_F(StudioLightTest, TheScenesLightsCountWhereTheyAreTheObjects) {
  addSphere();
  EXPECT_EQ(mapper->getLight(), ObjectLight::kScene);
  const auto inGreen = pixelOf(picture(), 80, 60);
  EXPECT_GT(inGreen[1], inGreen[0] + 20);
  mapper->setLight(ObjectLight::kStudio);
  const auto inStudio = pixelOf(picture(), 80, 60);
  EXPECT_NEAR(inStudio[1], inStudio[0], 2);
  // The actor's colour is seen in both.
  actor->GetProperty()->SetColor(0.9, 0.1, 0.1);
  const auto red = pixelOf(picture(), 80, 60);
  EXPECT_GT(red[0], red[1] + 60);
  EXPECT_EQ(mapper->getStatistics().rasterized, 1u);
}

TEST_F(StudioLightTest, RangesAreThoseOfTheViewUntilTheObjectChanges) {
  mapper->setSurface(unevenSphere(4));
  show(mapper);
  mapper->setMode(DisplayMode::kMean);
  const double whole = mapper->getRange();
  ASSERT_TRUE(mapper->fitRanges(renderer, actor));
  GBuffer seen;
  RenderParams all;
  all.columns = kAllColumns;
  ASSERT_FALSE(renderSurface(*mapper->getSurface(), cameraOfWindow(), all, seen));
  ShadingParams shading;
  shading.mode = ShadingMode::kMean;
  EXPECT_DOUBLE_EQ(mapper->getRange(), rangeOf(seen, shading, 1.0).high);
  renderer->GetActiveCamera()->SetFocalPoint(0.0, 5.0, 1.2);  // past the object
  EXPECT_FALSE(mapper->fitRanges(renderer, actor));
  EXPECT_DOUBLE_EQ(mapper->getRange(), rangeOf(seen, shading, 1.0).high);
  mapper->setRange(3.0);
  EXPECT_EQ(mapper->getRange(), 3.0);
  mapper->setRange(0.0);
  mapper->setSurface(unevenSphere(4));
  EXPECT_DOUBLE_EQ(mapper->getRange(), whole);
}

}  // namespace
}  // namespace pcl_slim::test

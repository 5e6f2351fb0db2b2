// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/traced_picture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/render/discs/test_discs.h"
#include "unit/render/image_pixels.h"
#include "unit/render/sphere_view.h"

namespace pcl_slim {
namespace {

using namespace test;

TEST(TracedPicture, LightsStandWhereTheViewerSeesThem) {
  Camera camera;  // at +z, up +y: the viewer's right is +x
  const auto expect = [&](double azimuth, double elevation, const std::array<double, 3>& right) {
    const auto direction = lightDirection(camera, azimuth, elevation);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(direction[k], right[k], 1e-12);
  };
  expect(0.0, 0.0, {0.0, 0.0, 1.0});
  expect(90.0, 0.0, {1.0, 0.0, 0.0});
  expect(-90.0, 0.0, {-1.0, 0.0, 0.0});
  expect(30.0, 90.0, {0.0, 1.0, 0.0});
  expect(180.0, 0.0, {0.0, 0.0, -1.0});
}

TEST(TracedPicture, TheSideTowardsTheLightIsBright) {
  const SLIMSurface surface = sphereSurface(4, kSphere, 600, 0.07);
  RayTracer tracer(surface);
  const Camera camera = frontCamera(64, 64);
  TraceParams params;
  params.lights.resize(1);
  params.lights[0].towards = lightDirection(camera, -80.0, 0.0);
  ShadingParams shading;
  shading.supersampling = 1;
  const auto image = renderTracedPicture(tracer, camera, params, shading);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_GT(pixelOf(*image, 20, 32)[0], pixelOf(*image, 44, 32)[0] + 60);
  EXPECT_GT(pixelOf(*image, 0, 0)[0], 200);  // the background
}

TEST(TracedPicture, DiscsShowTheirColours) {
  SplatSet set = discSphere(0.4, 900, 0.04);
  for (std::uint32_t& rgb : set.rgb) rgb = 0x20c040;
  RayTracer tracer(set);
  ShadingParams shading;
  shading.mode = ShadingMode::kColor;
  const auto image = renderTracedPicture(tracer, discCamera(40, 30), {}, shading);
  ASSERT_TRUE(image) << image.error().message;
  const auto middle = pixelOf(*image, 20, 15);
  EXPECT_GT(middle[1], middle[0] + 40);
  EXPECT_GT(middle[1], middle[2] + 40);
}

TEST(TracedPicture, SaysWhatItCannotShow) {
  const SLIMSurface surface = sphereSurface(2, kSphere, 200, 0.1);
  RayTracer tracer(surface);
  ShadingParams shading;
  shading.mode = ShadingMode::kColor;
  EXPECT_EQ(renderTracedPicture(tracer, frontCamera(), {}, shading).error().code,
            ErrorCode::kBadArgument);
  shading.mode = ShadingMode::kMean;
  EXPECT_EQ(renderTracedPicture(tracer, frontCamera(), {}, shading).error().code,
            ErrorCode::kBadArgument);
}

TEST(TracedPicture, StopsWhenItIsCancelled) {
  const SLIMSurface surface = sphereSurface(2, kSphere, 200, 0.1);
  RayTracer tracer(surface);
  Progress progress;
  progress.cancel();
  const auto image =
      renderTracedPicture(tracer, frontCamera(), {}, ShadingParams(), nullptr, &progress);
  EXPECT_EQ(image.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/shading.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>

#include "shading/shading.h"
#include "support/temporary_folder.h"
#include "unit/render/image_pixels.h"
#include "unit/render/sphere_view.h"
#include "unit/render/test_surfaces.h"

namespace pcl_slim {
namespace {

namespace fs = std::filesystem;
using namespace test;
using pcl_slim_test::TemporaryFolder;

Image pictured(ShadingMode mode, int supersampling = 1, int threads = 1) {
  RenderParams render_params;
  render_params.threads = threads;
  ShadingParams params;
  params.mode = mode;
  params.supersampling = supersampling;
  params.threads = threads;
  const auto image =
      renderPicture(sphereSurface(4, 0.25, 600, 0.07), frontCamera(96, 72), render_params, params);
  EXPECT_TRUE(image) << image.error().message;
  return *image;
}

TEST(Shading, NormalModeEncodesTheNormal) {
  const auto middle = pixelOf(pictured(ShadingMode::kNormal), 48, 36);
  EXPECT_NEAR(middle[0], 128, 4);
  EXPECT_NEAR(middle[1], 128, 4);
  EXPECT_NEAR(middle[2], 255, 2);
}

TEST(Shading, EveryModeShowsTheObjectAndKnowsItsName) {
  SLIMSurface surface = sphereSurface(4, 0.25, 600, 0.07);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    surface.radius[i] *= i % 2 ? 1.0f : 0.8f;
    surface.error[i] = 1e-3f * static_cast<float>(i % 7);
    surface.cz[i] *= 0.8f;  // a little off the sphere: curvatures differ
  }
  std::set<std::vector<std::uint8_t>> pictures;
  for (const char* name : {"shaded", "normal", "mean", "gauss", "kmax", "kmin", "level", "size",
                           "error", "reflection"}) {
    const auto mode = shadingModeOf(name);
    ASSERT_TRUE(mode) << name;
    ShadingParams params;
    params.mode = *mode;
    params.supersampling = 1;
    const auto image = renderPicture(surface, frontCamera(96, 72), RenderParams(), params);
    ASSERT_TRUE(image) << name;
    EXPECT_NE(pixelOf(*image, 48, 36), pixelOf(*image, 2, 36)) << name;
    pictures.insert(image->rgb);
  }
  EXPECT_EQ(pictures.size(), 10u);
  EXPECT_FALSE(shadingModeOf("sahded"));
}

TEST(Shading, ABarShowsTheRangeInTheMargin) {
  Camera camera = frontCamera(96, 72);
  camera.size = {320, 240};
  ShadingParams params;
  params.mode = ShadingMode::kMean;
  params.supersampling = 1;
  params.range = {-8.0, 8.0};
  const SLIMSurface surface = sphereSurface(4, 0.25, 600, 0.07);
  const auto plain = renderPicture(surface, camera, RenderParams(), params);
  params.color_bar = true;
  const auto barred = renderPicture(surface, camera, RenderParams(), params);
  ASSERT_TRUE(plain && barred);
  EXPECT_EQ(pixelOf(*plain, 100, 120), pixelOf(*barred, 100, 120));
  // Its upper end is the map's red, its lower one the map's blue.
  const detail::BarLayout bar({320, 240});
  const int x = bar.left + bar.width / 2;
  const auto top = pixelOf(*barred, x, bar.top + 2);
  const auto bottom = pixelOf(*barred, x, bar.top + bar.height - 3);
  EXPECT_GT(top[0], top[2] + 40);
  EXPECT_GT(bottom[2], bottom[0] + 40);
  params.mode = ShadingMode::kShaded;  // shows no numbers
  params.color_bar = false;
  const auto clay = renderPicture(surface, camera, RenderParams(), params);
  params.color_bar = true;
  EXPECT_EQ(clay->rgb, renderPicture(surface, camera, RenderParams(), params)->rgb);
}

TEST(Shading, ABufferWithoutTheModesColumnsIsRefused) {
  GBuffer buffer;
  RenderParams render_params;
  render_params.columns = 0;
  ASSERT_FALSE(
      renderSurface(sphereSurface(4, 0.25, 600, 0.07), frontCamera(96, 72), render_params, buffer));
  ShadingParams params;
  params.mode = ShadingMode::kNormal;
  EXPECT_TRUE(shade(buffer, frontCamera(96, 72), params));
  params.mode = ShadingMode::kMean;
  EXPECT_EQ(shade(buffer, frontCamera(96, 72), params).error().code, ErrorCode::kBadArgument);
}

TEST(Shading, AGivenRangeSetsTheCurvatureColours) {
  const Camera camera = frontCamera(96, 72);
  SLIMSurface surface = sphereSurface(4, 0.25, 600, 0.07);
  surface.info.scale = 0.5;  // world radius .125, mean curvature 8
  Camera near = camera;
  near.position = {0.0, 0.0, 0.6};
  GBuffer buffer;
  ASSERT_FALSE(renderSurface(surface, near, {}, buffer));
  ShadingParams params;
  params.mode = ShadingMode::kMean;
  EXPECT_NEAR(rangeOf(buffer, params, 0.5).high, 8.0, 0.2);
  params.range = {-8000.0,
                  8000.0};  // everything is flat against that: the middle of the map is grey
  const auto image = shade(buffer, near, params, 0.5);
  ASSERT_TRUE(image);
  const auto middle = pixelOf(*image, 48, 36);
  EXPECT_LT(std::abs(middle[0] - middle[2]), 16);
}

TEST(Shading, BarOfLevelsHasTheColoursOfThoseInThePicture) {
  SLIMSurface surface = sphereSurface(4, 0.25, 600, 0.07);
  for (std::size_t i = 0; i < surface.size(); ++i) surface.level[i] = surface.cx[i] < 0.0f ? 4 : 6;
  Camera camera = frontCamera(96, 72);
  camera.size = {320, 240};
  ShadingParams params;
  params.mode = ShadingMode::kLevel;
  params.supersampling = 1;
  const auto plain = renderPicture(surface, camera, RenderParams(), params);
  params.color_bar = true;
  const auto barred = renderPicture(surface, camera, RenderParams(), params);
  ASSERT_TRUE(plain && barred);
  EXPECT_EQ(pixelOf(*plain, 100, 120), pixelOf(*barred, 100, 120));
  const detail::BarLayout bar({320, 240});
  const int x = bar.left + bar.width / 2;
  const auto expectColour = [&](int y, std::uint32_t level) {
    const auto pixel = pixelOf(*barred, x, y);
    const Color colour = categoryColor(level);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(pixel[k], 255.0f * colour[k], 1.0) << level;
  };
  expectColour(bar.top + 4, 6);
  expectColour(120, 5);  // between the two, though no leaf has it
  expectColour(bar.top + bar.height - 5, 4);
}

TEST(Shading, SupersamplingSmoothsTheSilhouette) {
  const auto colours = [](const Image& image) {
    std::set<std::array<int, 3>> found;
    for (int x = 0; x < image.width; ++x) found.insert(pixelOf(image, x, 36));
    return found.size();
  };
  EXPECT_NE(pictured(ShadingMode::kShaded, 2).rgb, pictured(ShadingMode::kShaded, 1).rgb);
  EXPECT_GT(colours(pictured(ShadingMode::kLevel, 3)), colours(pictured(ShadingMode::kLevel, 1)));
}

TEST(Shading, OneAndFourThreadsGiveTheSameBytes) {
  EXPECT_EQ(pictured(ShadingMode::kShaded, 2, 1).rgb, pictured(ShadingMode::kShaded, 2, 4).rgb);
  EXPECT_EQ(pictured(ShadingMode::kMean, 2, 1).rgb, pictured(ShadingMode::kMean, 2, 4).rgb);
}

TEST(Shading, EmptySurfaceGivesABackground) {
  const auto image = renderPicture(SLIMSurface(), frontCamera(96, 72), RenderParams(), {});
  ASSERT_TRUE(image);
  EXPECT_GT(pixelOf(*image, 48, 1)[0], 240);
}

TEST(Shading, NamesBadParametersAndForeignBuffers) {
  ShadingParams params;
  params.supersampling = 0;
  EXPECT_EQ(renderPicture(SLIMSurface(), frontCamera(96, 72), RenderParams(), params).error().code,
            ErrorCode::kBadArgument);
  params = {};
  params.range = {2.0, 1.0};
  EXPECT_EQ(renderPicture(SLIMSurface(), frontCamera(96, 72), RenderParams(), params).error().code,
            ErrorCode::kBadArgument);
  params = {};
  params.percentile = 0.0;
  EXPECT_EQ(renderPicture(SLIMSurface(), frontCamera(96, 72), RenderParams(), params).error().code,
            ErrorCode::kBadArgument);
  GBuffer buffer;
  buffer.resize(10, 10);
  EXPECT_EQ(shade(buffer, frontCamera(96, 72), {}).error().code, ErrorCode::kBadArgument);
}

TEST(Png, ReadsBackWhatWasWritten) {
  if (checkImageExtension("a.png")) GTEST_SKIP() << "a build without PNG";
  const TemporaryFolder folder;
  const std::string path = folder / "a picture.png";
  const Image image = pictured(ShadingMode::kShaded);
  const Error error = savePng(path, image);
  ASSERT_FALSE(error) << error.message;
  const auto read = loadPng(path);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->width, image.width);
  EXPECT_EQ(read->height, image.height);
  EXPECT_EQ(read->rgb, image.rgb);
}

TEST(Png, UnwritablePathsAndBadFilesAreNamed) {
  if (checkImageExtension("a.png")) GTEST_SKIP() << "a build without PNG";
  const TemporaryFolder folder;
  const Image image = pictured(ShadingMode::kShaded);
  const std::string missing = folder / "no/such.png";
  const Error error = savePng(missing, image);
  EXPECT_EQ(error.code, ErrorCode::kIo);
  EXPECT_NE(error.message.find(missing), std::string::npos);
  EXPECT_FALSE(fs::exists(missing));
  EXPECT_EQ(savePng(folder / "x.png", Image()).code, ErrorCode::kBadInput);
  EXPECT_EQ(folder.numFiles(), 0u);

  const std::string truncated = folder / "truncated.png";
  ASSERT_FALSE(savePng(truncated, image));
  fs::resize_file(truncated, fs::file_size(truncated) / 2);
  EXPECT_EQ(loadPng(truncated).error().code, ErrorCode::kIo);
  EXPECT_EQ(loadPng(missing).error().code, ErrorCode::kIo);
}

}  // namespace
}  // namespace pcl_slim

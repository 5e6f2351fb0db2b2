// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "pcl_slim/render/detail/bar_text.h"
#include "pcl_slim/render/detail/ticks.h"
#include "pcl_slim/render/shading.h"
#include "shading/shading.h"
#include "unit/render/image_pixels.h"

namespace pcl_slim {
namespace {

using namespace detail;
using test::pixelOf;

Image filled(int width, int height, std::uint8_t gray) {
  Image image;
  image.width = width;
  image.height = height;
  image.rgb.assign(static_cast<std::size_t>(3) * width * height, gray);
  return image;
}

ShadingParams modeWith(ShadingMode mode, const std::string& unit = "") {
  ShadingParams params;
  params.mode = mode;
  params.unit = unit;
  return params;
}

/** Rows of the ticks' middles beside the bar. */
std::vector<double> tickRows(const Image& image, const BarLayout& at) {
  std::vector<double> rows;
  int first = -1;
  const int x = at.left + at.width + std::max(1, static_cast<int>(at.em / 14)) + 1;
  for (int y = at.top - 4; y < at.top + at.height + 4; ++y) {
    const bool dark = pixelOf(image, x, y)[0] < 100;
    if (dark && first < 0) first = y;
    if (!dark && first >= 0) {
      rows.push_back(0.5 * (first + y));
      first = -1;
    }
  }
  return rows;
}

TEST(ColorBar, TicksAreAtTheirRows) {
  const double ranges[][2] = {{-94.9, 94.9}, {0, 9.02e4}, {-0.003, 0.001}, {0.03, 0.7}};
  for (const ImageSize size : {ImageSize{400, 300}, ImageSize{800, 600}, ImageSize{4000, 3000}}) {
    for (const auto& ends : ranges) {
      const bool logarithmic = ends[0] > 0;
      const ShadingRange range{ends[0], ends[1], logarithmic};
      const ShadingParams params =
          modeWith(logarithmic ? ShadingMode::kSize : ShadingMode::kMean, "mm");
      Image image = filled(size.width, size.height, 255);
      addColorBar(params, range, image);
      const BarLayout at(size);
      ASSERT_TRUE(at.fits);
      const auto ticks = roundTicks(ends[0], ends[1], logarithmic);
      const auto rows = tickRows(image, at);
      ASSERT_EQ(rows.size(), ticks.size());
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const double tick = ticks[ticks.size() - 1 - i];
        const double share = logarithmic ? std::log(tick / ends[0]) / std::log(ends[1] / ends[0])
                                         : (tick - ends[0]) / (ends[1] - ends[0]);
        EXPECT_NEAR(rows[i], at.top + (1 - share) * at.height, 0.51);
        // The colour beside the tick is that of its number.
        const int row = std::min(at.top + at.height - 1, static_cast<int>(rows[i]));
        const auto shown = pixelOf(image, at.left + at.width / 2, row);
        const Color expected = colorOf(params, range, tick);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(shown[k], 255 * expected[k], 6);
      }
    }
  }
}

TEST(ColorBar, StaysOnItsPaperAndIsLegibleOnAnyBackground) {
  for (const ImageSize size : {ImageSize{100, 380}, ImageSize{400, 300}, ImageSize{1000, 400}}) {
    for (const auto mode : {ShadingMode::kMean, ShadingMode::kGaussian, ShadingMode::kKMax,
                            ShadingMode::kKMin, ShadingMode::kSize, ShadingMode::kError}) {
      for (const char* const unit : {"", "mm", "µm", "WWWWWWWW"}) {
        for (const std::uint8_t gray : {0, 128, 255}) {
          Image image = filled(size.width, size.height, gray);
          const ShadingRange range{mode == ShadingMode::kSize ? 1e-7 : -1.7e-7, 1.7e-7,
                                   mode == ShadingMode::kSize};
          addColorBar(modeWith(mode, unit), range, image);
          const BarLayout at(size);
          ASSERT_TRUE(at.fits);
          const auto paper = pixelOf(image, size.width - 1, at.paper_top);
          EXPECT_GE(paper[0], 0.84 * 255);
          for (int y = 0; y < size.height; ++y) {
            for (int x = 0; x < at.paper_left; ++x) ASSERT_EQ(pixelOf(image, x, y)[0], gray);
            // Text ends before the sides.
            EXPECT_EQ(pixelOf(image, size.width - 1, y), pixelOf(image, at.paper_left, y));
          }
          for (int x = 0; x < size.width; ++x) {
            ASSERT_EQ(pixelOf(image, x, at.paper_top - 1)[0], gray);
            EXPECT_EQ(pixelOf(image, x, at.paper_top)[0], x < at.paper_left ? gray : paper[0]);
          }
        }
      }
    }
  }
}

TEST(ColorBar, NeedsRoom) {
  EXPECT_EQ(colorBarShare({60, 300}), 0.0);
  EXPECT_EQ(colorBarShare({400, 120}), 0.0);
  EXPECT_GT(colorBarShare({400, 300}), 0.1);
  EXPECT_LT(colorBarShare({400, 300}), 0.25);
  EXPECT_LT(colorBarShare({4000, 3000}), 0.15);
  Image image = filled(60, 300, 7);
  const Image before = image;
  addColorBar(modeWith(ShadingMode::kMean), {-1, 1, false}, image);
  EXPECT_EQ(image.rgb, before.rgb);
}

TEST(ColorBar, NamesQuantitiesAndUnits) {
  EXPECT_EQ(barTitle(ShadingMode::kMean), "mean curvature");
  EXPECT_EQ(barTitle(ShadingMode::kKMin), "smallest curvature");
  EXPECT_EQ(barUnit(ShadingMode::kMean, "mm"), "1/mm");
  EXPECT_EQ(barUnit(ShadingMode::kGaussian, "µm"), "1/µm²");
  EXPECT_EQ(barUnit(ShadingMode::kGaussian, ""), "1/length²");
  EXPECT_EQ(barUnit(ShadingMode::kSize, "ft"), "ft");
  EXPECT_EQ(barUnit(ShadingMode::kLevel, "mm"), "");
  EXPECT_EQ(printedTick("-2e-5"), "−2·10⁻⁵");
  EXPECT_EQ(printedTick("1.5e12"), "1.5·10¹²");
  EXPECT_EQ(printedTick("-0.25"), "−0.25");
}

TEST(ColorBar, UnitsAreLettersOfLength) {
  for (const char* const unit : {"", "mm", "m", "km", "in", "ft", "µm", "\u03bcm", "nm", "Mm", "Å"})
    EXPECT_TRUE(isLengthUnit(unit)) << unit;
  for (const char* const unit :
       {"1", "m m", "m/s", "mm\n", "<b>", "\xc2", "\xb5m", "nanometres", "m²"})
    EXPECT_FALSE(isLengthUnit(unit)) << unit;
  EXPECT_FALSE(modeWith(ShadingMode::kMean, "µm").validate());
  EXPECT_TRUE(modeWith(ShadingMode::kMean, "m2").validate());
}

}  // namespace
}  // namespace pcl_slim

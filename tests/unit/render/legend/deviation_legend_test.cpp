// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/deviation_legend.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "unit/render/image_pixels.h"

namespace pcl_slim {
namespace {

using test::pixelOf;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Image grayImage(int width, int height, std::uint8_t gray) {
  Image image;
  image.width = width;
  image.height = height;
  image.rgb.assign(static_cast<std::size_t>(3) * width * height, gray);
  return image;
}

int saturation(const std::array<int, 3>& pixel) {
  return *std::max_element(pixel.begin(), pixel.end()) -
         *std::min_element(pixel.begin(), pixel.end());
}

TEST(DeviationScale, EndsAtTheRoundedQuantile) {
  std::vector<double> deviations;
  for (int i = 0; i <= 100; ++i) deviations.push_back((i % 2 == 0 ? 0.01 : -0.01) * i);
  deviations.push_back(kNan);
  EXPECT_DOUBLE_EQ(deviationScaleOf(deviations, 0.0).range, 1.0);   // of .95
  EXPECT_DOUBLE_EQ(deviationScaleOf({0.0, 0.12}, 0.0).range, 1.0);  // of 0: nothing to show
  EXPECT_DOUBLE_EQ(deviationScaleOf({-0.12, 0.12}, 0.0).range, 0.15);
  EXPECT_DOUBLE_EQ(deviationScaleOf({-0.12, 0.12}, 0.3).range, 0.7);  // twice the level
  EXPECT_DOUBLE_EQ(deviationScaleOf({}, 0.0).range, 1.0);
  EXPECT_DOUBLE_EQ(deviationScaleOf({-2e-7, -2e-7}, 0.0).range, 2e-7);
  EXPECT_DOUBLE_EQ(deviationScaleOf({-70.0, 70.0}, 0.0).range, 70.0);
  EXPECT_FALSE(deviationScaleOf({}, 1.0, "mm").validate());
  EXPECT_TRUE((DeviationScale{0.0, 0.0, ""}.validate()));
  EXPECT_TRUE((DeviationScale{1.0, -1.0, ""}.validate()));
  EXPECT_TRUE((DeviationScale{1.0, 0.0, "<b>"}.validate()));
}

TEST(DeviationScale, ColoursTellSignSizeAndGreysApart) {
  const DeviationScale scale{2.0, 0.1, ""};
  for (const double size : {0.1, 0.5, 1.0, 2.0, 50.0}) {
    const auto up = bytesOf(deviationColor(scale, size)),
               down = bytesOf(deviationColor(scale, -size));
    EXPECT_GT(up[0], up[2] + 40) << size;      // red above the reference
    EXPECT_GT(down[2], down[0] + 40) << size;  // blue below it
  }
  EXPECT_EQ(deviationColor(scale, 2.0), deviationColor(scale, 3.0));
  const auto lightness = [](const Color& c) { return c[0] + c[1] + c[2]; };
  EXPECT_GT(lightness(deviationColor(scale, 0.2)), lightness(deviationColor(scale, 1.9)));
  for (const Color& grey : {insignificantColor(), noCounterpartColor()}) {
    const auto bytes = bytesOf(grey);
    EXPECT_LT(saturation({bytes[0], bytes[1], bytes[2]}), 12);
  }
  EXPECT_GT(lightness(insignificantColor()), lightness(noCounterpartColor()) + 1.0f);
}

/** Rows of the picture's column x whose colour is saturated, neutral light and neutral dark. */
struct Column {
  int colored = 0, light = 0, first = -1, last = -1;

  Column(const Image& image, int x) {
    for (int y = 0; y < image.height; ++y) {
      const auto pixel = pixelOf(image, x, y);
      if (saturation(pixel) < 40) continue;
      first = first < 0 ? y : first;
      last = y;
      ++colored;
    }
    const auto grey = bytesOf(insignificantColor());
    for (int y = first; y >= 0 && y <= last; ++y)
      light += pixelOf(image, x, y)[0] == grey[0] && pixelOf(image, x, y)[1] == grey[1];
  }
};

TEST(DeviationLegend, LevelsArePrintedWithTwoDigits) {
  EXPECT_EQ(levelText({1.0, 0.12345, ""}), "±0.12 (median)");
  EXPECT_EQ(levelText({1.0, 4.149e-5, ""}), "±4.1·10⁻⁵ (median)");
  EXPECT_EQ(levelText({1.0, 0.0, ""}), "±0 (median)");
}

TEST(DeviationLegend, GreyBandIsTheLevelOfDetection) {
  for (const ImageSize size : {ImageSize{640, 480}, ImageSize{800, 600}, ImageSize{2000, 1500}}) {
    const double share = deviationLegendShare(size);
    ASSERT_GT(share, 0.0);
    ASSERT_LT(share, 0.45);
    for (const double level : {0.0, 0.25, 0.5}) {
      Image image = grayImage(size.width, size.height, 128);
      addDeviationLegend({1.0, level, "mm"}, image);
      const int left = static_cast<int>(std::lround((1.0 - share) * size.width));
      const int em = static_cast<int>(0.0 + (size.width - left) / 11.0);
      const Column column(image, left + static_cast<int>(1.2 * em));
      ASSERT_GT(column.colored, 20);
      const int height = column.last - column.first + 1;
      EXPECT_NEAR(column.light, level * height, 2.0) << size.width << " " << level;
      // Red is above, blue below.
      const auto top = pixelOf(image, left + static_cast<int>(1.2 * em), column.first),
                 bottom = pixelOf(image, left + static_cast<int>(1.2 * em), column.last);
      EXPECT_GT(top[0], top[2]);
      EXPECT_GT(bottom[2], bottom[0]);
      for (int y = 0; y < size.height; ++y) {
        ASSERT_EQ(pixelOf(image, left - 1, y), (std::array<int, 3>{128, 128, 128}));
      }
    }
  }
}

TEST(DeviationLegend, DrawsNothingWithoutRoom) {
  for (const ImageSize size : {ImageSize{120, 90}, ImageSize{40, 400}, ImageSize{1, 1}}) {
    EXPECT_EQ(deviationLegendShare(size), 0.0);
    Image image = grayImage(size.width, size.height, 77);
    const Image before = image;
    addDeviationLegend({1.0, 0.1, ""}, image);
    EXPECT_EQ(image.rgb, before.rgb);
  }
}

}  // namespace
}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "text/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace pcl_slim::detail {
namespace {

constexpr Color kBlack{0.0f, 0.0f, 0.0f};

Image whitePaper(int width, int height) {
  Image image;
  image.width = width;
  image.height = height;
  image.rgb.assign(static_cast<std::size_t>(3) * width * height, 255);
  return image;
}

/** How much ink a text takes, pixels, and between which of them it is. */
struct Ink {
  double area = 0;
  int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;

  explicit Ink(const Image& image) {
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const int gray = image.rgb[static_cast<std::size_t>(3) * (y * image.width + x)];
        if (gray == 255) continue;
        area += (255 - gray) / 255.0;
        left = std::min(left, x);
        right = std::max(right, x);
        top = std::min(top, y);
        bottom = std::max(bottom, y);
      }
    }
  }
};

Ink inkOf(const std::string& text, double em, double x = 20.0, double baseline = 100.0) {
  Image image = whitePaper(40 + static_cast<int>(1.2 * em), 110 + static_cast<int>(0.4 * em));
  drawText(image, x, baseline, em, text, kBlack);
  return Ink(image);
}

std::vector<std::string> allLetters() {
  std::vector<std::string> letters;
  for (char c = 33; c < 127; ++c) letters.emplace_back(1, c);
  for (const char* const letter : {"°", "±", "²", "³", "µ", "·", "¹", "Å", "Ω", "×",
                                   "⁰", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹", "⁻", "−", "\u03bc"})
    letters.emplace_back(letter);
  return letters;
}

TEST(Text, EveryLetterIsInsideItsBoxAtEverySize) {
  for (const std::string& letter : allLetters()) {
    for (const double em : {11.0, 13.5, 65.0}) {
      const Ink ink = inkOf(letter, em);
      const double width = textWidth(letter, em);
      SCOPED_TRACE(letter + " at " + std::to_string(em));
      ASSERT_GE(ink.right, 0);
      EXPECT_GE(ink.left, 20.0 - 0.1 * em - 1);
      EXPECT_LE(ink.right, 20.0 + width + 0.1 * em);
      EXPECT_GE(ink.top, 100.0 - 1.0 * em);
      EXPECT_LE(ink.bottom, 100.0 + 0.3 * em);
    }
  }
}

TEST(Text, EveryLetterCoversItsAreaWhereverItIs) {
  // Shifted by a fraction of a pixel and scaled, it covers the same share of its em: nothing is cut.
  for (const std::string& letter : allLetters()) {
    const double exact = inkOf(letter, 96.0).area / (96.0 * 96.0);
    for (const double em : {11.0, 24.0}) {
      for (const double shift : {0.0, 0.3, 0.77}) {
        const double area = inkOf(letter, em, 20 + shift, 100 + shift).area / (em * em);
        // Pixels are rounded to 255 steps: half a step for each on the outline.
        EXPECT_NEAR(area, exact, 0.01 * exact + 0.15 / em / 11.0) << letter << " " << em;
      }
    }
  }
}

TEST(Text, ARectangleCoversExactlyItsPixels) {
  // The minus sign is a bar from 217 to 1499, 557 to 727 of 2048 units: here a unit is 1/16 pixel.
  const Ink ink = inkOf("−", 128.0, 20.0, 100.0);
  EXPECT_EQ(ink.left, 20 + 217 / 16);
  EXPECT_EQ(ink.right, 20 + 1499 / 16);
  EXPECT_EQ(ink.top, 100 - 1 - 727 / 16);
  EXPECT_EQ(ink.bottom, 100 - 1 - 557 / 16);
  EXPECT_NEAR(ink.area, (1499 - 217) * (727 - 557) / 256.0, 1.0);
}

TEST(Text, HolesStayOpen) {
  const Image image = [] {
    Image paper = whitePaper(160, 160);
    drawText(paper, 20, 120, 128, "0", kBlack);
    return paper;
  }();
  const Ink ink(image);
  const int x = (ink.left + ink.right) / 2, y = (ink.top + ink.bottom) / 2;
  EXPECT_EQ(image.rgb[static_cast<std::size_t>(3) * (y * image.width + x)], 255);
  EXPECT_EQ(image.rgb[static_cast<std::size_t>(3) * (y * image.width + ink.left + 4)], 0);
}

TEST(Text, WidthsAddUp) {
  EXPECT_NEAR(textWidth("ab", 20), textWidth("a", 20) + textWidth("b", 20), 1e-9);
  EXPECT_NEAR(textWidth("1/mm²", 40), 2 * textWidth("1/mm²", 20), 1e-9);
  EXPECT_LT(textWidth("²", 20), textWidth("2", 20));
  EXPECT_EQ(textWidth("", 20), 0);
  EXPECT_EQ(inkOf(" ", 20).area, 0);
}

TEST(Text, LettersThatAreNoneAreQuestionMarks) {
  const double mark = textWidth("?", 20);
  EXPECT_NEAR(textWidth("漢", 20), mark, 1e-9);
  EXPECT_NEAR(textWidth("\xff", 20), mark, 1e-9);
  EXPECT_NEAR(textWidth("a\xc2", 20), textWidth("a", 20) + mark, 1e-9);
}

TEST(Text, OutsideOfThePictureNothingIsDrawn) {
  Image image = whitePaper(20, 20);
  for (const double x : {-500.0, -6.0, 14.0, 400.0}) {
    for (const double y : {-300.0, 2.0, 26.0, 900.0}) drawText(image, x, y, 20, "W", kBlack);
  }
  const Ink ink(image);
  EXPECT_GT(ink.area, 0);  // what crosses a side is drawn inside
  EXPECT_EQ(image.rgb.size(), 3u * 20 * 20);
}

}  // namespace
}  // namespace pcl_slim::detail

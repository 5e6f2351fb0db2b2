// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/core/cielab.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace pcl_slim {
namespace {

double distance(const std::array<double, 3>& a, const float b[3]) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

TEST(CieLab, MeetsPublishedValuesOfSrgb) {
  // D65, 2 degrees, as colour handbooks print them.
  const struct {
    std::array<double, 3> rgb, lab;
  } known[] = {{{1, 0, 0}, {53.24, 80.09, 67.20}},   {{0, 1, 0}, {87.73, -86.18, 83.18}},
               {{0, 0, 1}, {32.30, 79.19, -107.86}}, {{1, 1, 0}, {97.14, -21.55, 94.48}},
               {{0, 1, 1}, {91.11, -48.09, -14.13}}, {{1, 0, 1}, {60.32, 98.23, -60.82}},
               {{1, 1, 1}, {100.0, 0.0, 0.0}},       {{0, 0, 0}, {0.0, 0.0, 0.0}},
               {{0.5, 0.5, 0.5}, {53.389, 0.0, 0.0}}};
  for (const auto& colour : known) {
    const auto lab = labFromRgb(colour.rgb);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(lab[k], colour.lab[k], 0.02) << k;
  }
}

TEST(CieLab, PaperSpaceTakesNumbersAsLinear) {
  const auto grey = labFromRgb({0.5, 0.5, 0.5}, RgbSpace::kEbu);
  EXPECT_NEAR(grey[0], 116.0 * std::cbrt(0.5) - 16.0, 1e-9);
  EXPECT_NEAR(grey[1], 0.0, 1e-9);
  EXPECT_NEAR(grey[2], 0.0, 1e-9);
  const auto red = labFromRgb({1, 0, 0}, RgbSpace::kEbu);
  EXPECT_NEAR(red[0], 116.0 * std::cbrt(0.2219) - 16.0, 1e-9);
  EXPECT_NEAR(red[1], 500.0 * (std::cbrt(0.4303 / 0.9503) - std::cbrt(0.2219)), 1e-9);
  EXPECT_NEAR(red[2], 200.0 * (std::cbrt(0.2219) - std::cbrt(0.0202 / 1.0891)), 1e-9);
}

TEST(CieLab, HasNoJumpWhereTheCurvesMeet) {
  // Y of a grey passes the threshold here.
  const double at = 216.0 / 24389.0;
  const auto below =
      labFromRgb({at * (1 - 1e-9), at * (1 - 1e-9), at * (1 - 1e-9)}, RgbSpace::kEbu);
  const auto above =
      labFromRgb({at * (1 + 1e-9), at * (1 + 1e-9), at * (1 + 1e-9)}, RgbSpace::kEbu);
  EXPECT_NEAR(below[0], 8.0, 1e-6);
  EXPECT_NEAR(above[0] - below[0], 0.0, 1e-6);
}

TEST(CieLab, InverseGivesTheColourBack) {
  for (const RgbSpace space : {RgbSpace::kSrgb, RgbSpace::kEbu}) {
    for (int i = 0; i < 11 * 11 * 11; ++i) {
      const std::array<double, 3> rgb = {i % 11 / 10.0, i / 11 % 11 / 10.0, i / 121 / 10.0};
      const auto again = rgbFromLab(labFromRgb(rgb, space), space);
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(again[k], rgb[k], 1e-6);
    }
  }
  const auto outside = rgbFromLab({50.0, 200.0, -300.0});
  for (const double c : outside) EXPECT_TRUE(c >= 0.0 && c <= 1.0);
}

TEST(CieLab, TablesKeepTheirBound) {
  for (const RgbSpace space : {RgbSpace::kSrgb, RgbSpace::kEbu}) {
    const LabTable table(space);
    double worst = 0.0;
    int worst_step = 0;
    for (int r = 0; r < 256; r += 5) {
      for (int g = 0; g < 256; g += 3) {
        for (int b = 0; b < 256; b += 5) {
          float lab[3];
          table.convert(static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(g),
                        static_cast<std::uint8_t>(b), lab);
          worst =
              std::max(worst, distance(labFromRgb({r / 255.0, g / 255.0, b / 255.0}, space), lab));
          const auto again = table.rgb(lab);
          worst_step = std::max(
              {worst_step, std::abs(again[0] - r), std::abs(again[1] - g), std::abs(again[2] - b)});
        }
      }
    }
    EXPECT_LT(worst, LabTable::kMaxDeltaE);
    EXPECT_GT(worst, LabTable::kMaxDeltaE / 10) << "the stated bound says nothing";
    EXPECT_LE(worst_step, 1);
  }
}

TEST(LabTable, ColumnsAgreeWithTheExactConversion) {
  for (const RgbSpace space : {RgbSpace::kSrgb, RgbSpace::kEbu}) {
    const LabTable table(space);
    double worst = 0;
    for (int red = 0; red < 256; red += 3) {
      constexpr std::size_t kCount = 18 * 18;
      alignas(64) float columns[3][(kCount + 15) / 16 * 16];
      std::vector<std::array<int, 3>> colours;
      for (int green = 0; green < 256; green += 15) {
        for (int blue = 0; blue < 256; blue += 15) colours.push_back({red, green, blue});
      }
      ASSERT_EQ(colours.size(), kCount);
      for (std::size_t i = 0; i < kCount; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
          columns[c][i] = table.linear(static_cast<std::uint8_t>(colours[i][c]));
        }
      }
      table.labOfLinear(columns[0], columns[1], columns[2], kCount);
      for (std::size_t i = 0; i < kCount; ++i) {
        const auto exact = labFromRgb(
            {colours[i][0] / 255.0, colours[i][1] / 255.0, colours[i][2] / 255.0}, space);
        const float lab[3] = {columns[0][i], columns[1][i], columns[2][i]};
        worst = std::max(worst, distance(exact, lab));
      }
    }
    EXPECT_LT(worst, LabTable::kMaxDeltaE / 4) << "Newton's steps end at a float's last bits";
  }
}

}  // namespace
}  // namespace pcl_slim

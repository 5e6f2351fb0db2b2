// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace pcl_slim::detail {

/** \brief A letter of 5 x 7 dots, rows from the top, the leftmost dot in bit 4. */
struct PixelGlyph {
  static constexpr int kWidth = 5, kHeight = 7;

  std::uint8_t rows[kHeight];

  bool dot(int column, int row) const { return (rows[row] >> (kWidth - 1 - column) & 1) != 0; }
};

/** \brief The letter for digits, signs, lower-case letters and the capitals of titles; others are blank. */
PixelGlyph
glyphOf(char c);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "pcl_slim/core/export.h"
#include "pcl_slim/render/color_map.h"
#include "pcl_slim/render/image.h"

namespace pcl_slim::detail {

/** \brief A letter's outline, in font units, y upwards from the baseline. */
struct Glyph {
  std::uint32_t letter;  ///< code point
  int advance;           ///< to the next letter
  const char* path;      ///< as SVG has it: "M x y L x y Q cx cy x y"; each part closes itself
};

extern const double kUnitsPerEm;
extern const Glyph kGlyphs[];  ///< by their letters, ascending
extern const std::size_t kNumGlyphs;

/** \brief Heights above and below the baseline between which letters and digits are [em]. */
constexpr double kCapHeight = 0.73, kDescent = 0.24;

/** \brief Width of a text [pixels]. Letters that the font lacks are as wide as "?". O(letters).
 * \param[in] text UTF-8; \param[in] em size of the font [pixels] */
double textWidth(const std::string& text, double em);

/** \brief Draws a text over a picture, each pixel as much as letters cover of its area; outside of
 * the picture nothing is drawn. O(letters * em^2).
 * \param[in] x, baseline where it begins, from the picture's upper left corner [pixels] */
void drawText(Image& image, double x, double baseline, double em, const std::string& text,
              const Color& ink);

}  // namespace pcl_slim::detail

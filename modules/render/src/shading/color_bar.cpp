// SPDX-License-Identifier: BSD-3-Clause
// Numbers as colours: the maps, the range of a picture, and its bar with numbers and unit in the
// margin.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <string>
#include <vector>

#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/render/color_map.h"
#include "pcl_slim/render/shading.h"
#include "shading/shading.h"

namespace pcl_slim {
namespace {

/** \brief Linear interpolation in a table of evenly spaced colours, x in [0, 1]. */
template <std::size_t N>
Color interpolate(const std::array<Color, N>& table, double x) {
  const double position = std::clamp(std::isnan(x) ? 0.0 : x, 0.0, 1.0) * (N - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(position), N - 2);
  const auto t = static_cast<float>(position - static_cast<double>(i));
  Color color;
  for (std::size_t k = 0; k < 3; ++k) color[k] = table[i][k] + t * (table[i + 1][k] - table[i][k]);
  return color;
}

}  // namespace

Color divergingColor(double x) {
  static constexpr std::array<Color, 7> kTable{{{0.10f, 0.20f, 0.56f},
                                                {0.22f, 0.46f, 0.80f},
                                                {0.60f, 0.76f, 0.92f},
                                                {0.93f, 0.92f, 0.90f},
                                                {0.97f, 0.70f, 0.54f},
                                                {0.84f, 0.33f, 0.25f},
                                                {0.52f, 0.06f, 0.14f}}};
  return interpolate(kTable, 0.5 + 0.5 * x);
}

Color perceptualColor(double x) {
  // Lightness rises evenly from 15 to 91 (CIE L*).
  static constexpr std::array<Color, 7> kTable{{{0.16f, 0.08f, 0.36f},
                                                {0.18f, 0.25f, 0.51f},
                                                {0.14f, 0.41f, 0.55f},
                                                {0.12f, 0.55f, 0.53f},
                                                {0.31f, 0.69f, 0.42f},
                                                {0.65f, 0.80f, 0.27f},
                                                {0.98f, 0.90f, 0.35f}}};
  return interpolate(kTable, x);
}

Color sizeColor(double x) {
  static constexpr std::array<Color, 5> kTable{{{0.80f, 0.16f, 0.15f},
                                                {0.95f, 0.62f, 0.22f},
                                                {0.88f, 0.86f, 0.52f},
                                                {0.40f, 0.70f, 0.62f},
                                                {0.18f, 0.34f, 0.70f}}};
  return interpolate(kTable, x);
}

Color categoryColor(std::uint32_t category) {
  static constexpr std::array<Color, 10> kTable{{{0.27f, 0.47f, 0.72f},
                                                 {0.93f, 0.55f, 0.24f},
                                                 {0.36f, 0.66f, 0.38f},
                                                 {0.82f, 0.30f, 0.32f},
                                                 {0.57f, 0.44f, 0.73f},
                                                 {0.58f, 0.43f, 0.36f},
                                                 {0.88f, 0.52f, 0.74f},
                                                 {0.52f, 0.54f, 0.56f},
                                                 {0.74f, 0.73f, 0.28f},
                                                 {0.28f, 0.71f, 0.78f}}};
  return kTable[category % kTable.size()];
}

namespace {

/** \brief The level at a share of a range of levels. */
std::uint32_t levelAtShare(const ShadingRange& range, double share) {
  const double level = range.low + share * (range.high - range.low);
  return static_cast<std::uint32_t>(std::lround(std::max(0.0, level)));
}

/** \brief The colour of a share of the range, 0 its lower end. */
Color colorAtShare(const ShadingParams& params, const ShadingRange& range, double share) {
  if (params.mode == ShadingMode::kLevel) return categoryColor(levelAtShare(range, share));
  if (params.map == ColorMap::kPerceptual) return perceptualColor(share);
  if (params.map == ColorMap::kDiverging) return divergingColor(2.0 * share - 1.0);
  if (params.mode == ShadingMode::kSize) return sizeColor(share);
  if (params.mode == ShadingMode::kError) return perceptualColor(share);
  return divergingColor(2.0 * share - 1.0);
}

}  // namespace

namespace detail {

double valueAt(const GBuffer& buffer, std::size_t pixel, ShadingMode mode, double scale) {
  switch (mode) {
    case ShadingMode::kMean: return buffer.mean_curvature[pixel] / scale;
    case ShadingMode::kGaussian: return buffer.gaussian_curvature[pixel] / (scale * scale);
    case ShadingMode::kKMax: return buffer.principal[pixel][0] / scale;
    case ShadingMode::kKMin: return buffer.principal[pixel][1] / scale;
    case ShadingMode::kError: return buffer.residual[pixel] * scale;
    default: return buffer.radius[pixel] * scale;
  }
}

Color colorOf(const ShadingParams& params, const ShadingRange& range, double value) {
  double low = range.low, high = range.high;
  if (range.logarithmic) {
    low = std::log(low);
    high = std::log(high);
    value = std::log(value);
  }
  return colorAtShare(params, range, high > low ? (value - low) / (high - low) : 0.5);
}

bool wantsAmbientOcclusion(const ShadingParams& params) {
  return params.ambient_occlusion > 0.0 && params.lighting && params.mode != ShadingMode::kNormal &&
         params.mode != ShadingMode::kReflection;
}

}  // namespace detail

namespace {

/** \brief The value below which a share of the values is; 0 when there are none. */
double quantile(const std::vector<double>& values, double share) {
  if (values.empty()) return 0.0;
  return kthSmallest(values,
                     static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

/** \brief Whether a mode's values come with both signs, so that 0 is the middle of their colours.
 */
bool isSigned(ShadingMode mode) {
  return mode != ShadingMode::kSize && mode != ShadingMode::kError;
}

/** \brief The range of a picture's values, but for outliers. */
void setRobustRange(const GBuffer& buffer, const ShadingParams& params, double scale,
                    ShadingRange& range) {
  std::vector<double> values;
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    if (!buffer.covered(i)) continue;
    const double value = detail::valueAt(buffer, i, params.mode, scale);
    values.push_back(isSigned(params.mode) ? std::abs(value) : value);
  }
  if (values.empty()) return;
  if (range.logarithmic) {
    range.low = quantile(values, 0.02);
    range.high = quantile(values, 0.98);
    return;
  }
  const double size = quantile(values, params.percentile);
  range.high = size > 0.0 ? size : 1.0;
  range.low = isSigned(params.mode) ? -range.high : 0.0;
}

/** \brief Half a level past those that a picture shows; level 1 if it shows none. */
ShadingRange levelsOf(const GBuffer& buffer) {
  ShadingRange range{HUGE_VAL, -HUGE_VAL, false};
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    if (!buffer.covered(i)) continue;
    range.low = std::min(range.low, buffer.level[i] - 0.5);
    range.high = std::max(range.high, buffer.level[i] + 0.5);
  }
  return range.low < range.high ? range : ShadingRange{0.5, 1.5, false};
}

}  // namespace

bool hasColorBar(ShadingMode mode) {
  return showsNumbers(mode) || mode == ShadingMode::kLevel;
}

bool showsNumbers(ShadingMode mode) {
  switch (mode) {
    case ShadingMode::kMean:
    case ShadingMode::kGaussian:
    case ShadingMode::kKMax:
    case ShadingMode::kKMin:
    case ShadingMode::kSize:
    case ShadingMode::kError: return true;
    default: return false;
  }
}

unsigned columnsFor(const ShadingParams& params) {
  unsigned columns = 0;
  if (detail::wantsAmbientOcclusion(params)) columns |= kPositionColumn;
  switch (params.mode) {
    case ShadingMode::kMean:
    case ShadingMode::kGaussian:
    case ShadingMode::kKMax:
    case ShadingMode::kKMin: return columns | kCurvatureColumn;
    case ShadingMode::kLevel:
    case ShadingMode::kSize: return columns | kLeafColumns;
    case ShadingMode::kError: return columns | kResidualColumn;
    case ShadingMode::kColor: return columns | kColorColumn;
    default: return columns;
  }
}

ShadingRange rangeOf(const GBuffer& buffer, const ShadingParams& params, double scale) {
  ShadingRange range;
  range.logarithmic = params.mode == ShadingMode::kSize;
  if (range.logarithmic) range.low = 0.5;
  if (params.mode == ShadingMode::kLevel) return levelsOf(buffer);
  if (!showsNumbers(params.mode)) return range;
  if (params.range[0] < params.range[1]) {
    range.low = params.range[0];
    range.high = params.range[1];
  } else {
    setRobustRange(buffer, params, scale, range);
  }
  return range;
}

using namespace detail;
namespace {

/** \brief A letter of 5 x 7 dots, rows from the top, the leftmost dot in bit 4. */
struct PixelGlyph {
  static constexpr int kWidth = 5, kHeight = 7;

  std::uint8_t rows[kHeight];

  bool dot(int column, int row) const { return (rows[row] >> (kWidth - 1 - column) & 1) != 0; }
};

/** \brief The letter for digits, signs, lower-case letters and the capitals of titles; others are
 * blank. */
PixelGlyph glyphOf(char c) {
  struct Entry {
    char letter;
    PixelGlyph glyph;
  };
  static constexpr Entry kGlyphs[] = {
      {'0', {{0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e}}},
      {'1', {{0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e}}},
      {'2', {{0x0e, 0x11, 0x01, 0x06, 0x08, 0x10, 0x1f}}},
      {'3', {{0x1e, 0x01, 0x01, 0x0e, 0x01, 0x01, 0x1e}}},
      {'4', {{0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02}}},
      {'5', {{0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e}}},
      {'6', {{0x06, 0x08, 0x10, 0x1e, 0x11, 0x11, 0x0e}}},
      {'7', {{0x1f, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08}}},
      {'8', {{0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e}}},
      {'9', {{0x0e, 0x11, 0x11, 0x0f, 0x01, 0x02, 0x0c}}},
      {'.', {{0x00, 0x00, 0x00, 0x00, 0x00, 0x0c, 0x0c}}},
      {'-', {{0x00, 0x00, 0x00, 0x1f, 0x00, 0x00, 0x00}}},
      {'+', {{0x00, 0x04, 0x04, 0x1f, 0x04, 0x04, 0x00}}},
      {'/', {{0x01, 0x01, 0x02, 0x04, 0x08, 0x10, 0x10}}},
      {'^', {{0x04, 0x0a, 0x11, 0x00, 0x00, 0x00, 0x00}}},
      {'a', {{0x00, 0x00, 0x0e, 0x01, 0x0f, 0x11, 0x0f}}},
      {'b', {{0x10, 0x10, 0x16, 0x19, 0x11, 0x19, 0x16}}},
      {'c', {{0x00, 0x00, 0x0e, 0x10, 0x10, 0x11, 0x0e}}},
      {'d', {{0x01, 0x01, 0x0d, 0x13, 0x11, 0x13, 0x0d}}},
      {'e', {{0x00, 0x00, 0x0e, 0x11, 0x1f, 0x10, 0x0e}}},
      {'f', {{0x06, 0x09, 0x08, 0x1c, 0x08, 0x08, 0x08}}},
      {'g', {{0x00, 0x0f, 0x11, 0x11, 0x0f, 0x01, 0x0e}}},
      {'h', {{0x10, 0x10, 0x16, 0x19, 0x11, 0x11, 0x11}}},
      {'i', {{0x04, 0x00, 0x0c, 0x04, 0x04, 0x04, 0x0e}}},
      {'j', {{0x02, 0x00, 0x06, 0x02, 0x02, 0x12, 0x0c}}},
      {'k', {{0x10, 0x10, 0x12, 0x14, 0x18, 0x14, 0x12}}},
      {'l', {{0x0c, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0e}}},
      {'m', {{0x00, 0x00, 0x1a, 0x15, 0x15, 0x15, 0x15}}},
      {'n', {{0x00, 0x00, 0x16, 0x19, 0x11, 0x11, 0x11}}},
      {'o', {{0x00, 0x00, 0x0e, 0x11, 0x11, 0x11, 0x0e}}},
      {'p', {{0x00, 0x1e, 0x11, 0x11, 0x1e, 0x10, 0x10}}},
      {'q', {{0x00, 0x0d, 0x13, 0x0f, 0x01, 0x01, 0x01}}},
      {'r', {{0x00, 0x00, 0x16, 0x19, 0x10, 0x10, 0x10}}},
      {'s', {{0x00, 0x00, 0x0f, 0x10, 0x0e, 0x01, 0x1e}}},
      {'t', {{0x08, 0x08, 0x1c, 0x08, 0x08, 0x09, 0x06}}},
      {'u', {{0x00, 0x00, 0x11, 0x11, 0x11, 0x13, 0x0d}}},
      {'v', {{0x00, 0x00, 0x11, 0x11, 0x11, 0x0a, 0x04}}},
      {'w', {{0x00, 0x00, 0x11, 0x11, 0x15, 0x15, 0x0a}}},
      {'x', {{0x00, 0x00, 0x11, 0x0a, 0x04, 0x0a, 0x11}}},
      {'y', {{0x00, 0x11, 0x11, 0x0f, 0x01, 0x11, 0x0e}}},
      {'z', {{0x00, 0x00, 0x1f, 0x02, 0x04, 0x08, 0x1f}}},
      {'G', {{0x0e, 0x11, 0x10, 0x17, 0x11, 0x11, 0x0e}}},
  };
  const auto found = std::find_if(std::begin(kGlyphs), std::end(kGlyphs),
                                  [c](const Entry& entry) { return entry.letter == c; });
  return found == std::end(kGlyphs) ? PixelGlyph{} : found->glyph;
}

/** \brief Places and sizes in pixels. */
struct BarLayout {
  int letter;  ///< pixels a dot of the font
  int left, top, width, height;

  BarLayout(int image_width, int image_height)
      : letter(std::max(1, image_height / 480)),
        left(image_width - letter * 78),
        top(image_height / 5),
        width(letter * 14),
        height(image_height - 2 * (image_height / 5)) {}

  int pad() const { return 4 * letter; }
  bool fits() const { return left >= 3 * pad() && height >= 40 * letter; }
};

void paint(Image& image, int x, int y, const Color& color, float share) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height) return;
  const std::size_t at = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                              static_cast<std::size_t>(x));
  for (std::size_t k = 0; k < 3; ++k) {
    const float mixed = (1.0f - share) * image.rgb[at + k] + share * 255.0f * color[k];
    image.rgb[at + k] = static_cast<std::uint8_t>(std::lround(mixed));
  }
}

void paintText(Image& image, int x, int y, int letter, const std::string& text) {
  constexpr Color kInk{0.1f, 0.1f, 0.1f};
  for (const char c : text) {
    const PixelGlyph glyph = glyphOf(c);
    for (int row = 0; row < PixelGlyph::kHeight * letter; ++row) {
      for (int column = 0; column < PixelGlyph::kWidth * letter; ++column) {
        if (glyph.dot(column / letter, row / letter)) paint(image, x + column, y + row, kInk, 1.0f);
      }
    }
    x += (PixelGlyph::kWidth + 1) * letter;
  }
}

std::string numberText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string titleOf(ShadingMode mode) {
  switch (mode) {
    case ShadingMode::kMean: return "mean";
    case ShadingMode::kGaussian: return "Gauss";
    case ShadingMode::kKMax: return "k max";
    case ShadingMode::kKMin: return "k min";
    case ShadingMode::kError: return "residual";
    case ShadingMode::kLevel: return "level";
    default: return "radius";
  }
}

std::string unitOf(const ShadingParams& params) {
  std::string length = params.unit.empty() ? "length" : params.unit;
  switch (params.mode) {
    case ShadingMode::kGaussian: return "1/" + length + "^2";
    case ShadingMode::kSize:
    case ShadingMode::kError: return length;
    case ShadingMode::kLevel: return "";
    default: return "1/" + length;
  }
}

constexpr int kLine = PixelGlyph::kHeight + 3;  ///< dots from one line of text to the next
constexpr Color kFrame{0.25f, 0.25f, 0.25f};

/** \brief Makes the picture paler behind the bar and its text. */
void paintPaper(const BarLayout& at, Image& image) {
  constexpr Color kPaper{1.0f, 1.0f, 1.0f};
  const int line = kLine * at.letter, pad = at.pad();
  for (int y = at.top - 3 * line - pad; y < at.top + at.height + line; ++y) {
    for (int x = at.left - pad; x < image.width - at.letter; ++x) paint(image, x, y, kPaper, 0.8f);
  }
}

void paintColors(const BarLayout& at, const ShadingParams& params, const ShadingRange& range,
                 Image& image) {
  for (int y = 0; y < at.height; ++y) {
    const Color color = colorAtShare(params, range, 1.0 - (y + 0.5) / at.height);
    for (int x = 0; x < at.width; ++x) {
      const bool rim = x == 0 || y == 0 || x + 1 == at.width || y + 1 == at.height;
      paint(image, at.left + x, at.top + y, rim ? kFrame : color, 1.0f);
    }
  }
}

void paintTick(const BarLayout& at, const std::string& number, double share, Image& image) {
  const int y = at.top + static_cast<int>(std::lround((1.0 - share) * (at.height - 1)));
  const int right = at.left + at.width;
  for (int x = 0; x < 3 * at.letter; ++x) paint(image, right + x, y, kFrame, 1.0f);
  paintText(image, right + 5 * at.letter, y - 3 * at.letter, at.letter, number);
}

/** \brief Five numbers, evenly spaced. */
void paintNumbers(const BarLayout& at, const ShadingRange& range, Image& image) {
  constexpr int kTicks = 5;
  for (int tick = 0; tick < kTicks; ++tick) {
    const double share = tick / (kTicks - 1.0);
    const double value = range.logarithmic ? range.low * std::pow(range.high / range.low, share)
                                           : range.low + share * (range.high - range.low);
    paintTick(at, numberText(value), share, image);
  }
}

/** \brief Numbers in the middle of each level's colour, at most ten. */
void paintLevels(const BarLayout& at, const ShadingRange& range, Image& image) {
  constexpr int kMostNumbers = 10;
  const int count = static_cast<int>(std::lround(range.high - range.low));
  const int step = (count + kMostNumbers - 1) / kMostNumbers;
  for (int i = 0; i < count; i += step) {
    const double share = (i + 0.5) / count;
    paintTick(at, std::to_string(levelAtShare(range, share)), share, image);
  }
}

}  // namespace

double colorBarShare(const ImageSize& size) {
  const BarLayout at(size.width, size.height);
  return at.fits() ? static_cast<double>(size.width - at.left + at.pad()) / size.width : 0.0;
}

void addColorBar(const ShadingParams& params, const ShadingRange& range, Image& image) {
  const BarLayout at(image.width, image.height);
  if (!hasColorBar(params.mode) || !at.fits()) return;
  paintPaper(at, image);
  paintColors(at, params, range, image);
  const bool levels = params.mode == ShadingMode::kLevel;
  (levels ? paintLevels : paintNumbers)(at, range, image);
  const int line = kLine * at.letter;
  paintText(image, at.left, at.top - 3 * line + at.pad(), at.letter, titleOf(params.mode));
  paintText(image, at.left, at.top - 2 * line + at.pad(), at.letter, unitOf(params));
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// The colours of a picture with their numbers and unit, in its right margin.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/render/detail/bar_text.h"
#include "pcl_slim/render/detail/ticks.h"
#include "pcl_slim/render/shading.h"
#include "shading/shading.h"
#include "text/text.h"

namespace pcl_slim {
namespace detail {

bool isLengthUnit(const std::string& unit) {
  constexpr int kMostLetters = 8;
  // In UTF-8, the micro sign as keyboards have it and as Greek has it, and the angstrom.
  static const std::string kLetters[] = {"\u00b5", "\u03bc", "\u00c5"};
  int letters = 0;
  for (std::size_t i = 0; i < unit.size(); ++letters) {
    const char c = unit[i];
    if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z')) {
      ++i;
      continue;
    }
    const auto found = std::find_if(std::begin(kLetters), std::end(kLetters), [&](const auto& l) {
      return unit.compare(i, l.size(), l) == 0;
    });
    if (found == std::end(kLetters)) return false;
    i += found->size();
  }
  return letters <= kMostLetters;
}

std::string barTitle(ShadingMode mode) {
  switch (mode) {
    case ShadingMode::kMean: return "mean curvature";
    case ShadingMode::kGaussian: return "Gaussian curvature";
    case ShadingMode::kKMax: return "largest curvature";
    case ShadingMode::kKMin: return "smallest curvature";
    case ShadingMode::kError: return "residual";
    case ShadingMode::kUncertainty: return "standard error";
    case ShadingMode::kLevel: return "level";
    default: return "radius";
  }
}

std::string barUnit(ShadingMode mode, const std::string& unit) {
  const std::string length = unit.empty() ? "length" : unit;
  switch (mode) {
    case ShadingMode::kGaussian: return "1/" + length + "²";
    case ShadingMode::kSize:
    case ShadingMode::kError:
    case ShadingMode::kUncertainty: return length;
    case ShadingMode::kLevel: return "";
    default: return "1/" + length;
  }
}

std::string printedTick(const std::string& tick) {
  static const std::string kRaised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text;
  bool power = false;
  for (const char c : tick) {
    if (c == 'e') {
      power = true;
      text += "·10";
    } else if (c == '-') {
      text += power ? "⁻" : "−";
    } else if (power && c >= '0' && c <= '9') {
      text += kRaised[c - '0'];
    } else {
      text += c;
    }
  }
  return text;
}

namespace {

constexpr double kLeastEm = 11.0;    ///< smaller letters are not legible [pixels]
constexpr double kEmsOfPage = 46.0;  ///< height of a picture, or 3/4 of its width [em]
constexpr double kPad = 0.6, kColors = 1.2, kTick = 0.3, kGap = 0.25;  ///< [em]
constexpr double kNumbers = 4.9;                                       ///< their width [em]
constexpr double kLine = 1.25;       ///< from one line of text to the next [em]
constexpr int kTitleLines = 3;       ///< a title of two words, and the unit
constexpr double kShareAbove = 0.2;  ///< of the picture, above the colours and below them

}  // namespace

BarLayout::BarLayout(const ImageSize& size)
    : em(std::max(kLeastEm,
                  std::floor(std::min<double>(size.height, 0.75 * size.width) / kEmsOfPage))),
      width(static_cast<int>(std::lround(kColors * em))) {
  const int title = static_cast<int>(std::lround((kTitleLines * kLine + 2 * kPad) * em));
  const int margin = static_cast<int>(std::lround(kShareAbove * size.height));
  top = std::max(margin, title);
  height = size.height - margin - top;
  const double right = kColors + kTick + kGap + kNumbers + kPad;
  left = size.width - static_cast<int>(std::lround(right * em));
  paper_left = left - static_cast<int>(std::lround(kPad * em));
  paper_top = top - title;
  const double least = 2.0 * kTitleLines * kLine * em;
  fits = paper_left >= 0 && height >= least;
}

void fillBox(Image& image, const PixelBox& box, const Color& color, float share) {
  for (int y = std::max(0, box.top); y < std::min(image.height, box.bottom); ++y) {
    for (int x = std::max(0, box.left); x < std::min(image.width, box.right); ++x) {
      const std::size_t at =
          3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
               static_cast<std::size_t>(x));
      for (std::size_t k = 0; k < 3; ++k) {
        const float mixed = (1.0f - share) * image.rgb[at + k] + share * 255.0f * color[k];
        image.rgb[at + k] = static_cast<std::uint8_t>(std::lround(mixed));
      }
    }
  }
}

}  // namespace detail

using namespace detail;
namespace {

/** \brief Thickness of the frame and of ticks. */
int strokeOf(const BarLayout& at) {
  return std::max(1, static_cast<int>(at.em / 14.0));
}

/** \brief Makes the picture paler behind the bar and its text. */
void paintPaper(const BarLayout& at, Image& image) {
  const int bottom = at.top + at.height + static_cast<int>(std::lround(kLine * at.em));
  fillBox(image, {at.paper_left, at.paper_top, image.width, bottom}, kBarPaper, kBarPaperShare);
}

void paintColors(const BarLayout& at, const ShadingParams& params, const ShadingRange& range,
                 Image& image) {
  const int rim = strokeOf(at), right = at.left + at.width, bottom = at.top + at.height;
  fillBox(image, {at.left - rim, at.top - rim, right + rim, bottom + rim}, kBarFrame, 1.0f);
  for (int y = 0; y < at.height; ++y) {
    const Color color = colorAtShare(params, range, 1.0 - (y + 0.5) / at.height);
    fillBox(image, {at.left, at.top + y, right, at.top + y + 1}, color, 1.0f);
  }
}

/** \brief Text that ends before the picture's side; smaller where it would not. */
void paintText(const BarLayout& at, double x, double baseline, const std::string& text,
               Image& image) {
  const double room = image.width - 0.5 * kPad * at.em - x;
  const double em = at.em * std::min(1.0, room / textWidth(text, at.em));
  drawText(image, x, std::round(baseline), em, text, kBarInk);
}

/** \brief A number at a share of the range, its middle beside the tick's. */
void paintTick(const BarLayout& at, const std::string& number, double share, Image& image) {
  const int thick = strokeOf(at);
  const double middle = at.top + (1.0 - share) * at.height;
  const int first = static_cast<int>(std::lround(middle - 0.5 * thick));
  const int right = at.left + at.width, length = static_cast<int>(std::lround(kTick * at.em));
  fillBox(image, {right, first, right + length, first + thick}, kBarFrame, 1.0f);
  paintText(at, right + (kTick + kGap) * at.em, middle + 0.5 * kCapHeight * at.em, number, image);
}

void paintNumbers(const BarLayout& at, const ShadingRange& range, Image& image) {
  const auto share = [&](double value) {
    if (!(range.high > range.low)) return 0.5;
    if (range.logarithmic) return std::log(value / range.low) / std::log(range.high / range.low);
    return (value - range.low) / (range.high - range.low);
  };
  for (const double tick : roundTicks(range.low, range.high, range.logarithmic))
    paintTick(at, printedTick(tickText(tick)), share(tick), image);
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

/** \brief The title, a word a line, and the unit, above the colours. */
void paintTitle(const BarLayout& at, const ShadingParams& params, Image& image) {
  std::vector<std::string> lines = {barTitle(params.mode)};
  const std::size_t space = lines[0].find(' ');
  if (space != std::string::npos) {
    lines.push_back(lines[0].substr(space + 1));
    lines[0].resize(space);
  }
  const std::string unit = barUnit(params.mode, params.unit);
  if (!unit.empty()) lines.push_back(unit);
  double baseline =
      at.top - 1.2 * kPad * at.em - static_cast<double>(lines.size() - 1) * kLine * at.em;
  for (const std::string& line : lines) {
    paintText(at, at.left, baseline, line, image);
    baseline += kLine * at.em;
  }
}

}  // namespace

double colorBarShare(const ImageSize& size) {
  const BarLayout at(size);
  return at.fits ? static_cast<double>(size.width - at.paper_left) / size.width : 0.0;
}

void addColorBar(const ShadingParams& params, const ShadingRange& range, Image& image) {
  const BarLayout at({image.width, image.height});
  if (!hasColorBar(params.mode) || !at.fits) return;
  paintPaper(at, image);
  paintColors(at, params, range, image);
  if (params.mode == ShadingMode::kLevel) {
    paintLevels(at, range, image);
  } else {
    paintNumbers(at, range, image);
  }
  paintTitle(at, params, image);
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
// Colours of signed distances from a reference, and their legend in a picture's right margin.
#include "pcl_slim/render/deviation_legend.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>

#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/render/detail/bar_text.h"
#include "pcl_slim/render/detail/ticks.h"
#include "shading/shading.h"
#include "text/text.h"

namespace pcl_slim {

using namespace detail;
namespace {

constexpr double kPalest = 0.22;  ///< of the diverging map: the smallest significant deviation
constexpr double kShownShare = 0.95, kLeastLevels = 2.0;

/** \brief The next number of 1, 1.5, 2, 3, 5, 7 times a power of ten. */
double roundedUp(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 5.0, 7.0}) {
    if (value <= step * decade * (1 + 1e-9)) return step * decade;
  }
  return 10.0 * decade;
}

}  // namespace

Error DeviationScale::validate() const {
  const auto bad = [](const char* what) { return Error{ErrorCode::kBadArgument, what}; };
  if (!(range > 0.0 && std::isfinite(range)))
    return bad("the range of deviations must be a finite number above 0");
  if (!(level >= 0.0 && std::isfinite(level)))
    return bad("the level of detection must be a finite number of 0 or more");
  if (!isLengthUnit(unit))
    return bad("the unit of length must be up to eight letters, such as mm, µm or ft");
  return {};
}

DeviationScale deviationScaleOf(const std::vector<double>& deviations, double level,
                                const std::string& unit) {
  std::vector<double> sizes;
  for (const double d : deviations) {
    if (std::isfinite(d)) sizes.push_back(std::abs(d));
  }
  const double shown =
      sizes.empty() ? 0.0
                    : kthSmallest(sizes, static_cast<std::size_t>(
                                             kShownShare * static_cast<double>(sizes.size() - 1)));
  const double range = std::max(shown, kLeastLevels * level);
  return {range > 0.0 ? roundedUp(range) : 1.0, level, unit};
}

Color deviationColor(const DeviationScale& scale, double deviation) {
  const double share = std::min(1.0, std::abs(deviation) / scale.range);
  return divergingColor(std::copysign(kPalest + (1.0 - kPalest) * share, deviation));
}

Color insignificantColor() {
  return {0.80f, 0.80f, 0.79f};
}

Color noCounterpartColor() {
  return {0.33f, 0.34f, 0.36f};
}

std::string levelText(const DeviationScale& scale) {
  char rounded[32];
  std::snprintf(rounded, sizeof rounded, "%.2g", scale.level);
  return "±" + printedTick(tickText(std::strtod(rounded, nullptr))) + " (median)";
}

std::array<std::uint8_t, 3> bytesOf(const Color& color) {
  std::array<std::uint8_t, 3> bytes;
  for (std::size_t k = 0; k < 3; ++k)
    bytes[k] = static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(color[k], 0.0f, 1.0f)));
  return bytes;
}

namespace {

constexpr double kWidth = 11.0, kPad = 0.6;               ///< of the paper; around its content [em]
constexpr double kColors = 1.4, kTick = 0.3, kGap = 0.3;  ///< widths of the bar and its ticks [em]
constexpr double kLine = 1.3;                             ///< height of a line of text [em]
constexpr double kLinesAbove = 2.2, kLinesBelow = 5.2;    ///< of text around the bar
constexpr double kBarShare = 0.48;                        ///< of the picture's height, at most
constexpr double kLeastBar = 6.0;                         ///< [em]
constexpr double kMostOfWidth = 0.45;                     ///< of the picture that a legend may take

/** \brief Places and sizes in pixels. */
struct LegendLayout {
  double em;
  int paper_left, left, paper_top, paper_bottom, bar_top, bar_width, bar_height;
  bool fits;

  explicit LegendLayout(const ImageSize& size) : em(BarLayout(size).em) {
    paper_left = size.width - rounded(kWidth * em);
    left = paper_left + rounded(kPad * em);
    const double text = (kLinesAbove + kLinesBelow) * kLine * em + 2 * kPad * em;
    bar_height = rounded(std::min(kBarShare * size.height, size.height - text));
    bar_width = rounded(kColors * em);
    paper_top = rounded(0.5 * (size.height - bar_height - text));
    bar_top = paper_top + rounded(kPad * em + kLinesAbove * kLine * em);
    paper_bottom = paper_top + bar_height + rounded(text);
    fits = bar_height >= kLeastBar * em && size.width - paper_left <= kMostOfWidth * size.width;
  }

  static int rounded(double value) { return static_cast<int>(std::lround(value)); }
};

class LegendPainter {
 public:
  LegendPainter(const DeviationScale& scale, Image& image)
      : scale_(scale), at_({image.width, image.height}), image_(image) {}

  void paint() {
    if (!at_.fits) return;
    fillBox(image_, {at_.paper_left, at_.paper_top, image_.width, at_.paper_bottom}, kBarPaper,
            kBarPaperShare);
    const double first = at_.paper_top + (kPad + kCapHeight) * at_.em;
    text(0.0, first, "deviation");
    text(0.0, first + kLine * at_.em, scale_.unit.empty() ? "length" : scale_.unit);
    paintBar();
    for (const double tick : roundTicks(-scale_.range, scale_.range, false)) paintTick(tick);
    paintEntries();
  }

 private:
  void text(double x, double baseline, const std::string& words) {
    const double room = image_.width - 0.5 * kPad * at_.em - at_.left - x;
    const double em = at_.em * std::min(1.0, room / textWidth(words, at_.em));
    drawText(image_, at_.left + x, std::round(baseline), em, words, kBarInk);
  }

  int stroke() const { return std::max(1, static_cast<int>(at_.em / 14.0)); }

  void framedBox(int top, int width, int height) {
    const int rim = stroke();
    fillBox(image_, {at_.left - rim, top - rim, at_.left + width + rim, top + height + rim},
            kBarFrame, 1.0f);
  }

  void paintBar() {
    framedBox(at_.bar_top, at_.bar_width, at_.bar_height);
    for (int y = 0; y < at_.bar_height; ++y) {
      const double value = scale_.range * (1.0 - 2.0 * (y + 0.5) / at_.bar_height);
      const bool hidden = std::abs(value) < scale_.level;
      const int row = at_.bar_top + y;
      fillBox(image_, {at_.left, row, at_.left + at_.bar_width, row + 1},
              hidden ? insignificantColor() : deviationColor(scale_, value), 1.0f);
    }
  }

  void paintTick(double value) {
    const int thick = stroke(), right = at_.left + at_.bar_width;
    const double middle = at_.bar_top + 0.5 * (1.0 - value / scale_.range) * at_.bar_height;
    const int row = static_cast<int>(std::lround(middle - 0.5 * thick));
    fillBox(image_, {right, row, right + LegendLayout::rounded(kTick * at_.em), row + thick},
            kBarFrame, 1.0f);
    const std::string sign = value > 0.0 ? "+" : "";
    text(at_.bar_width + (kTick + kGap) * at_.em, middle + 0.5 * kCapHeight * at_.em,
         sign + printedTick(tickText(value)));
  }

  /** \brief A square of a colour and what it means. */
  void paintEntry(double baseline, const Color& color, const std::string& words) {
    const int side = LegendLayout::rounded(0.9 * at_.em);
    const int top = LegendLayout::rounded(baseline - 0.5 * (kCapHeight * at_.em + side));
    framedBox(top, side, side);
    fillBox(image_, {at_.left, top, at_.left + side, top + side}, color, 1.0f);
    text(side + 0.5 * at_.em, baseline, words);
  }

  void paintEntries() {
    const double line = kLine * at_.em;
    const double first = at_.bar_top + at_.bar_height + 1.3 * line;
    paintEntry(first, insignificantColor(), "not significant");
    paintEntry(first + line, noCounterpartColor(), "no counterpart");
    text(0.0, first + 2.3 * line, "level of detection");
    text(0.0, first + 3.3 * line, levelText(scale_));
  }

  const DeviationScale& scale_;
  LegendLayout at_;
  Image& image_;
};

}  // namespace

double deviationLegendShare(const ImageSize& size) {
  const LegendLayout at(size);
  return at.fits ? static_cast<double>(size.width - at.paper_left) / size.width : 0.0;
}

void addDeviationLegend(const DeviationScale& scale, Image& image) {
  LegendPainter(scale, image).paint();
}

}  // namespace pcl_slim

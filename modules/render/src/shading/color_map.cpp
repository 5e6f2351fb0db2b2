// SPDX-License-Identifier: BSD-3-Clause
// Numbers as colours: the maps, and the range of a picture.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
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

namespace detail {

std::uint32_t levelAtShare(const ShadingRange& range, double share) {
  const double level = range.low + share * (range.high - range.low);
  return static_cast<std::uint32_t>(std::lround(std::max(0.0, level)));
}

Color colorAtShare(const ShadingParams& params, const ShadingRange& range, double share) {
  if (params.mode == ShadingMode::kLevel) return categoryColor(levelAtShare(range, share));
  if (params.map == ColorMap::kPerceptual) return perceptualColor(share);
  if (params.map == ColorMap::kDiverging) return divergingColor(2.0 * share - 1.0);
  if (params.mode == ShadingMode::kSize) return sizeColor(share);
  if (params.mode == ShadingMode::kError || params.mode == ShadingMode::kUncertainty)
    return perceptualColor(share);
  return divergingColor(2.0 * share - 1.0);
}

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
    case ShadingMode::kError:
    case ShadingMode::kUncertainty: return true;
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
    case ShadingMode::kColor:
    case ShadingMode::kUncertainty: return columns | kColorColumn;
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
  } else if (params.mode != ShadingMode::kUncertainty) {  // its colours are painted already
    setRobustRange(buffer, params, scale, range);
  }
  return range;
}

}  // namespace pcl_slim

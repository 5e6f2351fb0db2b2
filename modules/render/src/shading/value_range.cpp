// SPDX-License-Identifier: BSD-3-Clause
#include "shading/value_range.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pcl_slim/core/order_statistics.h"

namespace pcl_slim {
namespace detail {

double
valueAt(const GBuffer& buffer, std::size_t pixel, ShadingMode mode, double scale)
{
  switch (mode) {
    case ShadingMode::kMean: return buffer.mean_curvature[pixel] / scale;
    case ShadingMode::kGaussian: return buffer.gaussian_curvature[pixel] / (scale * scale);
    case ShadingMode::kKMax: return buffer.principal[pixel][0] / scale;
    case ShadingMode::kKMin: return buffer.principal[pixel][1] / scale;
    case ShadingMode::kError: return buffer.residual[pixel] * scale;
    default: return buffer.radius[pixel] * scale;
  }
}

std::uint32_t
levelAtShare(const ShadingRange& range, double share)
{
  const double level = range.low + share * (range.high - range.low);
  return static_cast<std::uint32_t>(std::lround(std::max(0.0, level)));
}

Color
colorAtShare(const ShadingParams& params, const ShadingRange& range, double share)
{
  if (params.mode == ShadingMode::kLevel) return categoryColor(levelAtShare(range, share));
  if (params.map == ColorMap::kPerceptual) return perceptualColor(share);
  if (params.map == ColorMap::kDiverging) return divergingColor(2.0 * share - 1.0);
  if (params.mode == ShadingMode::kSize) return sizeColor(share);
  if (params.mode == ShadingMode::kError) return perceptualColor(share);
  return divergingColor(2.0 * share - 1.0);
}

Color
colorOf(const ShadingParams& params, const ShadingRange& range, double value)
{
  double low = range.low, high = range.high;
  if (range.logarithmic) {
    low = std::log(low);
    high = std::log(high);
    value = std::log(value);
  }
  return colorAtShare(params, range, high > low ? (value - low) / (high - low) : 0.5);
}

bool
wantsAmbientOcclusion(const ShadingParams& params)
{
  return params.ambient_occlusion > 0.0 && params.lighting && params.mode != ShadingMode::kNormal &&
         params.mode != ShadingMode::kReflection;
}

}  // namespace detail

namespace {

/** \brief The value below which a share of the values is; 0 when there are none. */
double
quantile(const std::vector<double>& values, double share)
{
  if (values.empty()) return 0.0;
  return kthSmallest(values,
                     static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

/** \brief Whether a mode's values come with both signs, so that 0 is the middle of their colours. */
bool
isSigned(ShadingMode mode)
{
  return mode != ShadingMode::kSize && mode != ShadingMode::kError;
}

/** \brief The range of a picture's values, but for outliers. */
void
setRobustRange(const GBuffer& buffer, const ShadingParams& params, double scale,
               ShadingRange& range)
{
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
ShadingRange
levelsOf(const GBuffer& buffer)
{
  ShadingRange range{HUGE_VAL, -HUGE_VAL, false};
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    if (!buffer.covered(i)) continue;
    range.low = std::min(range.low, buffer.level[i] - 0.5);
    range.high = std::max(range.high, buffer.level[i] + 0.5);
  }
  return range.low < range.high ? range : ShadingRange{0.5, 1.5, false};
}

}  // namespace

bool
hasColorBar(ShadingMode mode)
{
  return showsNumbers(mode) || mode == ShadingMode::kLevel;
}

bool
showsNumbers(ShadingMode mode)
{
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

unsigned
columnsFor(const ShadingParams& params)
{
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

ShadingRange
rangeOf(const GBuffer& buffer, const ShadingParams& params, double scale)
{
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

}  // namespace pcl_slim

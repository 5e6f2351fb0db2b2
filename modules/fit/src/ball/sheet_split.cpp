// SPDX-License-Identifier: BSD-3-Clause
#include "ball/sheet_split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "pcl_slim/core/extent.h"

namespace pcl_slim::detail {

namespace {

constexpr int kBins = 48;
constexpr double kValley = 0.12;  ///< of the lower mode
constexpr std::size_t kLeastPoints = 24;
constexpr std::size_t kMostCounted = 512;  ///< larger balls are counted in strides
constexpr double kApart = 3.0;       ///< distance of the sides' means over their own deviation
constexpr double kLeastMode = 0.05;  ///< share of the points on the smaller side

using Histogram = std::array<std::int32_t, kBins>;

/** Bin after which Otsu's two classes part best. */
int
otsuThreshold(const Histogram& bins)
{
  std::int64_t total = 0, moment = 0;
  for (int b = 0; b < kBins; ++b) {
    total += bins[b];
    moment += b * bins[b];
  }
  std::int64_t below = 0, below_moment = 0;
  double best = -1;
  int threshold = 0;
  for (int b = 0; b < kBins - 1; ++b) {
    below += bins[b];
    below_moment += b * bins[b];
    const std::int64_t both = below * (total - below);
    if (both <= 0) continue;
    // The variance between the classes, below * above * gap^2, over one denominator.
    const auto gap = static_cast<double>(below_moment * total - moment * below);
    const double between = gap * gap / static_cast<double>(both);
    if (between > best) {
      best = between;
      threshold = b;
    }
  }
  return threshold;
}

/** Two sheets are far apart against their own thickness; the ripple of one badly fitted sheet, which
 * has two peaks as well, is not. */
bool
standsApart(const Histogram& bins, int valley)
{
  double count[2] = {}, sum[2] = {}, square[2] = {};
  for (int b = 0; b < kBins; ++b) {
    const int side = b > valley;
    count[side] += bins[b];
    sum[side] += static_cast<double>(bins[b]) * b;
    square[side] += static_cast<double>(bins[b]) * b * b;
  }
  if (count[0] <= 0 || count[1] <= 0) return false;
  const double gap = sum[1] / count[1] - sum[0] / count[0];
  const double within =
      (square[0] - sum[0] * sum[0] / count[0]) + (square[1] - sum[1] * sum[1] / count[1]);
  return gap * gap > kApart * kApart * within / (count[0] + count[1]);
}

}  // namespace

SheetRange
findSheet(const float* residuals, std::size_t count, double center_residual)
{
  SheetRange range;
  if (count < kLeastPoints) return range;
  const auto [low, high] = extentOf(residuals, count);
  const double from = low, width = static_cast<double>(high) - low;
  if (!(width > 0)) return range;
  const std::size_t stride = count / kMostCounted + 1;
  const double counted = static_cast<double>(count / stride);
  const double to_bin = kBins / width;
  Histogram bins{};
  for (std::size_t i = 0; i < count; i += stride) {
    bins[std::min(static_cast<int>((residuals[i] - from) * to_bin), kBins - 1)] += 1;
  }
  const int threshold = otsuThreshold(bins);
  const auto lower_mode = std::max_element(bins.begin(), bins.begin() + threshold + 1);
  const auto upper_mode = std::max_element(bins.begin() + threshold + 1, bins.end());
  // The deepest place between the modes, over three bins: single empty bins are chance.
  auto valley = lower_mode;
  std::int32_t depth = std::numeric_limits<std::int32_t>::max();
  for (auto b = lower_mode + 1; b + 1 < upper_mode; ++b) {
    const std::int32_t three = b[-1] + b[0] + b[1];
    if (three < depth) {
      depth = three;
      valley = b;
    }
  }
  if (valley == lower_mode || depth / 3.0 >= kValley * std::min(*lower_mode, *upper_mode))
    return range;
  double below = 0;
  for (auto b = bins.begin(); b <= valley; ++b) below += *b;
  if (!standsApart(bins, static_cast<int>(valley - bins.begin()))) return range;
  const double least = kLeastMode * counted;
  if (below < least || counted - below < least) return range;
  const double cut = from + (static_cast<double>(valley - bins.begin()) + 0.5) / to_bin;
  range.split = true;
  range.low = center_residual <= cut ? low : static_cast<float>(cut);
  range.high = center_residual <= cut ? static_cast<float>(cut) : high;
  return range;
}

}  // namespace pcl_slim::detail

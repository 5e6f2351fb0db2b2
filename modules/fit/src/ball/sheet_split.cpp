// SPDX-License-Identifier: BSD-3-Clause
#include "ball/sheet_split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "pcl_slim/core/extent.h"

namespace pcl_slim::detail {

namespace {

constexpr int kMostBins = 128;  ///< room for the histogram

/** How many residuals fall into each of equally wide bins. */
struct Histogram {
  int bins;
  double from, to_bin;  ///< residual at the first bin's edge, and bins per length
  std::array<std::int32_t, kMostBins> count{};

  const std::int32_t* begin() const { return count.data(); }
  const std::int32_t* end() const { return count.data() + bins; }
};

Histogram
histogramOf(const float* residuals, std::size_t count, std::size_t stride, float low, double width,
            const SheetConstants& constants)
{
  Histogram h;
  h.bins = std::min(constants.bins, kMostBins);
  h.from = low;
  h.to_bin = h.bins / width;
  for (std::size_t i = 0; i < count; i += stride) {
    const int bin = std::min(static_cast<int>((residuals[i] - h.from) * h.to_bin), h.bins - 1);
    h.count[static_cast<std::size_t>(bin)] += 1;
  }
  return h;
}

/** Bin after which Otsu's two classes part best. */
int
otsuThreshold(const Histogram& h)
{
  std::int64_t total = 0, moment = 0;
  for (int b = 0; b < h.bins; ++b) {
    total += h.begin()[b];
    moment += b * h.begin()[b];
  }
  std::int64_t below = 0, below_moment = 0;
  double best = -1;
  int threshold = 0;
  for (int b = 0; b < h.bins - 1; ++b) {
    below += h.begin()[b];
    below_moment += b * h.begin()[b];
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

/** The deepest bin between two peaks, if it is deep enough; else the histogram's end. */
const std::int32_t*
valleyOf(const Histogram& h, double depth_ratio)
{
  const int threshold = otsuThreshold(h);
  const std::int32_t* lower_peak = std::max_element(h.begin(), h.begin() + threshold + 1);
  const std::int32_t* upper_peak = std::max_element(h.begin() + threshold + 1, h.end());
  // The depth is that of three bins: single empty bins are chance.
  const std::int32_t* valley = h.end();
  std::int32_t depth = std::numeric_limits<std::int32_t>::max();
  for (const std::int32_t* b = lower_peak + 1; b + 1 < upper_peak; ++b) {
    const std::int32_t three = b[-1] + b[0] + b[1];
    if (three < depth) {
      depth = three;
      valley = b;
    }
  }
  const bool deep = depth / 3.0 < depth_ratio * std::min(*lower_peak, *upper_peak);
  return deep ? valley : h.end();
}

/** Two sheets are far apart against their own thickness; the ripple of one badly fitted sheet,
 * which has two peaks as well, is not. */
bool
standsApart(const Histogram& h, int valley, double apart)
{
  double count[2] = {}, sum[2] = {}, square[2] = {};
  for (int b = 0; b < h.bins; ++b) {
    const int side = b > valley;
    const std::int32_t here = h.begin()[b];
    count[side] += here;
    sum[side] += static_cast<double>(here) * b;
    square[side] += static_cast<double>(here) * b * b;
  }
  if (count[0] <= 0 || count[1] <= 0) return false;
  const double gap = sum[1] / count[1] - sum[0] / count[0];
  const double within =
      (square[0] - sum[0] * sum[0] / count[0]) + (square[1] - sum[1] * sum[1] / count[1]);
  return gap * gap > apart * apart * within / (count[0] + count[1]);
}

}  // namespace

SheetRange
findSheet(const float* residuals, std::size_t count, double center_residual,
          const SheetConstants& constants)
{
  SheetRange range;
  if (count < constants.points) return range;
  const auto [low, high] = extentOf(residuals, count);
  const double width = static_cast<double>(high) - low;
  if (!(width > 0)) return range;
  const std::size_t stride = count / constants.counted + 1;
  const Histogram h = histogramOf(residuals, count, stride, low, width, constants);
  const std::int32_t* const valley = valleyOf(h, constants.valley);
  if (valley == h.end()) return range;
  const auto at = static_cast<int>(valley - h.begin());
  if (!standsApart(h, at, constants.apart)) return range;
  double below = 0;
  for (const std::int32_t* b = h.begin(); b <= valley; ++b) below += *b;
  const auto counted = static_cast<double>(count / stride);
  const double least = constants.least_side * counted;
  if (below < least || counted - below < least) return range;
  const double cut = h.from + (static_cast<double>(at) + 0.5) / h.to_bin;
  range.split = true;
  range.low = center_residual <= cut ? low : static_cast<float>(cut);
  range.high = center_residual <= cut ? static_cast<float>(cut) : high;
  return range;
}

SheetRange
SheetSplitter::sheetAt(const FramedBall& ball, const SheetConstants& constants,
                       RadiusSearch& search)
{
  const LocalFit& fit = search.right().fit;
  const double radius = ball.site.radius, e_sq = fit.residual_sq * radius * radius;
  if (fit.degree == 0 || e_sq <= constants.noise * search.noise()) return {};
  residuals_.resize(ball.points->count + BallBuffer::kPadding);
  kernels::ballResiduals(*ball.points, fit, residuals_.data());
  return findSheet(residuals_.data(), ball.points->count, -fit.c[0], constants);
}

FramedBall
SheetSplitter::ownSheet(FramedBall ball, const SheetConstants& constants, RadiusSearch& search)
{
  bool split = false;
  for (int pass = 0; pass < constants.passes; ++pass) {
    const SheetRange range = sheetAt(ball, constants, search);
    if (!range.split) break;
    kernels::selectResiduals(*ball.points, residuals_.data(), range.low, range.high, kept_);
    std::swap(*ball.points, kept_);
    ball = reframed(ball);
    search.begin(*ball.points, ball.site.radius, 1.0);
    split = true;
  }
  split_ += split;
  return ball;
}

}  // namespace pcl_slim::detail

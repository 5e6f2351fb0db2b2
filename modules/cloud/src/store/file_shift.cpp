// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/file_shift.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "store/frame_units.h"

namespace pcl_slim {

namespace {

constexpr double kGrid =
    4.0;  ///< [scale]: what is left is below 4, so that 2^-22 of it is a float's step

}  // namespace

std::array<double, 3>
fileShift(const std::array<double, 3>& origin, double scale)
{
  double farthest = 0;
  for (const double o : origin) farthest = std::max(farthest, std::abs(o) / scale);
  if (farthest < detail::kFarOrigin - 1) return {};
  std::array<double, 3> shift;
  for (std::size_t a = 0; a < 3; ++a)
    shift[a] = std::round(origin[a] / (kGrid * scale)) * (kGrid * scale);
  return shift;
}

std::array<double, 3>
fileShift(const std::array<double, 3>& low, const std::array<double, 3>& high)
{
  StoreFrame frame;
  if (detail::setUnits(low, high, {}, 0, frame)) return {};
  return fileShift(frame.origin, frame.scale);
}

std::array<double, 3>
fileShift(const CloudView& cloud)
{
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::array<double, 3> low, high;
  low.fill(kInfinity);
  high.fill(-kInfinity);
  for (std::size_t k = 0; k < cloud.count(); ++k) {
    const std::size_t i = cloud.inputIndex(k);
    const auto p = cloud.position(i);
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) continue;
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  return low[0] <= high[0] ? fileShift(low, high) : std::array<double, 3>{};
}

}  // namespace pcl_slim

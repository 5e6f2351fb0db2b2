// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/store_frame.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/vector3.h"
#include "store/frame_units.h"

namespace pcl_slim::detail {

namespace {

constexpr double kOriginGrid = 0x1p-10;    ///< the origin is a multiple of this share of the scale
constexpr double kLeastScale = 0x1p-1000;  ///< its inverse, and 2^-22 of it, are normal numbers

}  // namespace

Error
setUnits(const std::array<double, 3>& low, const std::array<double, 3>& high, const Bulk& bulk,
         double least_span, StoreFrame& frame)
{
  double half[3], farthest = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    half[a] = 0.5 * high[a] - 0.5 * low[a];
    frame.origin[a] = low[a] + half[a];
    farthest = std::max(farthest, std::abs(frame.origin[a]));
  }
  const double diagonal = 2.0 * std::hypot(half[0], half[1], half[2]);
  // The slack keeps coordinates inside [-1/2, 1/2] once the origin is rounded to its grid.
  const double one_place = std::max(farthest * 0x1p-20, 0x1p-100);
  const double span = std::max(diagonal > 0 ? diagonal : one_place, least_span);
  frame.scale = std::exp2(std::ceil(std::log2(span * (1.0 + 4 * kOriginGrid))));
  if (!std::isfinite(frame.scale)) {
    return {ErrorCode::kBadInput,
            "some coordinates come near the largest number there is: remove those points"};
  }
  if (frame.scale < kLeastScale) {
    return {
        ErrorCode::kBadInput,
        "the points differ by less than 1e-301, too little to compute with: give coordinates in a "
        "smaller unit"};
  }
  frame.diagonal = diagonal / frame.scale;
  constexpr double kQuartiles =
      4.0;  // of points spread evenly L is twice as wide as their quartiles
  frame.bulk_diagonal = std::min(frame.diagonal, kQuartiles * bulk.between / frame.scale);
  const double origin_grid = frame.scale * kOriginGrid;
  for (double& o : frame.origin) o = std::round(o / origin_grid) * origin_grid;
  const double reach = farthest / frame.scale + 0.5 + kOriginGrid;
  if (reach < kFarOrigin)
    frame.center_grid = std::max(0x1p-22, std::exp2(std::ceil(std::log2(reach)) - 24));
  frame.bulk_center = bulk.median;
  frame.bulk_between = bulk.between;
  frame.bulk_reach = bulk.reach;
  return {};
}

}  // namespace pcl_slim::detail

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
  Bounds box;
  for (std::size_t k = 0; k < cloud.count(); ++k) {
    const auto p = cloud.position(cloud.inputIndex(k));
    if (isFinite(p)) box.add(p);
  }
  return box.low[0] <= box.high[0] ? fileShift(box.low, box.high) : std::array<double, 3>{};
}

}  // namespace pcl_slim

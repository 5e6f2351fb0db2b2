// SPDX-License-Identifier: BSD-3-Clause
#include "io/las/las_units.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace pcl_slim {

namespace {

constexpr double kMostCode = 2147483647.0;
constexpr int kMostRefinement = 6;  ///< decimals; a scan's own are not far above its noise

/** Whether the units bring a coordinate back bit by bit. */
bool
isExact(const LasUnits& units, double value, std::size_t a)
{
  const double code = std::round((value - units.offset[a]) / units.scale[a]);
  return code >= -kMostCode - 1 && code <= kMostCode &&
         code * units.scale[a] + units.offset[a] == value;
}

/** Units of the cloud's own: decimal, a billionth of its extent. */
void
chooseUnits(LasUnits& units)
{
  for (std::size_t a = 0; a < 3; ++a) {
    const double extent = std::max(units.high[a] - units.low[a], 1e-6 * std::abs(units.high[a]));
    units.scale[a] = extent > 0 ? std::pow(10.0, std::ceil(std::log10(extent)) - 9) : 1e-9;
    const double grid = 1e6 * units.scale[a];
    units.offset[a] = std::round(0.5 * (units.low[a] + units.high[a]) / grid) * grid;
  }
}

/** The file's scales over the largest power of ten that lets every coordinate fit; none fits: false. */
bool
refineUnits(LasUnits& units)
{
  double room = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < 3; ++a) {
    const double reach = std::max(std::abs(units.low[a] - units.offset[a]),
                                  std::abs(units.high[a] - units.offset[a]));
    room = std::min(room, kMostCode * std::abs(units.scale[a]) / reach);
  }
  if (!(room >= 1)) return false;
  int decimals = 0;
  while (decimals < kMostRefinement && room >= std::pow(10.0, decimals + 1)) ++decimals;
  for (double& scale : units.scale) scale /= std::pow(10.0, decimals);
  return true;
}

}  // namespace

LasPositions::LasPositions(const pcl::PCLPointCloud2& cloud)
    : cloud_(cloud), size_(numPoints(cloud))
{
  const char* const names[3] = {"x", "y", "z"};
  for (std::size_t a = 0; a < 3; ++a)
    fields_[a] = &cloud.fields[static_cast<std::size_t>(findField(cloud, names[a]))];
}

double
LasPositions::at(std::size_t point, std::size_t axis) const
{
  return fieldValue(cloud_, point, *fields_[axis]);
}

std::int32_t
LasUnits::code(double value, std::size_t axis) const
{
  const double code = std::round((value - offset[axis]) / scale[axis]);
  return static_cast<std::int32_t>(std::clamp(code, -kMostCode - 1, kMostCode));
}

Result<LasUnits>
lasUnits(const LasPositions& positions, const LasHeader* given)
{
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  LasUnits units;
  units.low.fill(positions.size() > 0 ? kInfinity : 0.0);
  units.high.fill(positions.size() > 0 ? -kInfinity : 0.0);
  if (given) {
    units.scale = given->scale;
    units.offset = given->offset;
  }
  units.exact = given != nullptr;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      const double value = positions.at(i, a);
      if (!std::isfinite(value) || std::abs(value) > 1e99) {
        return Error{ErrorCode::kBadInput,
                     "point " + std::to_string(i) +
                         " has no coordinates that LAS can hold: NaN, infinite or beyond 1e99; "
                         "remove it, or write .pcd"};
      }
      units.low[a] = std::min(units.low[a], value);
      units.high[a] = std::max(units.high[a], value);
      units.exact = units.exact && isExact(units, value, a);
    }
  }
  if (!units.exact && !(given && refineUnits(units))) chooseUnits(units);
  return units;
}

}  // namespace pcl_slim

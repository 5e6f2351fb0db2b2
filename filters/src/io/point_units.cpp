// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/point_units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pcl_slim {

namespace {

constexpr double kMostLongitude = 360, kMostLatitude = 90;
/** Of heights to degrees: a degree is some 100,000 m; a scan in metres is rarely so slim a column. */
constexpr double kLeastRatio = 50;
/** Of the distance from 0 to the extent: scans in coordinates of their own mostly begin near 0. */
constexpr double kLeastDistance = 5;

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  double extent() const { return high - low; }
  double middle() const { return low + 0.5 * extent(); }
  double farthest() const { return std::max(std::abs(low), std::abs(high)); }
};

/** Ranges of the finite points. false: the points have no coordinates, or none is finite. */
bool findRanges(const PointTable& cloud, std::array<Range, 3>& ranges) {
  const PointField* fields[3];
  const char* const names[3] = {"x", "y", "z"};
  for (std::size_t a = 0; a < 3; ++a) {
    const int at = findField(cloud, names[a]);
    if (at < 0) return false;
    fields[a] = &cloud.fields[static_cast<std::size_t>(at)];
  }
  for (std::size_t i = 0; i < numPoints(cloud); ++i) {
    std::array<double, 3> p;
    for (std::size_t a = 0; a < 3; ++a) p[a] = fieldValue(cloud, i, *fields[a]);
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) continue;
    for (std::size_t a = 0; a < 3; ++a) {
      ranges[a].low = std::min(ranges[a].low, p[a]);
      ranges[a].high = std::max(ranges[a].high, p[a]);
    }
  }
  return ranges[0].low <= ranges[0].high;
}

bool looksLikeDegrees(const std::array<Range, 3>& ranges) {
  const double flat = std::max(ranges[0].extent(), ranges[1].extent());
  const auto isFar = [&](const Range& range) {
    return std::abs(range.middle()) > kLeastDistance * flat;
  };
  return flat > 0 && ranges[2].extent() > kLeastRatio * flat && isFar(ranges[0]) &&
         isFar(ranges[1]);
}

/** The zone of UTM at a place, as EPSG numbers it. */
int utmZone(double longitude, double latitude) {
  constexpr int kNorth = 32600, kSouth = 32700, kZones = 60;
  const double turned = longitude - 360 * std::floor((longitude + 180) / 360);
  const int zone = std::clamp(static_cast<int>(std::floor((turned + 180) / 6)) + 1, 1, kZones);
  return (latitude < 0 ? kSouth : kNorth) + zone;
}

}  // namespace

Error checkLengths(const PointFile& file, const std::string& path) {
  std::array<Range, 3> ranges;
  if (!findRanges(file.cloud, ranges)) return {};
  if (ranges[0].farthest() > kMostLongitude || ranges[1].farthest() > kMostLatitude) return {};
  if (!file.degrees && !looksLikeDegrees(ranges)) return {};
  const std::string why = file.degrees ? "the file says so" : "z has a far larger range";
  const int zone = utmZone(ranges[0].middle(), ranges[1].middle());
  return {ErrorCode::kBadInput,
          "'" + path + "': x and y are degrees (" + why +
              "), and a surface needs lengths; reproject it first, here to UTM: pdal translate IN "
              "OUT -f filters.reprojection --filters.reprojection.in_srs=EPSG:4326 "
              "--filters.reprojection.out_srs=EPSG:" +
              std::to_string(zone) + "; if they are lengths, give -units length"};
}

}  // namespace pcl_slim

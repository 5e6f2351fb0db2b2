// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/table/projected_fields.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <limits>
#include <utility>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/filters/io/table_fields.h"

namespace pcl_slim {

namespace {

constexpr const char* kNames[] = {"x",
                                  "y",
                                  "z",
                                  "normal_x",
                                  "normal_y",
                                  "normal_z",
                                  "curvature",
                                  "k1",
                                  "k2",
                                  "mean_curvature",
                                  "gaussian_curvature",
                                  "direction1_x",
                                  "direction1_y",
                                  "direction1_z",
                                  "direction2_x",
                                  "direction2_y",
                                  "direction2_z",
                                  "sigma_position",
                                  "sigma_normal"};
constexpr std::size_t kPosition = 3;  ///< values that only supported points change
constexpr std::size_t kRun = 4096;    ///< points that a thread takes at a time

using Values = std::array<double, std::size(kNames)>;

/** The values of a point, in the order of kNames. */
Values valuesOf(const ProjectedPoint& point) {
  const auto& p = point.position;
  const auto& n = point.normal;
  const auto& d1 = point.principal.direction1;
  const auto& d2 = point.principal.direction2;
  return {p[0],
          p[1],
          p[2],
          n[0],
          n[1],
          n[2],
          point.surface_variation,
          point.principal.k1,
          point.principal.k2,
          point.mean_curvature,
          point.gaussian_curvature,
          d1[0],
          d1[1],
          d1[2],
          d2[0],
          d2[1],
          d2[2],
          point.errors.position,
          point.errors.normal};
}

/** Index of a name in kNames; their number: it is none of them. */
std::size_t indexOf(const std::string& name) {
  return static_cast<std::size_t>(std::find(std::begin(kNames), std::end(kNames), name) -
                                  std::begin(kNames));
}

/** A field and the value that it gets. */
struct Target {
  std::size_t value;
  FieldWriter field;
};

}  // namespace

PointTable withProjected(const PointTable& points, const CloudProjection& projection,
                         const std::vector<std::string>& names, int threads) {
  std::vector<std::string> places, others;
  for (const std::string& name : names) {
    if (indexOf(name) < std::size(kNames))
      (indexOf(name) < kPosition ? places : others).push_back(name);
  }
  // Integer coordinates cannot represent the points' new positions.
  PointTable made =
      hasRealFields(points, places)
          ? withRealFields(points, others, kFloat32)
          : withRealFields(withRealFields(points, places, kFloat64), others, kFloat32);
  std::vector<Target> moved, described;
  for (const std::string& name : places) moved.push_back({indexOf(name), {made, name}});
  for (const std::string& name : others) described.push_back({indexOf(name), {made, name}});
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const ProjectedPoint unknown = CloudProjection::unknownPoint({kNan, kNan, kNan});
  parallelFor(projection.size(), resolveThreads(threads), kRun, [&](std::size_t i, int) {
    const Values values = valuesOf(projection.isFinite(i) ? projection.point(i) : unknown);
    if (projection.isSupported(i)) {
      for (const auto& [value, field] : moved) field.set(i, values[value]);
    }
    for (const auto& [value, field] : described) field.set(i, values[value]);
  });
  return made;
}

}  // namespace pcl_slim

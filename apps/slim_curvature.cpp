// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_curvature: adds curvatures and normals of its SLIM surface to a scan; nothing moves.
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "pcl_slim/core/parallel.h"
#include "projection/projection_job.h"
#include "scan/cloud_file.h"

namespace {

using namespace pcl_slim;

std::vector<std::string> fieldNames(bool directions) {
  std::vector<std::string> names = {"k1",       "k2",       "mean_curvature", "gaussian_curvature",
                                    "normal_x", "normal_y", "normal_z"};
  if (!directions) return names;
  for (const char* direction : {"direction1_", "direction2_"}) {
    for (const char* axis : {"x", "y", "z"}) names.push_back(std::string(direction) + axis);
  }
  return names;
}

using Values = std::array<float, 13>;

/** The values of a point, in the order of fieldNames(). */
Values valuesOf(const ProjectedPoint& point) {
  const auto& n = point.normal;
  const auto& d1 = point.principal.direction1;
  const auto& d2 = point.principal.direction2;
  return {point.principal.k1,
          point.principal.k2,
          point.mean_curvature,
          point.gaussian_curvature,
          n[0],
          n[1],
          n[2],
          d1[0],
          d1[1],
          d1[2],
          d2[0],
          d2[1],
          d2[2]};
}

PointFile withCurvatures(const PointFile& file, const CloudProjection& projection, bool directions,
                         int threads) {
  const bool had_normals = findField(file.cloud, "normal_x") >= 0;
  const std::vector<std::string> names = fieldNames(directions);
  PointFile made = withRealFields(file, names, kFloat32);
  std::vector<FieldWriter> fields;
  for (const std::string& name : names) fields.emplace_back(made.cloud, name);
  Values unknown;
  unknown.fill(std::numeric_limits<float>::quiet_NaN());
  parallelFor(projection.size(), resolveThreads(threads), 4096, [&](std::size_t i, int) {
    const bool known = projection.isSupported(i);
    const Values values = known ? valuesOf(projection.point(i)) : unknown;
    for (std::size_t k = 0; k < fields.size(); ++k) {
      const bool is_normal = k >= 4 && k < 7;
      if (known || !is_normal || !had_normals) fields[k].set(i, values[k]);
    }
  });
  return made;
}

}  // namespace

int main(int argc, char** argv) {
  ProjectionJob job;
  job.projection.directions = true;
  return runProjectionProgram(
      {"pcl_slim_curvature", PCL_SLIM_VERSION,
       "Adds the curvatures and normals of a scan's SLIM surface to its points.", "directions",
       "also write the unit tangents of k1 and k2"},
      job, argc, argv, withCurvatures);
}

// SPDX-License-Identifier: BSD-3-Clause
#include "compare/point_output.h"

#include <functional>
#include <string>
#include <vector>

#include "pcl_slim/filters/io/table_fields.h"

namespace pcl_slim {
namespace {

const std::vector<std::string> kPosition = {"x", "y", "z"};
const std::vector<std::string> kNormal = {"normal_x", "normal_y", "normal_z"};
const std::vector<std::string> kDeviation = {"deviation", "level_of_detection", "significant",
                                             "sigma_position"};

void writeTriples(const std::vector<std::string>& names, PointTable& points,
                  const std::function<Vector3(std::size_t)>& value) {
  std::vector<FieldWriter> fields;
  for (const std::string& name : names) fields.emplace_back(points, name);
  for (std::size_t i = 0; i < numPoints(points); ++i) {
    const Vector3 v = value(i);
    for (std::size_t a = 0; a < 3; ++a) fields[a].set(i, v[a]);
  }
}

/** The places of a surface as a new file. */
PointFile placesFile(const PlaceColumns& places) {
  PointFile file;
  file.cloud.width = static_cast<std::uint32_t>(places.size());
  file.cloud.height = 1;
  file.cloud = withRealFields(std::move(file.cloud), kPosition, kFloat64);
  file.cloud = withRealFields(std::move(file.cloud), kNormal, kFloat32);
  writeTriples(kPosition, file.cloud, [&](std::size_t i) { return places.positions[i]; });
  writeTriples(kNormal, file.cloud, [&](std::size_t i) {
    const auto& n = places.normals[i];
    return Vector3{n[0], n[1], n[2]};
  });
  return file;
}

/** The file with its points where a motion takes them, and their normals turned. */
void moveFile(const ComparedInput& a, const RigidMotion& motion, PointTable& points) {
  const CloudView view = a.view();
  points = withRealFields(std::move(points), kPosition, kFloat64);
  writeTriples(kPosition, points, [&](std::size_t i) { return motion.place(view.position(i)); });
  if (!hasRealFields(points, kNormal)) return;
  std::vector<PointField> fields;
  for (const std::string& name : kNormal)
    fields.push_back(points.fields[static_cast<std::size_t>(findField(points, name))]);
  writeTriples(kNormal, points, [&](std::size_t i) {
    return motion.direction({fieldValue(points, i, fields[0]), fieldValue(points, i, fields[1]),
                             fieldValue(points, i, fields[2])});
  });
}

}  // namespace

PointFile withDeviations(const ComparedInput& a, const Comparison& comparison,
                         const Deviations& deviations, bool moved) {
  PointFile file;
  if (a.file) {
    file = withPoints(a.file->file, a.file->file.cloud);
    if (moved) moveFile(a, comparison.motion(), file.cloud);
  } else {
    PlaceColumns places = comparison.pointPlaces();
    if (moved) places.move(comparison.motion());
    file = placesFile(places);
  }
  file.cloud = withRealFields(std::move(file.cloud), kDeviation, kFloat32);
  std::vector<FieldWriter> fields;
  for (const std::string& name : kDeviation) fields.emplace_back(file.cloud, name);
  const std::vector<float>& sigma = comparison.pointSigma();
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    const DeviationClass found = deviations.classOf(i);
    const double significant = found == DeviationClass::kSignificant ? 1.0
                               : found == DeviationClass::kSame      ? 0.0
                                                                     : -1.0;
    fields[0].set(i, deviations.distance[i]);
    fields[1].set(i, deviations.detection[i]);
    fields[2].set(i, significant);
    fields[3].set(i, sigma.empty() ? 0.0 : sigma[i]);
  }
  return file;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/scan_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

namespace {

/** A field of colours that is packed into four bytes, or null. */
const PointField* packedField(const PointTable& points) {
  for (const char* name : {"rgba", "rgb"}) {
    const int i = findField(points, name);
    if (i < 0) continue;
    const PointField& field = points.fields[static_cast<std::size_t>(i)];
    if (field.datatype == kFloat32 || field.datatype == kUInt32 || field.datatype == kInt32)
      return &field;
  }
  return nullptr;
}

/** The fields of blue, green and red, or nothing. */
std::vector<const PointField*> channelFields(const PointTable& points) {
  std::vector<const PointField*> fields;
  for (const auto& names : {std::array<const char*, 3>{"blue", "green", "red"},
                            std::array<const char*, 3>{"b", "g", "r"}}) {
    fields.clear();
    for (const char* name : names) {
      const int i = findField(points, name);
      if (i >= 0) fields.push_back(&points.fields[static_cast<std::size_t>(i)]);
    }
    if (fields.size() == 3) return fields;
  }
  return {};
}

double whiteOf(double largest, bool fractions) {
  if (fractions && largest <= 1.0) return 1.0;
  return largest <= 255.0 ? 255.0 : std::max(largest, 65535.0);
}

constexpr const char* kCoordinates[3] = {"x", "y", "z"};
constexpr const char* kNormals[3] = {"normal_x", "normal_y", "normal_z"};
constexpr const char* kSensors[3] = {"vp_x", "vp_y", "vp_z"};

bool findTriple(const PointTable& cloud, const char* const (&names)[3],
                const PointField* (&fields)[3]) {
  for (int k = 0; k < 3; ++k) {
    const int i = findField(cloud, names[k]);
    if (i < 0) return false;
    fields[k] = &cloud.fields[static_cast<std::size_t>(i)];
  }
  return true;
}

/** Whether three fields are consecutive values of this type at addresses aligned for it. */
bool usableInPlace(const PointTable& cloud, const PointField* const (&fields)[3], std::uint8_t type,
                   std::size_t size) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (fields[k]->datatype != type || fields[k]->offset != fields[0]->offset + k * size)
      return false;
  }
  const auto address = reinterpret_cast<std::uintptr_t>(cloud.data.data()) + fields[0]->offset;
  return address % size == 0 && cloud.point_step % size == 0;
}

template <typename T>
std::vector<T> copyTriple(const PointTable& cloud, const PointField* const (&fields)[3]) {
  std::vector<T> values(numPoints(cloud) * 3);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = static_cast<T>(fieldValue(cloud, i / 3, *fields[i % 3]));
  }
  return values;
}

/** Brings colours that are three fields of any type, red green blue or r g b, to bytes. */
std::vector<std::uint8_t> colorBytes(const PointTable& points) {
  const auto fields = channelFields(points);
  if (fields.empty() || packedField(points) != nullptr) return {};
  double largest = 0;
  bool fractions = false;
  for (const PointField* field : fields) {
    fractions = fractions || field->datatype == kFloat32 || field->datatype == kFloat64;
    for (std::size_t i = 0; i < numPoints(points); ++i) {
      const double value = fieldValue(points, i, *field);
      if (std::isfinite(value)) largest = std::max(largest, value);
    }
  }
  const double white = whiteOf(largest, fractions);
  std::vector<std::uint8_t> colors(3 * numPoints(points));
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const double share = fieldValue(points, i / 3, *fields[i % 3]) / white;
    if (share > 0) colors[i] = static_cast<std::uint8_t>(std::lround(255 * std::min(share, 1.0)));
  }
  return colors;
}

/** The places that points were seen from, of their fields; none where all are 0: unknown. */
std::vector<double> sensorPlacesOf(const PointTable& points) {
  const PointField* fields[3];
  if (!findTriple(points, kSensors, fields)) return {};
  std::vector<double> places = copyTriple<double>(points, fields);
  const bool known = std::any_of(places.begin(), places.end(), [](double v) { return v != 0; });
  if (!known) places.clear();
  return places;
}

/** Whether one of three fields is not 0 everywhere: some programs write normals that they lack as 0. */
bool hasValues(const PointTable& cloud, const PointField* const (&fields)[3]) {
  for (std::size_t i = 0; i < numPoints(cloud); ++i) {
    for (const PointField* field : fields) {
      const double value = fieldValue(cloud, i, *field);
      if (value != 0 && std::isfinite(value)) return true;
    }
  }
  return false;
}

}  // namespace

Result<ScanColumns> ScanColumns::of(const PointTable& points) {
  ScanColumns columns;
  const PointField* fields[3];
  if (!findTriple(points, kCoordinates, fields))
    return badInput("the points have no fields x y z; give a point cloud");
  columns.double_precision = usableInPlace(points, fields, kFloat64, sizeof(double));
  if (!columns.double_precision && !usableInPlace(points, fields, kFloat32, sizeof(float))) {
    columns.xyz = copyTriple<double>(points, fields);
    columns.double_precision = true;
  }
  const CloudView view = columns.viewOf(points);
  for (std::size_t i = 0; i < view.size; ++i)
    columns.num_non_finite += isFinite(view.position(i)) ? 0 : 1;
  columns.sensors = sensorPlacesOf(points);
  if (findTriple(points, kNormals, fields) && hasValues(points, fields)) {
    columns.normal_source = NormalSource::kFields;
    if (!usableInPlace(points, fields, kFloat32, sizeof(float)))
      columns.normals = copyTriple<float>(points, fields);
  }
  columns.colors = colorBytes(points);
  return columns;
}

CloudView ScanColumns::viewOf(const PointTable& points, bool with_normals) const {
  CloudView view;
  if (!sensors.empty()) {
    view.sensors = sensors.data();
    view.sensors_stride = 3 * sizeof(double);
  }
  if (!frames.empty()) view.frame_numbers = frames.data();
  const PointField* fields[3];
  view.size = numPoints(points);
  view.scalar = double_precision ? CloudView::Scalar::kDouble : CloudView::Scalar::kFloat;
  if (!xyz.empty()) {
    view.scalar = CloudView::Scalar::kDouble;
    view.xyz = xyz.data();
    view.xyz_stride = 3 * sizeof(double);
  } else if (findTriple(points, kCoordinates, fields)) {
    view.xyz = points.data.data() + fields[0]->offset;
    view.xyz_stride = points.point_step;
  }
  if (!with_normals || normal_source == NormalSource::kNothing) return view;
  if (!normals.empty()) {
    view.normal = normals.data();
    view.normal_stride = 3 * sizeof(float);
  } else if (findTriple(points, kNormals, fields)) {
    view.normal = points.data.data() + fields[0]->offset;
    view.normal_stride = points.point_step;
  }
  return view;
}

ColorView ScanColumns::colorViewOf(const PointTable& points) const {
  if (const PointField* field = packedField(points))
    return {points.data.data() + field->offset, points.point_step};
  if (colors.empty()) return {};
  return {colors.data(), 3};
}

Result<ScanTable> ScanTable::from(PointTable points) {
  if (Error error = checkPointTable(points)) return error;
  ScanTable scan;
  scan.points = std::move(points);
  Result<ScanColumns> columns = ScanColumns::of(scan.points);
  if (!columns) return columns.error();
  scan.columns = std::move(*columns);
  return scan;
}

CloudView ScanTable::view(bool with_normals) const {
  CloudView view = columns.viewOf(points, with_normals);
  view.sensor = sensor;
  return view;
}

}  // namespace pcl_slim

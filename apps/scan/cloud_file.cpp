// SPDX-License-Identifier: BSD-3-Clause
#include "scan/cloud_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <optional>
#include <utility>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/filters/estimated_normals.h"

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

/** Brings colours that are three fields of any type, red green blue or r g b, to bytes. Their white
 * is 1 for fractions up to that, 255 for values up to that, 65535 up to that, else the largest. */
void adoptColors(CloudFile& cloud) {
  const PointTable& points = cloud.file.cloud;
  const auto fields = channelFields(points);
  if (fields.empty() || packedField(points) != nullptr) return;
  double largest = 0;
  bool fractions = false;
  for (const PointField* field : fields) {
    fractions = fractions || field->datatype == kFloat32 || field->datatype == kFloat64;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const double value = fieldValue(points, i, *field);
      if (std::isfinite(value)) largest = std::max(largest, value);
    }
  }
  const double white = whiteOf(largest, fractions);
  cloud.colors.resize(3 * cloud.size());
  for (std::size_t i = 0; i < cloud.colors.size(); ++i) {
    const double share = fieldValue(points, i / 3, *fields[i % 3]) / white;
    if (share > 0)
      cloud.colors[i] = static_cast<std::uint8_t>(std::lround(255 * std::min(share, 1.0)));
  }
}

}  // namespace

ColorView colorsOf(const CloudFile& cloud) {
  const PointTable& points = cloud.file.cloud;
  if (const auto* field = packedField(points)) {
    return {points.data.data() + field->offset, points.point_step};
  }
  if (cloud.colors.empty()) return {};
  return {cloud.colors.data(), 3};
}

namespace {

/** Whether each edge is run along once in either direction. */
bool isClosed(const PointFile& mesh) {
  std::vector<std::uint64_t> edges, opposite;
  for (std::size_t f = 0; f < mesh.numFaces(); ++f) {
    const std::uint32_t begin = mesh.face_begin[f], end = mesh.face_begin[f + 1];
    for (std::uint32_t k = begin; k < end; ++k) {
      const std::uint64_t from = mesh.face_vertices[k];
      const std::uint64_t to = mesh.face_vertices[k + 1 < end ? k + 1 : begin];
      edges.push_back(from << 32 | to);
      opposite.push_back(to << 32 | from);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::sort(opposite.begin(), opposite.end());
  return !edges.empty() && edges == opposite &&
         std::adjacent_find(edges.begin(), edges.end()) == edges.end();
}

/** Six times the volume that the faces enclose; below 0 where they face inwards. */
double volumeOf(const std::function<Vector3(std::uint32_t)>& position, const PointFile& mesh) {
  const Vector3 origin = position(mesh.face_vertices[0]);
  const auto corner = [&](std::uint32_t k) {
    return subtract(position(mesh.face_vertices[k]), origin);
  };
  double volume = 0.0;
  for (std::size_t f = 0; f < mesh.numFaces(); ++f) {
    const std::uint32_t begin = mesh.face_begin[f];
    for (std::uint32_t k = begin + 1; k + 1 < mesh.face_begin[f + 1]; ++k)
      volume += dot(corner(begin), cross(corner(k), corner(k + 1)));
  }
  return volume;
}

/** \brief Turns the faces of a closed mesh round if they face inwards: if every edge has two faces,
 * which run along it in opposite directions, and the volume they enclose is negative.
 * \param[in] position of a vertex \return whether it did. O(faces log faces). */
bool turnOutwards(const std::function<std::array<double, 3>(std::uint32_t)>& position,
                  PointFile& mesh) {
  if (!isClosed(mesh) || !(volumeOf(position, mesh) < 0.0)) return false;
  for (std::size_t f = 0; f < mesh.numFaces(); ++f) {
    const auto first = mesh.face_vertices.begin();
    std::reverse(first + mesh.face_begin[f], first + mesh.face_begin[f + 1]);
  }
  return true;
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

/** Sum of the faces' area vectors around each vertex, made unit; zero where there is no face. */
std::vector<float> meshNormals(const PointFile& file, const CloudView& view) {
  std::vector<std::array<double, 3>> sums(view.size);
  for (std::size_t f = 0; f < file.numFaces(); ++f) {
    const std::uint32_t* corners = file.face_vertices.data() + file.face_begin[f];
    const std::uint32_t count = file.face_begin[f + 1] - file.face_begin[f];
    if (count < 3) continue;
    const std::array<double, 3> o = view.position(corners[0]);
    std::array<double, 3> area{};
    for (std::uint32_t k = 1; k + 1 < count; ++k) {
      const std::array<double, 3> p = view.position(corners[k]), q = view.position(corners[k + 1]);
      for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
        area[a] += (p[b] - o[b]) * (q[c] - o[c]) - (p[c] - o[c]) * (q[b] - o[b]);
      }
    }
    if (!isFinite(area)) continue;
    for (std::uint32_t k = 0; k < count; ++k) {
      for (std::size_t a = 0; a < 3; ++a) sums[corners[k]][a] += area[a];
    }
  }
  std::vector<float> normals(view.size * 3, 0.0f);
  for (std::size_t i = 0; i < view.size; ++i) {
    const double length = std::hypot(sums[i][0], sums[i][1], sums[i][2]);
    if (!(length > 0.0)) continue;
    for (std::size_t a = 0; a < 3; ++a)
      normals[3 * i + a] = static_cast<float>(sums[i][a] / length);
  }
  return normals;
}

/** Takes the places that points were seen from out of their fields, unless all are 0: unknown. */
void adoptSensors(CloudFile& cloud) {
  const PointField* fields[3];
  if (!findTriple(cloud.file.cloud, kSensors, fields)) return;
  std::vector<double> places = copyTriple<double>(cloud.file.cloud, fields);
  const bool known = std::any_of(places.begin(), places.end(), [](double v) { return v != 0; });
  if (known) cloud.sensors = std::move(places);
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

void adoptNormals(CloudFile& cloud) {
  const PointField* fields[3];
  if (findTriple(cloud.file.cloud, kNormals, fields) && hasValues(cloud.file.cloud, fields)) {
    cloud.normal_source = NormalSource::kFields;
    if (!usableInPlace(cloud.file.cloud, fields, kFloat32, sizeof(float))) {
      cloud.normals = copyTriple<float>(cloud.file.cloud, fields);
    }
  } else if (cloud.file.numFaces() > 0) {
    const CloudView view = cloud.view();
    cloud.turned_outwards =
        turnOutwards([&](std::uint32_t i) { return view.position(i); }, cloud.file);
    cloud.normals = meshNormals(cloud.file, view);
    cloud.normal_source = NormalSource::kMesh;
  }
}

}  // namespace

std::array<double, 3> CloudFile::sensor() const {
  const std::array<float, 3>& at = file.sensor_origin;
  if (!isFinite(at)) return {};
  return {at[0], at[1], at[2]};
}

CloudView CloudFile::view(bool with_normals) const {
  CloudView view;
  const std::array<double, 3> at = sensor();
  // An organized cloud has its sensor even at 0, others may have none that is known.
  if (file.cloud.height > 1 || at != std::array<double, 3>{}) view.sensor = at;
  if (!sensors.empty()) {
    view.sensors = sensors.data();
    view.sensors_stride = 3 * sizeof(double);
  }
  if (!frames.empty()) view.frame_numbers = frames.data();
  const PointField* fields[3];
  view.size = size();
  view.scalar = double_precision ? CloudView::Scalar::kDouble : CloudView::Scalar::kFloat;
  if (!xyz.empty()) {
    view.scalar = CloudView::Scalar::kDouble;
    view.xyz = xyz.data();
    view.xyz_stride = 3 * sizeof(double);
  } else if (findTriple(file.cloud, kCoordinates, fields)) {
    view.xyz = file.cloud.data.data() + fields[0]->offset;
    view.xyz_stride = file.cloud.point_step;
  }
  if (!with_normals || normal_source == NormalSource::kNothing) return view;
  if (!normals.empty()) {
    view.normal = normals.data();
    view.normal_stride = 3 * sizeof(float);
  } else if (findTriple(file.cloud, kNormals, fields)) {
    view.normal = file.cloud.data.data() + fields[0]->offset;
    view.normal_stride = file.cloud.point_step;
  }
  return view;
}

Result<CloudFile> loadCloudFile(const std::string& path) {
  Result<PointFile> file = loadPointFile(path);
  if (!file) return file.error();
  return asCloudFile(std::move(*file), path);
}

Result<CloudFile> asCloudFile(PointFile file, const std::string& name) {
  CloudFile cloud;
  cloud.file = std::move(file);
  const PointTable& points = cloud.file.cloud;
  const PointField* fields[3];
  if (!findTriple(points, kCoordinates, fields)) {
    return Error{ErrorCode::kBadInput, "'" + name + "' has no fields x y z; name a point cloud"};
  }
  cloud.double_precision = usableInPlace(points, fields, kFloat64, sizeof(double));
  if (!cloud.double_precision && !usableInPlace(points, fields, kFloat32, sizeof(float))) {
    cloud.xyz = copyTriple<double>(points, fields);
    cloud.double_precision = true;
  }
  const CloudView view = cloud.view();
  for (std::size_t i = 0; i < view.size; ++i) {
    cloud.num_non_finite += isFinite(view.position(i)) ? 0 : 1;
  }
  adoptSensors(cloud);
  adoptNormals(cloud);
  adoptColors(cloud);
  return cloud;
}

Error estimateNormals(int k, const std::optional<std::array<double, 3>>& viewpoint, int threads,
                      CloudFile& cloud) {
  cloud.normal_source = NormalSource::kEstimated;
  return estimateNormals(cloud.view(false), k, viewpoint, threads, cloud.normals);
}

namespace {

bool isReal(const PointField& field) {
  return field.datatype == kFloat32 || field.datatype == kFloat64;
}

std::size_t realSize(std::uint8_t type) {
  return type == kFloat64 ? sizeof(double) : sizeof(float);
}

/** Bytes of a field, with all its elements. */
std::size_t fieldBytes(const PointField& field) {
  return scalarSize(field.datatype) * std::max<std::size_t>(field.count, 1);
}

void storeReal(unsigned char* at, bool is_double, double value) {
  if (is_double) {
    std::memcpy(at, &value, sizeof(value));
    return;
  }
  const float narrow = finiteFloat(value);
  std::memcpy(at, &narrow, sizeof(narrow));
}

/** Copies one field of every point to its place in another layout, changing its type if need be. */
void moveField(const PointTable& from, const PointField& source, const PointField& target,
               PointTable& to) {
  const std::size_t bytes = fieldBytes(source);
  for (std::size_t i = 0; i < numPoints(from); ++i) {
    unsigned char* at = to.data.data() + i * to.point_step + target.offset;
    if (source.datatype == target.datatype) {
      std::memcpy(at, from.data.data() + i * from.point_step + source.offset, bytes);
    } else {
      const bool is_double = target.datatype == kFloat64;
      storeReal(at, is_double, fieldValue(from, i, source));
    }
  }
}

}  // namespace

PointFile withRealFields(const PointFile& file, const std::vector<std::string>& names,
                         std::uint8_t type) {
  const PointTable& from = file.cloud;
  std::vector<PointField> fields = from.fields;
  bool same = true;
  for (const std::string& name : names) {
    const int i = findField(from, name);
    if (i >= 0 && isReal(from.fields[static_cast<std::size_t>(i)])) continue;
    if (i < 0) fields.emplace_back();
    PointField& field = i < 0 ? fields.back() : fields[static_cast<std::size_t>(i)];
    field.name = name;
    field.datatype = type;
    field.count = 1;
    same = false;
  }
  if (same) return file;

  PointFile made;
  made.sensor_origin = file.sensor_origin;
  made.sensor_orientation = file.sensor_orientation;
  made.comments = file.comments;
  made.face_begin = file.face_begin;
  made.face_vertices = file.face_vertices;
  made.las_head = file.las_head;
  made.las_tail = file.las_tail;
  PointTable& to = made.cloud;
  to.width = from.width;
  to.height = from.height;
  std::size_t step = 0;
  for (PointField& field : fields) {
    field.offset = static_cast<std::uint32_t>(step);
    step += fieldBytes(field);
  }
  to.fields = std::move(fields);
  to.point_step = static_cast<std::uint32_t>(step);
  to.data.assign(step * numPoints(from), 0);
  for (std::size_t k = 0; k < from.fields.size(); ++k) {
    moveField(from, from.fields[k], to.fields[k], to);
  }
  return made;
}

FieldWriter::FieldWriter(PointTable& cloud, const std::string& name) : step_(cloud.point_step) {
  const auto& field = cloud.fields[static_cast<std::size_t>(findField(cloud, name))];
  first_ = cloud.data.data() + field.offset;
  double_ = realSize(field.datatype) == sizeof(double);
}

void FieldWriter::set(std::size_t point, double value) const {
  storeReal(first_ + point * step_, double_, value);
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/record_layout.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <utility>
#include <vector>

#include "io/pcd/pcd_header.h"
#include "io/ply/ply_header.h"
#include "io/scalar_type.h"
#include "pcl_slim/core/file_access.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kMostHeader = 1 << 20;  ///< bytes in which a header must end

/** A column of a file: bytes, or words of a text's row. */
struct NamedField {
  std::string name;
  RecordLayout::Field field;
};

Error
whole(const std::string& path, const std::string& why, const std::string& remedy)
{
  return {ErrorCode::kBadArgument,
          "'" + path + "' can only be read as a whole: " + why + "; " + remedy};
}

bool
findTriple(const std::vector<NamedField>& columns, const char* const (&names)[3],
           std::array<RecordLayout::Field, 3>& fields)
{
  for (std::size_t a = 0; a < 3; ++a) {
    const auto isIt = [&](const NamedField& column) { return column.name == names[a]; };
    const auto at = std::find_if(columns.begin(), columns.end(), isIt);
    if (at == columns.end()) return false;
    fields[a] = at->field;
  }
  return true;
}

/** Sets coordinates and normals. */
Error
setFields(const std::vector<NamedField>& columns, const char* const (&normals)[3], bool use_normals,
          RecordLayout& layout)
{
  constexpr const char* kPosition[3] = {"x", "y", "z"};
  if (!findTriple(columns, kPosition, layout.position))
    return badInput("'" + layout.path + "' has no fields x y z; name a point cloud");
  constexpr const char* kSensors[3] = {"vp_x", "vp_y", "vp_z"};
  std::array<RecordLayout::Field, 3> normal, sensor;
  layout.has_sensors = findTriple(columns, kSensors, sensor);
  const auto isColor = [](const NamedField& column) {
    return column.name == "rgb" || column.name == "rgba" || column.name == "red";
  };
  layout.colors = std::any_of(columns.begin(), columns.end(), isColor);
  if (use_normals && findTriple(columns, normals, normal)) layout.normal = normal;
  return {};
}

Error
pcdLayout(const std::vector<unsigned char>& head, bool use_normals, RecordLayout& layout)
{
  PcdHeader header;
  PointFile file;
  if (Error error = parsePcdHeader(head, header, file)) return error;
  layout.text = header.data == "ascii";
  if (!layout.text && header.data != "binary") {
    return whole(layout.path, "its data are '" + header.data + "'",
                 "write it as binary: pcl_convert_pcd_ascii_binary IN OUT 1");
  }
  layout.begin = header.bytes;
  layout.count = header.points;
  std::vector<NamedField> columns;
  for (const PcdColumn& column : header.columns) {
    columns.push_back({column.name, {layout.step, static_cast<ScalarType>(scalarType(column))}});
    layout.step += layout.text ? column.count : column.bytes();
  }
  const Eigen::Vector4f& at = file.sensor_origin;
  const bool known = header.height > 1 || at.head<3>() != Eigen::Vector3f::Zero();
  if (known && at.head<3>().allFinite()) layout.sensor = {at[0], at[1], at[2]};
  return setFields(columns, {"normal_x", "normal_y", "normal_z"}, use_normals, layout);
}

/** Bytes, or words, of one of a PLY's elements; 0 where lists make that differ. */
std::size_t
sizeOf(const PlyElement& element, bool text)
{
  std::size_t size = 0;
  for (const PlyProperty& property : element.properties) {
    if (property.list_type != 0) return 0;
    size += text ? 1 : scalarSize(property.type);
  }
  return size;
}

Error
plyLayout(const std::vector<unsigned char>& head, bool use_normals, RecordLayout& layout)
{
  PlyHeader header;
  if (Error error = parsePlyHeader(head, header)) return error;
  layout.text = header.form == PlyForm::kAscii;
  layout.big_endian = header.form == PlyForm::kBigEndian;
  layout.begin = header.size;
  const auto isVertex = [](const PlyElement& element) { return element.name == "vertex"; };
  const auto vertex = std::find_if(header.elements.begin(), header.elements.end(), isVertex);
  if (vertex == header.elements.end())
    return badInput("'" + layout.path + "' has no vertices; name a point cloud");
  for (auto element = header.elements.begin(); element != vertex; ++element) {
    const std::size_t size = sizeOf(*element, layout.text);
    if (size == 0 || layout.text)
      return whole(layout.path, "its vertices follow other elements", "write the vertices first");
    layout.begin += element->count * size;
  }
  layout.count = vertex->count;
  layout.step = sizeOf(*vertex, layout.text);
  if (layout.step == 0) return whole(layout.path, "its vertices have lists", "write them without");
  std::vector<NamedField> columns;
  std::size_t offset = 0;
  for (const PlyProperty& property : vertex->properties) {
    columns.push_back({property.name, {offset, static_cast<ScalarType>(property.type)}});
    offset += layout.text ? 1 : scalarSize(property.type);
  }
  if (Error error = setFields(columns, {"nx", "ny", "nz"}, use_normals, layout)) return error;
  const bool faces = std::any_of(vertex, header.elements.end(), [](const PlyElement& element) {
    return element.name == "face" && element.count > 0;
  });
  if (!faces || layout.normal || !use_normals) return {};
  return whole(layout.path, "its normals come from its faces",
               "write normals with its vertices, or give -use_normals 0");
}

Error
rawLayout(ScalarType type, std::uint64_t bytes, RecordLayout& layout)
{
  const std::size_t size = type == kFloat32 ? 4 : 8;
  layout.step = 3 * size;
  layout.count = bytes / layout.step;
  for (std::size_t a = 0; a < 3; ++a) layout.position[a] = {a * size, type};
  if (bytes % layout.step == 0) return {};
  return badInput("'" + layout.path + "' has " + std::to_string(bytes) + " bytes, no multiple of " +
                  std::to_string(layout.step) + ": it is truncated or has other values");
}

}  // namespace

bool
isRawPointFile(const std::string& path)
{
  const std::string extension = lowerExtension(path);
  return extension == ".f32" || extension == ".f64";
}

Result<RecordLayout>
recordLayoutOf(const std::string& path, bool use_normals)
{
  const std::string extension = lowerExtension(path);
  RecordLayout layout;
  layout.path = path;
  const bool raw = isRawPointFile(path);
  if (!raw && extension != ".pcd" && extension != ".ply")
    return whole(path, "it is a " + extension + " file", "convert it to a .pcd or .ply");
  std::error_code code;
  const std::uint64_t bytes = std::filesystem::file_size(path, code);
  std::ifstream file(path, std::ios::binary);
  if (!file || code) return Error{ErrorCode::kIo, "cannot read '" + path + "'; check the name"};
  std::vector<unsigned char> head(std::min<std::uint64_t>(bytes, raw ? 0 : kMostHeader));
  file.read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(head.size()));
  if (bytes == 0) return badInput("'" + path + "' is empty (0 bytes); copy it again");
  const bool doubles = extension == ".f64";
  Error error = raw                   ? rawLayout(doubles ? kFloat64 : kFloat32, bytes, layout)
                : extension == ".pcd" ? pcdLayout(head, use_normals, layout)
                                      : plyLayout(head, use_normals, layout);
  if (error) return error;
  const std::uint64_t available = bytes - std::min(bytes, layout.begin);
  if (!layout.text && available / layout.step < layout.count) {
    return badInput("'" + path + "' is truncated: " + std::to_string(available / layout.step) +
                    " of " + std::to_string(layout.count) + " points; copy it again");
  }
  return layout;
}

}  // namespace pcl_slim

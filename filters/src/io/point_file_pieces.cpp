// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/point_file_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>
#include <vector>

#include "io/pcd_file.h"
#include "io/ply_file.h"
#include "io/point_formats.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/filters/io/record_layout.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kMostHeader = 1 << 20;  ///< bytes in which a header must end

/** A column of a file: bytes, or words of a text's row. */
struct NamedField {
  std::string name;
  RecordLayout::Field field;
};

Error whole(const std::string& path, const std::string& why, const std::string& remedy) {
  return {ErrorCode::kBadArgument,
          "'" + path + "' can only be read as a whole: " + why + "; " + remedy};
}

bool findTriple(const std::vector<NamedField>& columns, const char* const (&names)[3],
                std::array<RecordLayout::Field, 3>& fields) {
  for (std::size_t a = 0; a < 3; ++a) {
    const auto isIt = [&](const NamedField& column) { return column.name == names[a]; };
    const auto at = std::find_if(columns.begin(), columns.end(), isIt);
    if (at == columns.end()) return false;
    fields[a] = at->field;
  }
  return true;
}

/** Sets coordinates and normals. */
Error setFields(const std::vector<NamedField>& columns, const char* const (&normals)[3],
                bool use_normals, RecordLayout& layout) {
  constexpr const char* kPosition[3] = {"x", "y", "z"};
  constexpr const char* kCapitals[3] = {"X", "Y", "Z"};
  if (!findTriple(columns, kPosition, layout.position) &&
      !findTriple(columns, kCapitals, layout.position))
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

Error pcdLayout(const std::vector<unsigned char>& head, bool use_normals, RecordLayout& layout) {
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
  const std::array<float, 3>& at = file.sensor_origin;
  const bool known = header.height > 1 || at != std::array<float, 3>{};
  if (known && isFinite(at)) layout.sensor = {at[0], at[1], at[2]};
  return setFields(columns, {"normal_x", "normal_y", "normal_z"}, use_normals, layout);
}

/** Bytes, or words, of one of a PLY's elements; 0 where lists make that differ. */
std::size_t sizeOf(const PlyElement& element, bool text) {
  std::size_t size = 0;
  for (const PlyProperty& property : element.properties) {
    if (property.list_type != 0) return 0;
    size += text ? 1 : scalarSize(property.type);
  }
  return size;
}

Error plyLayout(const std::vector<unsigned char>& head, bool use_normals, RecordLayout& layout) {
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
  std::vector<std::string> names;
  std::size_t offset = 0;
  for (const PlyProperty& property : vertex->properties) {
    columns.push_back({property.name, {offset, static_cast<ScalarType>(property.type)}});
    offset += layout.text ? 1 : scalarSize(property.type);
    names.push_back(property.name);
  }
  if (hasSplatFields(names))
    return whole(layout.path, "it has Gaussian splats", "save them with colours red green blue");
  if (Error error = setFields(columns, {"nx", "ny", "nz"}, use_normals, layout)) return error;
  const bool faces = std::any_of(vertex, header.elements.end(), [](const PlyElement& element) {
    return element.name == "face" && element.count > 0;
  });
  if (!faces || layout.normal || !use_normals) return {};
  return whole(layout.path, "its normals come from its faces",
               "write normals with its vertices, or give -use_normals 0");
}

Error rawLayout(ScalarType type, std::uint64_t bytes, RecordLayout& layout) {
  const std::size_t size = type == kFloat32 ? 4 : 8;
  layout.step = 3 * size;
  layout.count = bytes / layout.step;
  for (std::size_t a = 0; a < 3; ++a) layout.position[a] = {a * size, type};
  if (bytes % layout.step == 0) return {};
  return badInput("'" + layout.path + "' has " + std::to_string(bytes) + " bytes, no multiple of " +
                  std::to_string(layout.step) + ": it is truncated or has other values");
}

}  // namespace

bool isRawPointFile(const std::string& path) {
  const std::string extension = lowerExtension(path);
  return extension == ".f32" || extension == ".f64";
}

Result<RecordLayout> recordLayoutOf(const std::string& path, bool use_normals) {
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

namespace {

using Bytes = std::vector<unsigned char>;

Error whole(const std::string& path, const std::string& why) {
  return {ErrorCode::kBadArgument,
          "'" + path + "' can only be read as a whole: " + why + "; write its points as binary"};
}

/** A header with other numbers of points. \param[in] width,height of a PCD */
std::string recounted(const std::string& header, bool pcd, std::uint64_t width,
                      std::uint64_t height) {
  std::istringstream lines(header);
  std::string line, text;
  const auto isKey = [&](const char* key) { return line.rfind(key, 0) == 0; };
  while (std::getline(lines, line)) {
    if (pcd && isKey("WIDTH ")) line = "WIDTH " + std::to_string(width);
    if (pcd && isKey("HEIGHT ")) line = "HEIGHT " + std::to_string(height);
    if (pcd && isKey("POINTS ")) line = "POINTS " + std::to_string(width * height);
    if (!pcd && isKey("element vertex ")) line = "element vertex " + std::to_string(width * height);
    text += line + "\n";
  }
  return text;
}

/** The header of a file without one. */
std::string rawHeader(const RecordLayout& layout) {
  const bool floats = layout.position[0].type == kFloat32;
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex 0\n";
  for (const char* axis : {"x", "y", "z"})
    text += std::string("property ") + (floats ? "float " : "double ") + axis + "\n";
  return text + "end_header\n";
}

/** Bytes of a file up to a place. */
std::string readHead(const std::string& path, std::uint64_t bytes) {
  std::ifstream file(path, std::ios::binary);
  std::string head(static_cast<std::size_t>(bytes), '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  return head;
}

/** Bytes of a formatted file's header. */
std::size_t headerBytes(const Bytes& bytes, bool pcd) {
  const std::string last = pcd ? "\nDATA binary\n" : "\nend_header\n";
  const auto at = std::search(bytes.begin(), bytes.end(), last.begin(), last.end());
  return static_cast<std::size_t>(at - bytes.begin()) + last.size();
}

}  // namespace

Error PointFileReader::open(const std::string& path) {
  Result<RecordLayout> layout = recordLayoutOf(path, false);
  if (!layout) return layout.error();
  layout_ = *layout;
  done_ = 0;
  pcd_ = lowerExtension(path) == ".pcd";
  if (layout_.text) return whole(path, "it is text");
  width_ = layout_.count;
  height_ = 1;
  if (isRawPointFile(path)) {
    header_ = rawHeader(layout_);
    return {};
  }
  header_ = readHead(path, layout_.begin);
  if (pcd_) {
    PcdHeader header;
    PointFile file;
    if (Error error = parsePcdHeader({header_.begin(), header_.end()}, header, file)) return error;
    width_ = header.width;
    height_ = header.height;
    return {};
  }
  std::error_code code;
  const std::uint64_t bytes = std::filesystem::file_size(path, code);
  const bool only = bytes == layout_.begin + layout_.count * layout_.step;
  const bool first = header_.find("end_header") + 16 > header_.size();
  return only && first ? Error() : whole(path, "it has more than points, which would be lost");
}

std::string PointFileReader::headerFor(std::uint64_t points) const {
  return recounted(header_, pcd_, points, 1);
}

Error PointFileReader::next(std::size_t most, PointFile& piece) {
  piece = PointFile();
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(most, size() - done_));
  if (count == 0) return {};
  const std::string header = headerFor(count);
  Bytes bytes(header.begin(), header.end());
  const std::size_t wanted = count * layout_.step;
  bytes.resize(header.size() + wanted);
  std::ifstream file(layout_.path, std::ios::binary);
  const std::uint64_t at = layout_.begin + done_ * layout_.step;
  file.seekg(static_cast<std::streamoff>(at));
  file.read(reinterpret_cast<char*>(bytes.data()) + header.size(),
            static_cast<std::streamsize>(wanted));
  if (static_cast<std::size_t>(file.gcount()) != wanted) {
    return badInput("'" + layout_.path + "' ends at byte " +
                    std::to_string(at + static_cast<std::uint64_t>(file.gcount())) +
                    ", before its last point: it is truncated, copy it again");
  }
  done_ += count;
  Result<PointFile> parsed = pcd_ ? parsePcd(bytes) : parsePly(bytes);
  if (!parsed) return parsed.error();
  piece = std::move(*parsed);
  return {};
}

Error PointFileWriter::open(const std::string& path, std::uint64_t width, std::uint64_t height) {
  const std::string extension = lowerExtension(path);
  pcd_ = extension == ".pcd";
  if (!pcd_ && extension != ".ply") {
    return {ErrorCode::kBadArgument,
            "'" + path + "' cannot be written in pieces; name a .pcd or .ply file"};
  }
  width_ = width;
  height_ = height;
  begun_ = false;
  return file_.open(path);
}

Error PointFileWriter::add(const PointFile& piece) {
  if (Error error = piece.validate()) return error;
  Result<Bytes> bytes = pcd_ ? Result<Bytes>(formatPcd(piece)) : formatPly(piece);
  if (!bytes) return bytes.error();
  const std::size_t head = headerBytes(*bytes, pcd_);
  if (!begun_) {
    const std::string header(bytes->begin(), bytes->begin() + static_cast<std::ptrdiff_t>(head));
    const std::string all = recounted(header, pcd_, width_, height_);
    if (Error error = file_.write(all.data(), all.size())) return error;
    begun_ = true;
  }
  return file_.write(bytes->data() + head, bytes->size() - head);
}

Error PointFileWriter::finish() {
  return file_.finish();
}

}  // namespace pcl_slim

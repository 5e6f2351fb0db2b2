// SPDX-License-Identifier: BSD-3-Clause
#include "io/point_formats.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "io/ply/ply_header.h"
#include "io/scalar_type.h"

namespace pcl_slim {

namespace {

/** Hands out one value after another of a PLY body, whatever its form. */
class BodyReader {
 public:
  BodyReader(const std::vector<unsigned char>& bytes, std::size_t start, PlyForm form)
      : scanner_(bytes.data() + start, bytes.size() - start),
        at_(bytes.data() + start),
        end_(bytes.data() + bytes.size()),
        form_(form)
  {
  }

  /** Writes the next value in this machine's byte order. false: no more data, or not a number. */
  bool next(std::uint8_t type, std::uint8_t* value)
  {
    if (form_ == PlyForm::kAscii) {
      const char *begin = nullptr, *end = nullptr;
      if (!scanner_.nextWord(begin, end)) return false;
      malformed_ = !parseScalar(begin, end, type, value);
      return !malformed_;
    }
    const std::size_t size = scalarSize(type);
    if (size > static_cast<std::size_t>(end_ - at_)) return false;
    std::memcpy(value, at_, size);
    if (form_ == PlyForm::kBigEndian) swapBytes(value, size);
    at_ += size;
    return true;
  }

  /** A non-negative whole number of any type. */
  bool nextCount(std::uint8_t type, std::uint64_t& count)
  {
    std::uint8_t value[8];
    if (!next(type, value)) return false;
    const double number = readScalar(value, type);
    malformed_ = !(number >= 0.0 && number < 4294967295.0 && number == std::floor(number));
    count = malformed_ ? 0 : static_cast<std::uint64_t>(number);
    return !malformed_;
  }

  /** Most values of this size that can still follow. */
  std::size_t mostValues(std::size_t size) const
  {
    const std::size_t left = form_ == PlyForm::kAscii
                                 ? static_cast<std::size_t>(end_ - at_) - scanner_.position()
                                 : static_cast<std::size_t>(end_ - at_);
    return form_ == PlyForm::kAscii ? left / 2 + 1 : left / size;
  }

  /** Why the last next() failed. */
  Error failure(const std::string& element, std::size_t i, std::size_t count) const
  {
    if (malformed_) {
      return badInput(element + " " + std::to_string(i) +
                      " of the PLY file holds a value out of range; write it again");
    }
    return badInput("the PLY file is truncated: " + std::to_string(i) + " of " +
                    std::to_string(count) + " elements '" + element + "'; copy it again");
  }

 private:
  TextScanner scanner_;
  const unsigned char* at_;
  const unsigned char* end_;
  PlyForm form_;
  bool malformed_ = false;
};

/** Skips one property; false as for BodyReader. */
bool
skipProperty(BodyReader& in, const PlyProperty& property)
{
  std::uint8_t value[8];
  std::uint64_t count = 1;
  if (property.list_type != 0 && !in.nextCount(property.list_type, count)) return false;
  for (std::uint64_t k = 0; k < count; ++k) {
    if (!in.next(property.type, value)) return false;
  }
  return true;
}

Error
readVertices(BodyReader& in, const PlyElement& element, pcl::PCLPointCloud2& cloud)
{
  std::size_t smallest = 0;
  for (const PlyProperty& property : element.properties) {
    smallest += scalarSize(property.list_type != 0 ? property.list_type : property.type);
    if (property.list_type != 0) continue;
    addField(cloud, property.name, property.type);
  }
  if (element.count > 4294967294u)
    return badInput("the PLY header announces more than 2^32 - 2 points");
  if (smallest != 0 && element.count > in.mostValues(smallest)) {
    return in.failure("vertex", in.mostValues(smallest), element.count);
  }
  cloud.width = static_cast<pcl::uindex_t>(element.count);
  cloud.height = 1;
  cloud.row_step = static_cast<pcl::uindex_t>(cloud.point_step * element.count);
  cloud.is_bigendian = 0;
  cloud.data.resize(cloud.point_step * element.count);
  std::uint8_t* at = cloud.data.data();
  for (std::size_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) {
      if (property.list_type != 0) {
        if (!skipProperty(in, property)) return in.failure("vertex", i, element.count);
        continue;
      }
      if (!in.next(property.type, at)) return in.failure("vertex", i, element.count);
      at += scalarSize(property.type);
    }
  }
  return {};
}

Error
readFaces(BodyReader& in, const PlyElement& element, PointFile& file)
{
  if (element.count > in.mostValues(1)) return in.failure("face", 0, element.count);
  file.face_begin.assign(1, 0);
  file.face_begin.reserve(element.count + 1);
  for (std::size_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) {
      if (!isFaceList(property)) {
        if (!skipProperty(in, property)) return in.failure("face", i, element.count);
        continue;
      }
      std::uint64_t corners = 0, vertex = 0;
      if (!in.nextCount(property.list_type, corners)) return in.failure("face", i, element.count);
      for (std::uint64_t k = 0; k < corners; ++k) {
        if (!in.nextCount(property.type, vertex)) return in.failure("face", i, element.count);
        file.face_vertices.push_back(static_cast<std::uint32_t>(vertex));
      }
    }
    if (file.face_vertices.size() > std::numeric_limits<std::uint32_t>::max()) {
      return badInput("the PLY file has more than 2^32 - 1 face corners; use its points alone");
    }
    file.face_begin.push_back(static_cast<std::uint32_t>(file.face_vertices.size()));
  }
  return {};
}

Error
readElement(BodyReader& in, const PlyElement& element, PointFile& file)
{
  if (element.name == "vertex") return readVertices(in, element, file.cloud);
  if (element.name == "face") return readFaces(in, element, file);
  for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
    for (const PlyProperty& property : element.properties) {
      if (!skipProperty(in, property)) return in.failure(element.name, i, element.count);
    }
  }
  return {};
}

template <typename T>
void
append(std::vector<unsigned char>& bytes, T value)
{
  const auto* raw = reinterpret_cast<const unsigned char*>(&value);
  bytes.insert(bytes.end(), raw, raw + sizeof(value));
}

void
appendFaces(const PointFile& file, bool long_faces, std::vector<unsigned char>& bytes)
{
  for (std::size_t i = 0; i < file.numFaces(); ++i) {
    const std::uint32_t begin = file.face_begin[i], end = file.face_begin[i + 1];
    if (long_faces)
      append(bytes, end - begin);
    else
      append(bytes, static_cast<std::uint8_t>(end - begin));
    for (std::uint32_t k = begin; k < end; ++k) {
      append(bytes, static_cast<std::int32_t>(file.face_vertices[k]));
    }
  }
}

/** What a file contains in addition to the points and their faces, in words; none of it is kept. */
std::vector<std::string>
leftOut(const std::vector<PlyElement>& elements)
{
  std::vector<std::string> names;
  for (const PlyElement& element : elements) {
    const bool points = element.name == "vertex", faces = element.name == "face";
    if (element.count == 0) continue;
    if (!points && !faces) names.push_back("element '" + element.name + "'");
    for (const PlyProperty& property : element.properties) {
      const bool kept = points ? property.list_type == 0 : !faces || isFaceList(property);
      if (!kept) names.push_back("'" + property.name + "' of element '" + element.name + "'");
    }
  }
  return names;
}

}  // namespace

Result<PointFile>
parsePly(const std::vector<unsigned char>& bytes)
{
  PlyHeader header;
  if (Error error = parsePlyHeader(bytes, header)) return error;
  PointFile file;
  file.comments = header.comments;
  file.left_out = leftOut(header.elements);
  BodyReader in(bytes, header.size, header.form);
  for (const PlyElement& element : header.elements) {
    if (Error error = readElement(in, element, file)) return error;
  }
  const std::size_t n = numPoints(file.cloud);
  for (const std::uint32_t vertex : file.face_vertices) {
    if (vertex >= n) {
      return badInput("a face of the PLY file names vertex " + std::to_string(vertex) + " of " +
                      std::to_string(n) + "; write it again");
    }
  }
  adoptPclFields(file.cloud);
  return file;
}

Result<std::vector<unsigned char>>
formatPly(const PointFile& file)
{
  std::vector<PlyColumn> columns;
  if (Error error = plyColumns(file.cloud, columns)) return error;
  bool long_faces = false;
  for (std::size_t i = 0; i < file.numFaces(); ++i) {
    long_faces = long_faces || file.face_begin[i + 1] - file.face_begin[i] > 255;
  }
  const std::size_t n = numPoints(file.cloud);
  const std::string header =
      formatPlyHeader(file.comments, columns, n, file.numFaces(), long_faces);
  std::vector<unsigned char> bytes(header.begin(), header.end());
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint8_t* row = file.cloud.data.data() + i * file.cloud.point_step;
    for (const PlyColumn& column : columns) {
      const std::uint8_t* from = row + column.offset;
      bytes.insert(bytes.end(), from, from + scalarSize(column.type));
    }
  }
  appendFaces(file, long_faces, bytes);
  return bytes;
}

}  // namespace pcl_slim

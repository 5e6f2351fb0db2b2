// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstring>
#include <limits>
#include <locale>
#include <sstream>

#include "io/pcd_file.h"
#include "io/ply_file.h"
#include "io/point_formats.h"

namespace pcl_slim::detail {

bool decodeLzf(const std::uint8_t* packed, std::size_t packed_size, std::uint8_t* plain,
               std::size_t size) {
  constexpr unsigned int kMostLiterals = 32, kLongMatch = 7;
  std::size_t in = 0, out = 0;
  while (in < packed_size) {
    const unsigned int control = packed[in++];
    if (control < kMostLiterals) {
      const std::size_t count = control + 1;
      if (count > packed_size - in || count > size - out) return false;
      std::memcpy(plain + out, packed + in, count);
      in += count;
      out += count;
      continue;
    }
    // A match: three bits of length, thirteen of distance; long ones have a byte more.
    std::size_t count = control >> 5;
    if (count == kLongMatch && in < packed_size) count += packed[in++];
    if (in == packed_size) return false;
    const std::size_t distance = (std::size_t{control & 31u} << 8 | packed[in++]) + 1;
    count += 2;
    if (distance > out || count > size - out) return false;
    for (const std::size_t end = out + count; out < end; ++out) plain[out] = plain[out - distance];
  }
  return out == size;
}

}  // namespace pcl_slim::detail

namespace pcl_slim {

namespace {

bool parseViewpoint(const std::vector<std::string>& words, PointFile& file) {
  if (words.size() != 8) return false;
  float v[7];
  for (int i = 0; i < 7; ++i) {
    const std::string& word = words[static_cast<std::size_t>(i) + 1];
    if (!parseScalar(word.data(), word.data() + word.size(), kFloat32,
                     reinterpret_cast<std::uint8_t*>(&v[i]))) {
      return false;
    }
  }
  file.sensor_origin = {v[0], v[1], v[2]};
  file.sensor_orientation = {v[3], v[4], v[5], v[6]};
  return true;
}

/** One header line that lists something for every field. */
bool parseColumnLine(const std::vector<std::string>& words, PcdHeader& header) {
  const std::string& key = words[0];
  const std::size_t n = words.size() - 1;
  if (key == "FIELDS" || key == "COLUMNS") {
    header.columns.resize(n);
    for (std::size_t i = 0; i < n; ++i) header.columns[i].name = words[i + 1];
    return n > 0;
  }
  if (n != header.columns.size()) return false;
  for (std::size_t i = 0; i < n; ++i) {
    PcdColumn& column = header.columns[i];
    const std::string& word = words[i + 1];
    if (key == "TYPE") column.type = word[0];
    if (key == "SIZE" && (!parseCount(word, column.size) || column.size > 8)) return false;
    if (key == "COUNT" && (!parseCount(word, column.count) || column.count > 65536)) return false;
  }
  return true;
}

/** Reads one header line. false: it makes no sense. */
bool parseHeaderLine(const std::string& line, PcdHeader& header, PointFile& file) {
  if (!line.empty() && line[0] == '#') {
    const std::size_t text = line.find_first_not_of("# \t");
    const std::string comment = text == std::string::npos ? "" : line.substr(text);
    if (comment.rfind(".PCD v", 0) != 0) file.comments.push_back(comment);  // the format's own line
    return true;
  }
  const std::vector<std::string> words = splitWords(line);
  if (words.empty() || words[0] == "VERSION") return true;
  const std::string& key = words[0];
  if (key == "VIEWPOINT") return parseViewpoint(words, file);
  if (key == "FIELDS" || key == "COLUMNS" || key == "SIZE" || key == "TYPE" || key == "COUNT") {
    return parseColumnLine(words, header);
  }
  if (words.size() != 2) return false;
  if (key == "WIDTH") return header.has_width = parseCount(words[1], header.width);
  if (key == "HEIGHT") return parseCount(words[1], header.height);
  if (key == "POINTS") return header.has_points = parseCount(words[1], header.points);
  if (key == "DATA") header.data = words[1];
  return key == "DATA";
}

/** Whether every field has values that are numbers, and a point of them a size that fields can be
 * addressed in. */
Error checkColumns(const std::vector<PcdColumn>& columns) {
  constexpr std::size_t kMostBytes = std::numeric_limits<std::int32_t>::max();
  std::size_t bytes = 0;
  for (const PcdColumn& column : columns) {
    const std::string field = "the PCD field '" + column.name + "' has a ";
    if (column.size == 0) {
      return badInput(
          field + "SIZE of 0: give it a value a point, or take it out of the header and the data");
    }
    if (!column.isPadding() && scalarType(column) == 0) {
      return badInput(field +
                      "TYPE and SIZE that do not go together: use F 4 or 8, I or U 1, 2, 4 or 8");
    }
    bytes += column.bytes();
    if (bytes > kMostBytes)
      return badInput("a point of the PCD file has more than 2 GiB: check COUNT");
  }
  return {};
}

Error checkHeader(PcdHeader& header) {
  // Drivers of some lidars write padding of no values, which takes no bytes.
  const auto isEmpty = [](const PcdColumn& column) { return column.count == 0; };
  for (const PcdColumn& column : header.columns) {
    const std::string& name = column.name;
    if (isEmpty(column) && (name == "x" || name == "y" || name == "z"))
      return badInput("the PCD field '" + name + "' has a COUNT of 0: give it a value a point");
  }
  header.columns.erase(std::remove_if(header.columns.begin(), header.columns.end(), isEmpty),
                       header.columns.end());
  if (header.columns.empty()) return badInput("the PCD header lists no FIELDS: name x, y and z");
  const auto isPadding = [](const PcdColumn& column) { return column.isPadding(); };
  if (std::all_of(header.columns.begin(), header.columns.end(), isPadding)) {
    return badInput("the FIELDS of the PCD header are all padding: name x, y and z");
  }
  if (!header.has_width && !header.has_points)
    return badInput("the PCD header gives no WIDTH: add the number of points");
  if (!header.has_width) header.width = header.points;
  constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max() - 1;
  if (header.width > kMost || header.height > kMost ||
      (header.width != 0 && header.height > kMost / header.width)) {
    return badInput("the PCD header announces more than 2^32 - 2 points: check WIDTH and HEIGHT");
  }
  if (header.has_points && header.points != header.width * header.height) {
    return badInput("the PCD header contradicts itself: POINTS " + std::to_string(header.points) +
                    " is not WIDTH times HEIGHT: copy it again, or mend what is wrong");
  }
  header.points = header.width * header.height;
  return checkColumns(header.columns);
}

char typeLetter(std::uint8_t type) {
  if (type == kFloat32 || type == kFloat64) return 'F';
  return type == kInt8 || type == kInt16 || type == kInt32 || type == kInt64 ? 'I' : 'U';
}

}  // namespace

std::size_t PcdHeader::step() const {
  std::size_t step = 0;
  for (const PcdColumn& column : columns) step += column.bytes();
  return step;
}

std::uint8_t scalarType(const PcdColumn& column) {
  const std::size_t s = column.size;
  if (column.type == 'F') return s == 4 ? kFloat32 : s == 8 ? kFloat64 : 0;
  if (column.type == 'I') {
    return s == 1 ? kInt8 : s == 2 ? kInt16 : s == 4 ? kInt32 : s == 8 ? kInt64 : 0;
  }
  if (column.type == 'U') {
    return s == 1 ? kUInt8 : s == 2 ? kUInt16 : s == 4 ? kUInt32 : s == 8 ? kUInt64 : 0;
  }
  return 0;
}

Error parsePcdHeader(const std::vector<unsigned char>& bytes, PcdHeader& header, PointFile& file) {
  TextScanner scanner(bytes.data(), bytes.size());
  int line_number = 0;
  for (std::string line; header.data.empty() && scanner.nextLine(line);) {
    ++line_number;
    if (!parseHeaderLine(line, header, file)) {
      return badInput("line " + std::to_string(line_number) +
                      " is not part of a PCD header: mend it, or write the file again");
    }
  }
  if (header.data.empty()) return badInput("it has no complete PCD header; name a PCD file");
  header.bytes = scanner.position();
  return checkHeader(header);
}

namespace {

/** Fields and size of the cloud that a header announces; its data stay empty. */
void describeFields(const PcdHeader& header, PointTable& cloud) {
  for (const PcdColumn& column : header.columns) {
    if (!column.isPadding()) addField(cloud, column.name, scalarType(column), column.count);
  }
  cloud.width = static_cast<std::uint32_t>(header.width);
  cloud.height = static_cast<std::uint32_t>(header.height);
}

/** The header of a file to write, with binary data. */
std::string formatPcdHeader(const PointFile& file) {
  const PointTable& cloud = file.cloud;
  std::ostringstream names, sizes, types, counts, out;
  out.imbue(std::locale::classic());
  out.precision(9);
  for (const PointField& field : cloud.fields) {
    names << ' ' << field.name;
    sizes << ' ' << scalarSize(field.datatype);
    types << ' ' << typeLetter(field.datatype);
    counts << ' ' << std::max<std::size_t>(field.count, 1);
  }
  const auto& o = file.sensor_origin;
  const auto& q = file.sensor_orientation;
  out << "# .PCD v0.7 - Point Cloud Data file format\n";
  for (const std::string& comment : file.comments) out << "# " << comment << '\n';
  out << "VERSION 0.7\nFIELDS" << names.str() << "\nSIZE" << sizes.str() << "\nTYPE" << types.str()
      << "\nCOUNT" << counts.str() << "\nWIDTH " << cloud.width << "\nHEIGHT " << cloud.height
      << "\nVIEWPOINT " << o[0] << ' ' << o[1] << ' ' << o[2] << ' ' << q[0] << ' ' << q[1] << ' '
      << q[2] << ' ' << q[3] << "\nPOINTS " << numPoints(cloud) << "\nDATA binary\n";
  return out.str();
}

Error truncated(const std::string& unit, std::size_t have, std::size_t want) {
  return badInput("the PCD file is truncated: " + std::to_string(have) + " of " +
                  std::to_string(want) + " " + unit + "; copy it again");
}

Error tooMany(std::size_t points) {
  return badInput("the PCD header announces " + std::to_string(points) +
                  " points, and more follow: correct WIDTH, HEIGHT and POINTS, or copy it again");
}

Error readAscii(const std::uint8_t* payload, std::size_t size, const PcdHeader& header,
                PointTable& cloud) {
  // Every value takes a character and a separator: no allocation for a header that only boasts.
  std::size_t values = 0;
  for (const PcdColumn& column : header.columns) values += column.count;
  if (values > 0 && header.points > (size / 2 + 1) / values)
    return truncated("points", 0, header.points);
  cloud.data.resize(header.points * cloud.point_step);
  TextScanner scanner(payload, size);
  std::uint8_t* at = cloud.data.data();
  for (std::size_t i = 0; i < header.points; ++i) {
    for (const PcdColumn& column : header.columns) {
      for (std::size_t k = 0; k < column.count; ++k) {
        const char *begin = nullptr, *end = nullptr;
        if (!scanner.nextWord(begin, end)) return truncated("points", i, header.points);
        if (column.isPadding()) continue;
        if (!parseScalar(begin, end, scalarType(column), at)) {
          return badInput("field '" + column.name + "' of point " + std::to_string(i) +
                          " of the PCD file is not a number of its type: mend '" +
                          std::string(begin, end) + "'");
        }
        at += column.size;
      }
    }
  }
  const char *begin = nullptr, *end = nullptr;
  return values > 0 && scanner.nextWord(begin, end) ? tooMany(header.points) : Error();
}

/** Copies columns out of rows (row by row data) or out of column-major data. */
void copyColumns(const PcdHeader& header, const std::uint8_t* source, bool column_major,
                 PointTable& cloud) {
  const std::size_t file_step = header.step();
  std::size_t file_offset = 0, offset = 0;
  for (const PcdColumn& column : header.columns) {
    const std::size_t width = column.bytes();
    const std::uint8_t* from = source + file_offset * (column_major ? header.points : 1);
    const std::size_t step = column_major ? width : file_step;
    file_offset += width;
    if (column.isPadding()) continue;
    for (std::size_t i = 0; i < header.points; ++i) {
      std::memcpy(cloud.data.data() + i * cloud.point_step + offset, from + i * step, width);
    }
    offset += width;
  }
}

Error readBinary(const std::uint8_t* payload, std::size_t size, const PcdHeader& header,
                 PointTable& cloud) {
  const std::size_t step = header.step();
  if (step != 0 && header.points > size / step)
    return truncated("points", size / step, header.points);
  if (step != 0 && header.points < size / step) return tooMany(header.points);
  cloud.data.resize(header.points * cloud.point_step);
  if (step == cloud.point_step) {
    std::copy(payload, payload + header.points * step, cloud.data.begin());
  } else {
    copyColumns(header, payload, false, cloud);
  }
  return {};
}

Error readCompressed(const std::uint8_t* payload, std::size_t size, const PcdHeader& header,
                     PointTable& cloud) {
  const std::size_t step = header.step();
  std::uint32_t compressed = 0, plain = 0;
  if (header.points == 0) return {};
  if (size < 8) return truncated("bytes of compressed data", size, 8);
  std::memcpy(&compressed, payload, 4);
  std::memcpy(&plain, payload + 4, 4);
  if (compressed > size - 8) return truncated("bytes of compressed data", size - 8, compressed);
  if (plain != header.points * step) {
    return badInput(
        "the PCD file's compressed data do not hold the points its header announces; copy it "
        "again");
  }
  std::vector<std::uint8_t> columns(plain);
  if (!detail::decodeLzf(payload + 8, compressed, columns.data(), plain)) {
    // What cannot be compressed is stored as it is by some writers.
    const bool stored = compressed == plain;
    if (stored) std::copy_n(payload + 8, plain, columns.begin());
    if (!stored) return badInput("the PCD file's compressed data are corrupted; copy it again");
  }
  cloud.data.resize(header.points * cloud.point_step);
  copyColumns(header, columns.data(), true, cloud);
  return {};
}

}  // namespace

Result<PointFile> parsePcd(const std::vector<unsigned char>& bytes) {
  PointFile file;
  PcdHeader header;
  if (Error error = parsePcdHeader(bytes, header, file)) return error;
  describeFields(header, file.cloud);
  const std::uint8_t* payload = bytes.data() + header.bytes;
  const std::size_t size = bytes.size() - header.bytes;
  Error error;
  if (header.data == "ascii")
    error = readAscii(payload, size, header, file.cloud);
  else if (header.data == "binary")
    error = readBinary(payload, size, header, file.cloud);
  else if (header.data == "binary_compressed")
    error = readCompressed(payload, size, header, file.cloud);
  else
    error = badInput("the PCD data form '" + header.data +
                     "' is unknown; use ascii, binary or binary_compressed");
  if (error) return error;
  adoptCapitals(file.cloud);
  return file;
}

std::vector<unsigned char> formatPcd(const PointFile& file) {
  const PointTable& cloud = file.cloud;
  const std::string header = formatPcdHeader(file);
  std::vector<unsigned char> bytes(header.begin(), header.end());
  std::size_t step = 0;
  for (const auto& field : cloud.fields) {
    step += scalarSize(field.datatype) * std::max<std::size_t>(field.count, 1);
  }
  const std::size_t n = numPoints(cloud), start = bytes.size();
  if (n == 0) return bytes;
  bytes.resize(start + n * step);
  std::size_t offset = start;
  for (const auto& field : cloud.fields) {
    const std::size_t width = scalarSize(field.datatype) * std::max<std::size_t>(field.count, 1);
    const std::uint8_t* from = cloud.data.data() + field.offset;
    for (std::size_t i = 0; i < n; ++i) {
      std::memcpy(bytes.data() + offset + i * step, from + i * cloud.point_step, width);
    }
    offset += width;
  }
  return bytes;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include <zlib.h>
#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "io/point_formats.h"
#include "io/vtp/vtp.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kMostCompression = 1100;  ///< zlib packs a byte no denser than 1032 to 1

Error damaged(const VtpArray& array) {
  return {ErrorCode::kBadInput, "the VTP file's array '" + array.name +
                                    "' is truncated or corrupted; copy it again or write it anew"};
}

int base64Value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

/** A stream of bytes out of base64 or raw text. */
class ByteSource {
 public:
  ByteSource(std::string_view text, bool base64) : text_(text), base64_(base64) {}

  /** \brief Appends count bytes, of whole groups: what is left of the last one is padding. false:
   * too few, or no base64. */
  bool read(std::size_t count, std::vector<std::uint8_t>& bytes) {
    if (!base64_) return readRaw(count, bytes);
    if (count / 3 > text_.size() / 4) return false;
    for (std::size_t left = count; left > 0;) {
      if (text_.size() < 4) return false;
      std::uint32_t group = 0;
      for (int i = 0; i < 4; ++i) {
        const int value = text_[i] == '=' ? 0 : base64Value(text_[i]);
        if (value < 0) return false;
        group = group << 6 | static_cast<std::uint32_t>(value);
      }
      text_.remove_prefix(4);
      for (int i = 0; i < 3 && left > 0; ++i, --left) {
        bytes.push_back(static_cast<std::uint8_t>(group >> (16 - 8 * i)));
      }
    }
    return true;
  }

 private:
  bool readRaw(std::size_t count, std::vector<std::uint8_t>& bytes) {
    if (count > text_.size()) return false;
    bytes.insert(bytes.end(), text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(count));
    text_.remove_prefix(count);
    return true;
  }

  std::string_view text_;
  bool base64_;
};

/** The next count header words. */
bool readHeader(ByteSource& source, const VtpMarkup& markup, std::size_t count,
                std::vector<std::uint64_t>& words) {
  const std::size_t size = markup.wide_headers ? 8 : 4;
  std::vector<std::uint8_t> bytes;
  if (!source.read(count * size, bytes)) return false;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t word = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const std::size_t from = markup.big_endian ? k : size - 1 - k;
      word = word << 8 | bytes[i * size + from];
    }
    words.push_back(word);
  }
  return true;
}

/** Blocks packed by zlib: number of blocks, bytes of a block, bytes of the last one, packed sizes.
 */
bool readPacked(std::string_view text, const VtpMarkup& markup, bool base64, std::size_t most,
                std::vector<std::uint8_t>& bytes) {
  ByteSource peek(text, base64);
  std::vector<std::uint64_t> words;
  if (!readHeader(peek, markup, 3, words)) return false;
  const std::uint64_t blocks = words[0], block = words[1], last = words[2];
  if (blocks > text.size() || last > block || last > most) return false;
  const std::uint64_t whole = last > 0 && blocks > 0 ? blocks - 1 : blocks;
  if (whole > 0 && (block == 0 || whole > (most - last) / block)) return false;
  ByteSource source(text, base64);
  words.clear();
  if (!readHeader(source, markup, 3 + blocks, words)) return false;
  std::uint64_t packed_size = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    if (words[3 + b] > text.size()) return false;
    packed_size += words[3 + b];
  }
  std::vector<std::uint8_t> packed;
  if (packed_size > text.size() || !source.read(packed_size, packed)) return false;
  const std::uint8_t* at = packed.data();
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t size = b < whole ? block : last, begin = bytes.size();
    if (size > kMostCompression * (words[3 + b] + 1))
      return false;  // before memory is allocated for it
    bytes.resize(begin + size);
    auto filled = static_cast<uLongf>(size);
    if (uncompress(bytes.data() + begin, &filled, at, static_cast<uLong>(words[3 + b])) != Z_OK ||
        filled != size) {
      return false;
    }
    at += words[3 + b];
  }
  return true;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r\n") + 1 - begin);
}

Result<std::vector<std::uint8_t>> readAsciiValues(const VtpArray& array, std::size_t count) {
  TextScanner scanner(reinterpret_cast<const unsigned char*>(array.inline_data.data()),
                      array.inline_data.size());
  const std::size_t size = scalarSize(array.type);
  if (count > array.inline_data.size()) return damaged(array);
  std::vector<std::uint8_t> bytes(count * size);
  for (std::size_t i = 0; i < count; ++i) {
    const char *begin = nullptr, *end = nullptr;
    if (!scanner.nextWord(begin, end) ||
        !parseScalar(begin, end, array.type, bytes.data() + i * size)) {
      return damaged(array);
    }
  }
  return bytes;
}

/** The bytes of an array: of inline or appended data, base64 or raw, packed by zlib or not.
 * \param[in] expected how many; 0: as many as there are, up to a thousand times the file's. */
Result<std::vector<std::uint8_t>> readVtpBytes(const VtpMarkup& markup, const VtpArray& array,
                                               std::size_t expected) {
  const bool appended = array.format == VtpArray::Format::kAppended;
  const bool base64 = !appended || markup.appended_base64;
  std::string_view text = appended ? markup.appended : trimmed(array.inline_data);
  if (appended) {
    if (array.offset > text.size()) return damaged(array);
    text.remove_prefix(array.offset);
  }
  const std::size_t most = expected > 0 ? expected : kMostCompression * text.size();
  std::vector<std::uint8_t> bytes;
  if (markup.zlib) {
    if (!readPacked(text, markup, base64, most, bytes)) return damaged(array);
  } else {
    // Here header and data are one base64 stream.
    ByteSource peek(text, base64), source(text, base64);
    std::vector<std::uint64_t> words;
    const std::size_t header = markup.wide_headers ? 8 : 4;
    if (!readHeader(peek, markup, 1, words) || words[0] > most ||
        !source.read(header + words[0], bytes)) {
      return damaged(array);
    }
    bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(header));
  }
  if (expected > 0 && bytes.size() != expected) return damaged(array);
  return bytes;
}

/** The values of an array of numbers, count of them, each in its type and this machine's byte
 * order. */
Result<std::vector<std::uint8_t>> readVtpValues(const VtpMarkup& markup, const VtpArray& array,
                                                std::size_t count) {
  if (count == 0) return std::vector<std::uint8_t>();
  if (array.format == VtpArray::Format::kAscii) return readAsciiValues(array, count);
  const std::size_t size = scalarSize(array.type);
  auto bytes = readVtpBytes(markup, array, count * size);
  if (!bytes || !markup.big_endian) return bytes;
  for (std::size_t i = 0; i < count; ++i) swapBytes(bytes->data() + i * size, size);
  return bytes;
}

/** The strings of an array: VTK ends each with a zero byte. */
Result<std::vector<std::string>> readVtpStrings(const VtpMarkup& markup, const VtpArray& array) {
  std::vector<std::uint8_t> bytes;
  if (array.format == VtpArray::Format::kAscii) {
    TextScanner scanner(reinterpret_cast<const unsigned char*>(array.inline_data.data()),
                        array.inline_data.size());
    const char *begin = nullptr, *end = nullptr;
    while (scanner.nextWord(begin, end)) {
      std::uint8_t byte = 0;
      if (!parseScalar(begin, end, kUInt8, &byte)) return damaged(array);
      bytes.push_back(byte);
    }
  } else {
    auto read = readVtpBytes(markup, array, 0);
    if (!read) return read.error();
    bytes = std::move(*read);
  }
  std::vector<std::string> strings(1);
  for (const std::uint8_t byte : bytes) {
    if (byte == 0)
      strings.emplace_back();
    else
      strings.back().push_back(static_cast<char>(byte));
  }
  strings.pop_back();
  return strings;
}

constexpr std::size_t kMost =
    4294967294u;  ///< points, or bytes of one, that PCL's clouds can count

const VtpArray* findArray(const VtpMarkup& markup, const char* section, const std::string& name) {
  for (const VtpArray& array : markup.arrays) {
    if (array.section == section && (name.empty() || array.name == name)) return &array;
  }
  return nullptr;
}

/** An array of three bytes a point, or of one, by name. */
const VtpArray* findBytes(const VtpMarkup& markup, const char* name, std::size_t components) {
  const VtpArray* array = findArray(markup, "PointData", name);
  const bool fits = array && array->type == kUInt8 && array->components == components;
  return fits ? array : nullptr;
}

/** Brings the arrays of a file into the fields of a cloud. */
class FieldReader {
 public:
  FieldReader(const VtpMarkup& markup, PointFile& file) : markup_(markup), file_(file) {
    const VtpArray* const normals =
        findArray(markup, "PointData", markup.normals.empty() ? kVtpNormalArray : markup.normals);
    if (normals && normals->components == 3 && normals->type != 0) normals_ = normals;
    colors_ = findBytes(markup, kVtpColorArray, 3);
    if (colors_) alpha_ = findBytes(markup, kVtpAlphaArray, 1);
  }

  /** \brief Coordinates first, then the arrays of the points in their order. */
  Error read() {
    points_ = findArray(markup_, "Points", "");
    if (points_ == nullptr || points_->components != 3 || points_->type == 0)
      return badInput("the VTP file holds no points; name one that does");
    addTriple(kVtpCoordinates, *points_);
    for (const VtpArray& array : markup_.arrays) {
      if (array.section == "PointData") declare(array);
    }
    return fill();
  }

 private:
  /** Where an array goes within a point: values of one type next to each other. */
  struct Column {
    const VtpArray* array;
    std::size_t offset;
  };

  void addTriple(const char* const (&names)[3], const VtpArray& array) {
    columns_.push_back({&array, file_.cloud.point_step});
    for (const char* name : names) addField(file_.cloud, name, array.type);
  }

  void declare(const VtpArray& array) {
    if (array.type == 0 || array.name.empty()) {
      file_.left_out.push_back("array '" + array.name + "'");
    } else if (&array == normals_) {
      addTriple(kVtpNormals, array);
    } else if (&array == colors_) {
      columns_.push_back({&array, file_.cloud.point_step});
      addField(file_.cloud, alpha_ ? "rgba" : "rgb", alpha_ ? kUInt32 : kFloat32);
    } else if (&array == alpha_) {
      columns_.push_back({&array, 0});
    } else {
      columns_.push_back({&array, file_.cloud.point_step});
      addField(file_.cloud, array.name, array.type, array.components);
    }
  }

  /** Reads all arrays before memory is taken for the points that the file announces. */
  Error fill() {
    const std::size_t n = markup_.points;
    std::size_t step = 0;
    std::vector<std::vector<std::uint8_t>> values;
    for (const Column& column : columns_) {
      auto bytes = readVtpValues(markup_, *column.array, n * column.array->components);
      if (!bytes) return bytes.error();
      values.push_back(std::move(*bytes));
      step += bytesOf(*column.array);
    }
    if (std::max(n, step) > kMost)
      return badInput("the VTP file has 2^32 - 1 points, or bytes of a point, or more; divide it");
    file_.cloud.resize(n);
    for (std::size_t k = 0; k < columns_.size(); ++k) scatter(columns_[k], values[k]);
    return {};
  }

  void scatter(const Column& column, const std::vector<std::uint8_t>& values) {
    PointTable& cloud = file_.cloud;
    const std::size_t tuple = bytesOf(*column.array);
    const bool alpha = column.array == alpha_, color = column.array == colors_;
    const std::size_t offset = alpha ? colorOffset() + 3 : column.offset;
    for (std::size_t i = 0; i < markup_.points; ++i) {
      const std::uint8_t* from = values.data() + i * tuple;
      std::uint8_t* to = cloud.data.data() + i * cloud.point_step + offset;
      if (color)
        std::reverse_copy(from, from + 3, to);
      else
        std::memcpy(to, from, tuple);
    }
  }

  static std::size_t bytesOf(const VtpArray& array) {
    return array.components * scalarSize(array.type);
  }

  std::size_t colorOffset() const {
    const auto is_color = [this](const Column& column) { return column.array == colors_; };
    return std::find_if(columns_.begin(), columns_.end(), is_color)->offset;
  }

  const VtpMarkup& markup_;
  PointFile& file_;
  const VtpArray *points_ = nullptr, *normals_ = nullptr, *colors_ = nullptr, *alpha_ = nullptr;
  std::vector<Column> columns_;
};

/** Whole numbers of an array. */
Result<std::vector<std::uint64_t>> readCounts(const VtpMarkup& markup, const VtpArray* array,
                                              std::size_t count) {
  if (array == nullptr || (array->type != kInt64 && array->type != kInt32))
    return badInput("the VTP file has faces without whole numbers; write it again");
  const auto bytes = readVtpValues(markup, *array, count);
  if (!bytes) return bytes.error();
  std::vector<std::uint64_t> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double value = readScalar(bytes->data() + i * scalarSize(array->type), array->type);
    if (!(value >= 0 && value <= std::numeric_limits<std::uint32_t>::max()))
      return badInput("the VTP file's faces have a number out of range; write it again");
    values[i] = static_cast<std::uint64_t>(value);
  }
  return values;
}

Error readFaces(const VtpMarkup& markup, PointFile& file) {
  if (markup.polygons == 0) return {};
  const auto ends = readCounts(markup, findArray(markup, "Polys", "offsets"), markup.polygons);
  if (!ends) return ends.error();
  const auto corners = readCounts(markup, findArray(markup, "Polys", "connectivity"), ends->back());
  if (!corners) return corners.error();
  const bool sorted = std::is_sorted(ends->begin(), ends->end());
  const auto isMissing = [&](std::uint64_t vertex) { return vertex >= markup.points; };
  if (!sorted || std::any_of(corners->begin(), corners->end(), isMissing))
    return badInput("the VTP file's faces name vertices that it does not have; write it again");
  file.face_begin.assign(1, 0);
  file.face_begin.insert(file.face_begin.end(), ends->begin(), ends->end());
  file.face_vertices.assign(corners->begin(), corners->end());
  return {};
}

}  // namespace

Result<PointFile> parseVtp(const std::vector<unsigned char>& bytes) {
  const auto markup = parseVtpMarkup({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (!markup) return markup.error();
  PointFile file;
  file.left_out = markup->left_out;
  if (Error error = FieldReader(*markup, file).read()) return error;
  if (Error error = readFaces(*markup, file)) return error;
  const VtpArray* const comments = findArray(*markup, "FieldData", kVtpCommentArray);
  if (comments != nullptr && comments->type == 0) {
    auto lines = readVtpStrings(*markup, *comments);
    if (!lines) return lines.error();
    file.comments = std::move(*lines);
  }
  return file;
}

}  // namespace pcl_slim

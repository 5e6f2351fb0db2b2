// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <unordered_set>

#include "io/ply_file.h"
#include "io/point_formats.h"
#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

namespace {

/** Whether a face's property lists its vertices. */
bool isFaceList(const PlyProperty& property) {
  return property.list_type != 0 &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

struct TypeName {
  const char *old_name, *new_name;
  std::uint8_t type;
};

constexpr TypeName kTypeNames[] = {{"char", "int8", kInt8},        {"uchar", "uint8", kUInt8},
                                   {"short", "int16", kInt16},     {"ushort", "uint16", kUInt16},
                                   {"int", "int32", kInt32},       {"uint", "uint32", kUInt32},
                                   {"float", "float32", kFloat32}, {"double", "float64", kFloat64}};

std::uint8_t typeByName(const std::string& name) {
  for (const TypeName& entry : kTypeNames) {
    if (name == entry.old_name || name == entry.new_name) return entry.type;
  }
  return 0;
}

const char* nameOfType(std::uint8_t type) {
  for (const TypeName& entry : kTypeNames) {
    if (type == entry.type) return entry.old_name;
  }
  return "";
}

bool parseFormat(const std::vector<std::string>& words, PlyForm& form) {
  if (words.size() != 3) return false;
  if (words[1] == "ascii")
    form = PlyForm::kAscii;
  else if (words[1] == "binary_little_endian")
    form = PlyForm::kLittleEndian;
  else if (words[1] == "binary_big_endian")
    form = PlyForm::kBigEndian;
  else
    return false;
  return true;
}

bool parseElement(const std::vector<std::string>& words, PlyHeader& header) {
  std::size_t count = 0;
  if (words.size() != 3 || !parseCount(words[2], count)) return false;
  header.elements.push_back({words[1], count, {}});
  return true;
}

bool parseProperty(const std::vector<std::string>& words, PlyHeader& header) {
  if (header.elements.empty()) return false;
  PlyProperty property;
  if (words.size() == 5 && words[1] == "list") {
    property = {words[4], typeByName(words[3]), typeByName(words[2])};
    if (property.list_type == 0) return false;
  } else if (words.size() == 3) {
    property = {words[2], typeByName(words[1]), 0};
  }
  if (property.type == 0) return false;
  header.elements.back().properties.push_back(property);
  return true;
}

/** One line after the first. false: it makes no sense. */
bool parseLine(const std::string& line, PlyHeader& header) {
  const std::vector<std::string> words = splitWords(line);
  if (words.empty() || words[0] == "obj_info") return true;
  if (words[0] == "comment") {
    const std::size_t text = line.find_first_not_of(" \t", line.find("comment") + 7);
    header.comments.push_back(text == std::string::npos ? "" : line.substr(text));
    return true;
  }
  if (words[0] == "format") return parseFormat(words, header.form);
  if (words[0] == "element") return parseElement(words, header);
  return words[0] == "property" && parseProperty(words, header);
}

constexpr std::size_t kMostBlank = 10000;  ///< empty lines of a header

/** A property that occurs twice would overwrite itself. */
Error checkElements(const std::vector<PlyElement>& elements) {
  std::unordered_set<std::string> names;
  for (const PlyElement& element : elements) {
    const auto& properties = element.properties;
    if (std::count_if(properties.begin(), properties.end(), isFaceList) > 1) {
      return badInput("the PLY header lists the vertices of a '" + element.name +
                      "' twice; keep one list");
    }
    if (!names.insert(element.name).second) {
      return badInput("the PLY header has two elements '" + element.name + "'; keep one");
    }
  }
  return {};
}

}  // namespace

Error parsePlyHeader(const std::vector<unsigned char>& bytes, PlyHeader& header) {
  TextScanner scanner(bytes.data(), bytes.size());
  std::string line;
  if (!scanner.nextLine(line) || splitWords(line) != std::vector<std::string>{"ply"}) {
    return badInput("not a PLY file: it does not start with 'ply'; name a PLY file");
  }
  std::size_t blank = 0;
  for (int number = 2; scanner.nextLine(line); ++number) {
    if (line.empty() && ++blank > kMostBlank) {
      return badInput("the PLY header has more than " + std::to_string(kMostBlank) +
                      " empty lines: it is damaged, copy the file again");
    }
    if (splitWords(line) == std::vector<std::string>{"end_header"}) {
      header.size = scanner.position();
      return checkElements(header.elements);
    }
    if (!parseLine(line, header)) {
      return badInput("line " + std::to_string(number) +
                      " is not part of a PLY header: mend it, or write the file again");
    }
  }
  return badInput("the PLY file is truncated inside its header; copy it again");
}

namespace {

std::string formatPlyHeader(const std::vector<std::string>& comments,
                            const std::vector<PlyColumn>& columns, std::size_t num_points,
                            std::size_t num_faces, bool long_faces) {
  std::string out = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& comment : comments) out += "comment " + comment + "\n";
  out += "element vertex " + std::to_string(num_points) + "\n";
  for (const PlyColumn& column : columns) {
    out += "property " + std::string(nameOfType(column.type)) + " " + column.name + "\n";
  }
  if (num_faces > 0) {
    out += "element face " + std::to_string(num_faces) + "\nproperty list " +
           (long_faces ? "uint" : "uchar") + " int vertex_indices\n";
  }
  return out + "end_header\n";
}

/** Hands out one value after another of a PLY body, whatever its form. */
class BodyReader {
 public:
  BodyReader(const std::vector<unsigned char>& bytes, std::size_t start, PlyForm form)
      : scanner_(bytes.data() + start, bytes.size() - start),
        at_(bytes.data() + start),
        end_(bytes.data() + bytes.size()),
        form_(form) {}

  /** Writes the next value in this machine's byte order. false: no more data, or not a number. */
  bool next(std::uint8_t type, std::uint8_t* value) {
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
  bool nextCount(std::uint8_t type, std::uint64_t& count) {
    std::uint8_t value[8];
    if (!next(type, value)) return false;
    const double number = readScalar(value, type);
    malformed_ = !(number >= 0.0 && number < 4294967295.0 && number == std::floor(number));
    count = malformed_ ? 0 : static_cast<std::uint64_t>(number);
    return !malformed_;
  }

  /** Most values of this size that can still follow. */
  std::size_t mostValues(std::size_t size) const {
    const std::size_t left = form_ == PlyForm::kAscii
                                 ? static_cast<std::size_t>(end_ - at_) - scanner_.position()
                                 : static_cast<std::size_t>(end_ - at_);
    return form_ == PlyForm::kAscii ? left / 2 + 1 : left / size;
  }

  /** Whether all that follows the header has been read: text may end with blanks, bytes with a line
   * end. */
  Error checkEnd() {
    const char *begin = nullptr, *end = nullptr;
    const bool more = form_ == PlyForm::kAscii ? scanner_.nextWord(begin, end) : end_ - at_ > 2;
    if (!more) return {};
    return badInput(
        "more follows the last element that the PLY header announces: correct its numbers of "
        "elements, or copy the file again");
  }

  /** Why the last next() failed. */
  Error failure(const std::string& element, std::size_t i, std::size_t count) const {
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
bool skipProperty(BodyReader& in, const PlyProperty& property) {
  std::uint8_t value[8];
  std::uint64_t count = 1;
  if (property.list_type != 0 && !in.nextCount(property.list_type, count)) return false;
  for (std::uint64_t k = 0; k < count; ++k) {
    if (!in.next(property.type, value)) return false;
  }
  return true;
}

Error readVertices(BodyReader& in, const PlyElement& element, PointTable& cloud) {
  std::size_t smallest = 0;
  for (const PlyProperty& property : element.properties) {
    smallest += scalarSize(property.list_type != 0 ? property.list_type : property.type);
    if (property.list_type != 0) continue;
    addField(cloud, property.name, property.type);
  }
  if (element.count > 0 && cloud.fields.empty())
    return badInput("the PLY vertices have no numbers; name a file of points with x, y and z");
  if (element.count > 4294967294u)
    return badInput("the PLY header announces more than 2^32 - 2 points");
  if (smallest != 0 && element.count > in.mostValues(smallest)) {
    return in.failure("vertex", in.mostValues(smallest), element.count);
  }
  cloud.resize(element.count);
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

Error readFaces(BodyReader& in, const PlyElement& element, PointFile& file) {
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

Error readElement(BodyReader& in, const PlyElement& element, PointFile& file) {
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
void append(std::vector<unsigned char>& bytes, T value) {
  const auto* raw = reinterpret_cast<const unsigned char*>(&value);
  bytes.insert(bytes.end(), raw, raw + sizeof(value));
}

void appendFaces(const PointFile& file, bool long_faces, std::vector<unsigned char>& bytes) {
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
std::vector<std::string> leftOut(const std::vector<PlyElement>& elements) {
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

Result<PointFile> parsePly(const std::vector<unsigned char>& bytes) {
  PlyHeader header;
  if (Error error = parsePlyHeader(bytes, header)) return error;
  PointFile file;
  file.comments = header.comments;
  file.left_out = leftOut(header.elements);
  BodyReader in(bytes, header.size, header.form);
  for (const PlyElement& element : header.elements) {
    if (Error error = readElement(in, element, file)) return error;
  }
  if (Error error = in.checkEnd()) return error;
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

Result<std::vector<unsigned char>> formatPly(const PointFile& file) {
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

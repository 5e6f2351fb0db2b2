// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/point_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <sstream>
#include <string>
#include <type_traits>
#include <unordered_set>

#include "io/laz/laz.h"
#include "io/point_formats.h"
#include "io/vtp/vtp.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/surface/surface_io.h"

namespace pcl_slim {

namespace {

template <typename T>
bool parseAs(const char* begin, const char* end, std::uint8_t* at) {
  if (begin != end && *begin == '+') ++begin;
  T value{};
  auto [stop, code] = std::from_chars(begin, end, value);
  if constexpr (std::is_floating_point_v<T>) {
    // Values beyond the type's range are written by some programs; they become infinite or zero.
    if (code == std::errc::result_out_of_range) {
      double wide = 0.0;
      if (std::from_chars(begin, end, wide).ec == std::errc()) value = static_cast<T>(wide);
      code = std::errc();
    }
  } else if (code == std::errc() && stop != end) {  // an integer written as 1.0 or 1e3
    double wide = 0.0;
    const auto again = std::from_chars(begin, end, wide);
    stop = again.ptr;
    // The largest integer of 64 bits is no double: values below the next power of two fit.
    const double behind = std::ldexp(1.0, std::numeric_limits<T>::digits);
    if (!(wide >= static_cast<double>(std::numeric_limits<T>::min()) && wide < behind)) {
      return false;
    }
    value = static_cast<T>(wide);
  }
  std::memcpy(at, &value, sizeof(value));
  return code == std::errc() && stop == end;
}

bool isSpace(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f';
}

}  // namespace

void adoptCapitals(PointTable& cloud) {
  constexpr const char* kSmall[] = {"x", "y", "z"};
  constexpr const char* kCapital[] = {"X", "Y", "Z"};
  for (std::size_t a = 0; a < 3; ++a) {
    if (findField(cloud, kSmall[a]) >= 0 || findField(cloud, kCapital[a]) < 0) return;
  }
  for (std::size_t a = 0; a < 3; ++a)
    cloud.fields[static_cast<std::size_t>(findField(cloud, kCapital[a]))].name = kSmall[a];
}

bool parseScalar(const char* begin, const char* end, std::uint8_t type, std::uint8_t* at) {
  switch (type) {
    case kInt8: return parseAs<std::int8_t>(begin, end, at);
    case kUInt8:
    case kBool: return parseAs<std::uint8_t>(begin, end, at);
    case kInt16: return parseAs<std::int16_t>(begin, end, at);
    case kUInt16: return parseAs<std::uint16_t>(begin, end, at);
    case kInt32: return parseAs<std::int32_t>(begin, end, at);
    case kUInt32: return parseAs<std::uint32_t>(begin, end, at);
    case kFloat32: return parseAs<float>(begin, end, at);
    case kFloat64: return parseAs<double>(begin, end, at);
    case kInt64: return parseAs<std::int64_t>(begin, end, at);
    case kUInt64: return parseAs<std::uint64_t>(begin, end, at);
    default: return false;
  }
}

std::string formatScalar(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof(buffer), "%.17g", value);
  std::string text = buffer;
  std::replace(text.begin(), text.end(), ',', '.');  // some locales write commas
  return text;
}

void swapBytes(std::uint8_t* at, std::size_t size) {
  std::reverse(at, at + size);
}

bool parseCount(const std::string& word, std::size_t& count) {
  double value = 0;
  std::uint64_t whole = 0;
  const char *begin = word.data(), *end = begin + word.size();
  const bool valid = parseScalar(begin, end, kFloat64, reinterpret_cast<std::uint8_t*>(&value)) &&
                     value == std::floor(value) &&
                     parseScalar(begin, end, kUInt64, reinterpret_cast<std::uint8_t*>(&whole));
  count = static_cast<std::size_t>(whole);
  return valid;
}

char lineEndOf(const char* begin, const char* end) {
  const char* const first = std::find_if(begin, end, [](char c) { return c == '\n' || c == '\r'; });
  const bool alone = first != end && *first == '\r' && (first + 1 == end || first[1] != '\n');
  return alone ? '\r' : '\n';
}

bool TextScanner::nextLine(std::string& line) {
  if (at_ == end_) return false;
  const char* stop =
      static_cast<const char*>(std::memchr(at_, line_end_, static_cast<std::size_t>(end_ - at_)));
  if (!stop) stop = end_;
  const char* text_end = stop;
  if (text_end != at_ && text_end[-1] == '\r') --text_end;
  line.assign(at_, text_end);
  at_ = stop == end_ ? end_ : stop + 1;
  return true;
}

bool TextScanner::nextWord(const char*& begin, const char*& end) {
  while (at_ != end_ && isSpace(*at_)) ++at_;
  begin = at_;
  while (at_ != end_ && !isSpace(*at_)) ++at_;
  end = at_;
  return begin != end;
}

std::vector<std::string> splitWords(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

namespace {

using Bytes = std::vector<unsigned char>;

Result<PointFile> parseLaz(const Bytes& bytes) {
  const Result<Bytes> las = unpackLaz(bytes);
  return las ? parseLas(*las) : las.error();
}

struct Format {
  const char* extension;
  Result<PointFile> (*parse)(const Bytes& bytes);
};

constexpr Format kFormats[] = {{".pcd", parsePcd}, {".ply", parsePly}, {".las", parseLas},
                               {".ptx", parsePtx}, {".obj", parseObj}, {".off", parseOff},
                               {".stl", parseStl}, {".vtp", parseVtp}, {".laz", parseLaz}};

struct TextFormat {
  const char* extension;
  TextKind kind;
};

constexpr TextFormat kTextFormats[] = {
    {".xyz", TextKind::kAny},       {".txt", TextKind::kAny},       {".asc", TextKind::kAny},
    {".csv", TextKind::kAny},       {".neu", TextKind::kAny},       {".pts", TextKind::kPts},
    {".xyzrgb", TextKind::kXyzRgb}, {".xyzn", TextKind::kXyzNormal}};

/** The first line of text that is no comment and not empty. */
std::string firstLine(const Bytes& bytes) {
  constexpr std::size_t kMost = 1 << 16;
  TextScanner scanner(bytes.data(), std::min(bytes.size(), kMost));
  std::string line;
  while (scanner.nextLine(line) && (splitWords(line).empty() || line[0] == '#')) line.clear();
  return line;
}

/** Whether the points behind a LAS header are compressed, whatever the file's name. */
bool isCompressedLas(const Bytes& bytes) {
  constexpr std::size_t kFormat = 104;  // its highest bit
  return bytes.size() > kFormat && (bytes[kFormat] & 0x80) != 0;
}

/** Whether text begins with two lines of one number and one of three, as a .ptx does. */
bool isPtx(const Bytes& bytes) {
  constexpr std::size_t kMost = 1 << 12;
  TextScanner scanner(bytes.data(), std::min(bytes.size(), kMost));
  std::string line;
  std::size_t number = 0;
  for (const std::size_t words : {1u, 1u, 3u}) {
    if (!scanner.nextLine(line) || splitWords(line).size() != words) return false;
    if (words == 1 && !parseCount(splitWords(line)[0], number)) return false;
  }
  return true;
}

/** The extension that the content of a file shows, for what has no name: .xyz where nothing else
 * does. */
std::string extensionOf(const Bytes& bytes) {
  constexpr std::size_t kStlHead = 84, kStlFacet = 50;
  const auto beginsWith = [&bytes](const std::string& text) {
    return bytes.size() >= text.size() && std::equal(text.begin(), text.end(), bytes.begin());
  };
  if (beginsWith("LASF")) return isCompressedLas(bytes) ? ".laz" : ".las";
  if (isSlim(bytes.data(), bytes.size())) return ".slim";
  if (beginsWith("<?xml") || beginsWith("<VTKFile")) return ".vtp";
  std::uint32_t facets = 0;
  if (bytes.size() >= kStlHead) std::memcpy(&facets, bytes.data() + kStlHead - 4, sizeof(facets));
  if (facets > 0 && bytes.size() == kStlHead + kStlFacet * std::size_t{facets}) return ".stl";
  if (isPtx(bytes)) return ".ptx";
  const std::vector<std::string> words = splitWords(firstLine(bytes));
  const std::string first = words.empty() ? "" : words[0];
  if (first == "ply") return ".ply";
  if (first == "VERSION" || first == "FIELDS" || first == "COLUMNS") return ".pcd";
  if (first == "solid") return ".stl";
  if (first == "v" || first == "vn" || first == "mtllib" || first == "o") return ".obj";
  for (const char* off : {"OFF", "COFF", "NOFF", "CNOFF"})
    if (first == off) return ".off";
  return ".xyz";
}

/** What to do with a file that is not read, or not in this build. */
Error refused(const std::string& path, const std::string& extension) {
  const std::string stem = path.substr(0, path.size() - extension.size());
  if (extension == ".vtp") return checkVtp(path);
  if (path == "-") return {ErrorCode::kBadArgument, "to read a pipe, name /dev/stdin"};
  if (extension == ".laz") return checkLaz(path);
  if (extension == ".e57") {
    return {ErrorCode::kBadArgument,
            "'" + path + "' is not read as it is; convert it: pdal translate '" + path + "' '" +
                stem + ".las', or by pye57 of Python (docs/point_files.md)"};
  }
  return {ErrorCode::kBadArgument,
          "cannot tell the format of '" + path +
              "'; name a .pcd, .ply, .las, .xyz, .xyzrgb, .xyzn, .txt, .asc, .csv, .neu, .pts, "
              ".ptx, .obj, .off, .stl or .vtp file"};
}

bool isNameless(const std::string& path) {
  return isStream(path) && lowerExtension(path).empty();
}

const TextFormat* textFormatOf(const std::string& extension) {
  for (const TextFormat& format : kTextFormats) {
    if (extension == format.extension) return &format;
  }
  return nullptr;
}

const Format* formatOf(const std::string& path, const std::string& extension) {
  for (const Format& format : kFormats) {
    const bool missing =
        (extension == ".vtp" && checkVtp(path)) || (extension == ".laz" && checkLaz(path));
    if (extension == format.extension && !missing) return &format;
  }
  return nullptr;
}

Result<PointFile> parseBytes(const std::string& path, const std::string& extension,
                             const Bytes& bytes, const PointFileOptions& options) {
  if (const TextFormat* text = textFormatOf(extension))
    return parseText(bytes, text->kind, options.columns);
  if (!options.columns.empty()) {
    return Error{ErrorCode::kBadArgument,
                 "a " + extension + " file says what its values are; leave -columns out"};
  }
  if (extension == ".ply") {
    Result<PointFile> file = parsePly(bytes);
    if (file) adoptSplats(options.min_opacity, *file);
    return file;
  }
  return formatOf(path, extension)->parse(bytes);
}

}  // namespace

namespace {

/** Names of fields become words, no two alike, and comments lines, as all formats can write them. */
void makeWords(PointFile& file) {
  std::unordered_set<std::string> names;
  for (PointField& field : file.cloud.fields) {
    for (char& c : field.name) {
      if (static_cast<unsigned char>(c) <= ' ' || c == '\x7f') c = '_';
    }
    // A PCD field of the name "_" is padding, which readers drop.
    if (field.name.empty() || field.name == "_") field.name = "unnamed";
    while (!names.insert(field.name).second) field.name += '_';
  }
  for (std::string& comment : file.comments) {
    for (char& c : comment) {
      if (c == '\r' || c == '\n') c = ' ';
    }
  }
}

}  // namespace

Error checkPointFileExtension(const std::string& path) {
  if (isNameless(path)) return {};
  const std::string extension = lowerExtension(path);
  const bool known = textFormatOf(extension) || formatOf(path, extension);
  return known ? Error() : refused(path, extension);
}

Result<PointFile> parsePointFile(const std::string& path, const std::vector<unsigned char>& bytes,
                                 const PointFileOptions& options) {
  if (bytes.empty())
    return Error{ErrorCode::kBadInput, "'" + path + "' is empty (0 bytes); copy it again"};
  std::string extension = isNameless(path) ? extensionOf(bytes) : lowerExtension(path);
  if (extension == ".las" && isCompressedLas(bytes)) extension = ".laz";
  if (extension == ".slim") {
    return Error{ErrorCode::kBadInput, "'" + path + "' is a surface, not points; name a scan"};
  }
  if (textFormatOf(extension) == nullptr && formatOf(path, extension) == nullptr)
    return refused(path, extension);
  Result<PointFile> file = parseBytes(path, extension, bytes, options);
  if (file) {
    makeWords(*file);
    return file;
  }
  return Error{file.error().code, "'" + path + "': " + file.error().message};
}

Result<PointFile> loadPointFile(const std::string& path, const PointFileOptions& options) {
  if (Error error = checkPointFileExtension(path)) return error;
  const Result<Bytes> bytes = readFile(path);
  return bytes ? parsePointFile(path, *bytes, options) : bytes.error();
}

Error savePointFile(const std::string& path, const PointFile& file) {
  const std::string extension = lowerExtension(path);
  if (Error error = file.validate()) return error;
  if (extension == ".pcd") {
    const Bytes bytes = formatPcd(file);
    return writeFile(path, bytes.data(), bytes.size());
  }
  if (extension == ".ply" || extension == ".las") {
    const Result<Bytes> bytes = extension == ".ply" ? formatPly(file) : formatLas(file);
    return bytes ? writeFile(path, bytes->data(), bytes->size()) : bytes.error();
  }
  if (extension == ".vtp") return saveVtp(path, file);
  return {ErrorCode::kBadArgument,
          "cannot tell the format of '" + path + "'; name a .pcd, .ply, .las or .vtp file"};
}

bool PointFile::hasSensorPose() const {
  constexpr float kSame = 1e-5f;
  const PointFile unknown;
  const auto same = [](float a, float b) { return std::abs(a - b) <= kSame; };
  return !std::equal(sensor_origin.begin(), sensor_origin.end(), unknown.sensor_origin.begin(),
                     same) ||
         !std::equal(sensor_orientation.begin(), sensor_orientation.end(),
                     unknown.sensor_orientation.begin(), same);
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/surface_files.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "io/point_formats.h"
#include "io/trim_fields.h"
#include "io/vtp/vtp.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/surface/surface_io.h"

namespace pcl_slim {

namespace {

constexpr int kMetadataVersion = 1;
constexpr const char* kPrefix = "pcl_slim";

std::string formatted(const std::array<double, 3>& v) {
  return formatScalar(v[0]) + " " + formatScalar(v[1]) + " " + formatScalar(v[2]);
}

bool parse(const std::string& word, double& value) {
  return parseScalar(word.data(), word.data() + word.size(), kFloat64,
                     reinterpret_cast<std::uint8_t*>(&value)) &&
         std::isfinite(value);
}

bool parse(const std::string& word, std::uint64_t& value) {
  return parseScalar(word.data(), word.data() + word.size(), kUInt64,
                     reinterpret_cast<std::uint8_t*>(&value));
}

bool parse(const std::string& word, bool& value) {
  value = word == "1";
  return value || word == "0";
}

bool parse(const std::string& word, WeightKernel& kernel) {
  std::uint64_t value = 0;
  if (!parse(word, value)) return false;
  kernel = static_cast<WeightKernel>(value);
  return value == 2 || value == 4 || value == 7 || value == 16;
}

bool parse(const std::string& word, int& value) {
  std::uint64_t whole = 0;
  if (!parse(word, whole) || whole > 1000000) return false;
  value = static_cast<int>(whole);
  return true;
}

bool parse(const std::vector<std::string>& words, std::array<double, 3>& v) {
  return words.size() == 5 && parse(words[2], v[0]) && parse(words[3], v[1]) &&
         parse(words[4], v[2]);
}

/** Sets the value of one line. Unknown keys are ignored: they are of other versions. */
bool parseLine(const std::vector<std::string>& words, SurfaceMetadata& metadata, int& version) {
  SurfaceInfo& info = metadata.info;
  const std::string& key = words[1];
  if (key == "origin") return parse(words, info.origin);
  if (key == "shift") return parse(words, metadata.shift);
  if (words.size() != 3) return false;
  const std::string& value = words[2];
  if (key == "version") return parse(value, version);
  if (key == "degree")
    return parse(value, info.degree) && info.degree >= 1 && info.degree <= kMaxDegree;
  if (key == "fit_kernel") return parse(value, info.fit_kernel);
  if (key == "blend_kernel") return parse(value, info.blend_kernel);
  if (key == "oriented") return parse(value, info.oriented);
  if (key == "sides_in_doubt") return parse(value, info.sides_in_doubt);
  if (key == "paper_mode") return parse(value, info.paper_mode);
  if (key == "scale") return parse(value, info.scale) && info.scale > 0.0;
  if (key == "diagonal") return parse(value, info.diagonal);
  if (key == "lambda") return parse(value, info.lambda);
  if (key == "correlation") return parse(value, info.correlation) && info.correlation >= 1.0;
  if (key == "penalty") return parse(value, info.penalty);
  if (key == "t_mdl") return parse(value, info.t_mdl);
  if (key == "alpha") return parse(value, info.cover_radius);
  if (key == "gamma") return parse(value, info.cover_threshold);
  if (key == "num_points") return parse(value, info.num_points);
  return true;
}

}  // namespace

std::vector<std::string> toComments(const SurfaceMetadata& metadata) {
  const SurfaceInfo& info = metadata.info;
  std::vector<std::string> lines;
  const auto add = [&lines](const char* key, const std::string& value) {
    lines.push_back(std::string(kPrefix) + " " + key + " " + value);
  };
  add("version", std::to_string(kMetadataVersion));
  add("degree", std::to_string(info.degree));
  add("fit_kernel", std::to_string(static_cast<int>(info.fit_kernel)));
  add("blend_kernel", std::to_string(static_cast<int>(info.blend_kernel)));
  add("oriented", info.oriented ? "1" : "0");
  add("sides_in_doubt", info.sides_in_doubt ? "1" : "0");
  add("paper_mode", info.paper_mode ? "1" : "0");
  add("origin", formatted(info.origin));
  add("scale", formatScalar(info.scale));
  add("diagonal", formatScalar(info.diagonal));
  add("lambda", formatScalar(info.lambda));
  if (info.correlation > 1) add("correlation", formatScalar(info.correlation));
  add("penalty", formatScalar(info.penalty));
  add("t_mdl", formatScalar(info.t_mdl));
  add("alpha", formatScalar(info.cover_radius));
  add("gamma", formatScalar(info.cover_threshold));
  add("num_points", std::to_string(info.num_points));
  add("shift", formatted(metadata.shift));
  return lines;
}

Error fromComments(const std::vector<std::string>& comments, SurfaceMetadata& metadata,
                   bool& found) {
  found = false;
  int version = 0;
  for (const std::string& comment : comments) {
    const std::vector<std::string> words = splitWords(comment);
    if (words.size() < 3 || words[0] != kPrefix) continue;
    found = true;
    if (!parseLine(words, metadata, version)) {
      return {ErrorCode::kBadInput,
              "the comment line '" + comment + "' has no usable value; write the file again"};
    }
    if (version > kMetadataVersion) {
      return {ErrorCode::kBadInput, "its surfels have format version " + std::to_string(version) +
                                        ", newer than the " + std::to_string(kMetadataVersion) +
                                        " this program reads; use a newer pcl_slim"};
    }
  }
  return {};
}

Error checkSurfaceExtension(const std::string& path) {
  const std::string extension = lowerExtension(path);
  if (extension == ".vtp" || extension == ".pvtp") return checkVtp(path);
  for (const char* known : {".pcd", ".ply", ".slim"}) {
    if (extension == known) return {};
  }
  return {ErrorCode::kBadArgument, "cannot tell the surface format of '" + path +
                                       "'; name a .pcd, .ply, .vtp, .pvtp or .slim file"};
}

namespace {

/** Writes points in pieces as VTK's parallel XML PolyData: NAME.pvtp, and NAME_0.vtp ... in the
 * folder NAME. */
class VtpIndex {
 public:
  explicit VtpIndex(const std::string& path);

  /** Writes a piece. */
  Error add(const PointFile& piece);
  /** Writes the index: the arrays that all pieces have. */
  Error finish();

 private:
  std::string path_, name_, folder_;
  std::size_t pieces_ = 0;
  std::vector<VtpColumn> columns_;
};

namespace fs = std::filesystem;

/** Names of the types as VTK's files have them. */
const char* typeName(std::uint8_t type) {
  switch (type) {
    case kInt8: return "Int8";
    case kUInt8:
    case kBool: return "UInt8";
    case kInt16: return "Int16";
    case kUInt16: return "UInt16";
    case kInt32: return "Int32";
    case kUInt32: return "UInt32";
    case kFloat32: return "Float32";
    case kInt64: return "Int64";
    case kUInt64: return "UInt64";
    default: return "Float64";
  }
}

std::string arrayTag(const VtpColumn& column) {
  return std::string("      <PDataArray type=\"") + typeName(column.type) + "\" Name=\"" +
         column.name + "\" NumberOfComponents=\"" + std::to_string(column.components) + "\"/>\n";
}

constexpr const char* kEntities[][2] = {
    {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&apos;", "'"}, {"&amp;", "&"}};

/** Replaces what XML has other words for by these, or, from the second form on, back. */
std::string translated(const std::string& text, std::size_t from) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const auto* const found =
        std::find_if(std::begin(kEntities), std::end(kEntities), [&](const char* const(&e)[2]) {
          return text.compare(at, std::strlen(e[from]), e[from]) == 0;
        });
    const bool plain = found == std::end(kEntities);
    result += plain ? std::string(1, text[at]) : (*found)[1 - from];
    at += plain ? 1 : std::strlen((*found)[from]);
  }
  return result;
}

bool isSame(const VtpColumn& a, const VtpColumn& b) {
  return a.name == b.name && a.type == b.type && a.components == b.components;
}

VtpIndex::VtpIndex(const std::string& path)
    : path_(path),
      name_(fs::path(path).stem().string()),
      folder_((fs::path(path).parent_path() / name_).string()) {}

Error VtpIndex::add(const PointFile& piece) {
  std::error_code code;
  if (fs::exists(folder_, code) && !fs::is_directory(folder_, code)) {
    return {ErrorCode::kIo, "cannot write '" + path_ + "': '" + folder_ +
                                "' is in the place of the folder for its pieces; name another"};
  }
  fs::create_directory(folder_, code);
  if (code) {
    return {ErrorCode::kIo,
            "cannot make the folder '" + folder_ + "': " + code.message() + "; name another place"};
  }
  const auto columns = vtpColumns(piece);
  if (!columns) return columns.error();
  if (pieces_ == 0) columns_ = *columns;
  const auto isMissing = [&](const VtpColumn& own) {
    return std::none_of(columns->begin(), columns->end(),
                        [&](const VtpColumn& other) { return isSame(own, other); });
  };
  columns_.erase(std::remove_if(columns_.begin(), columns_.end(), isMissing), columns_.end());
  return saveVtp(folder_ + "/" + name_ + "_" + std::to_string(pieces_++) + ".vtp", piece);
}

Error VtpIndex::finish() {
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PPolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "  <PPolyData GhostLevel=\"0\">\n    <PPointData";
  for (const VtpColumn& column : columns_) {
    if (column.name == kVtpNormalArray) text += std::string(" Normals=\"") + column.name + "\"";
  }
  text += ">\n";
  for (const VtpColumn& column : columns_) text += arrayTag(column);
  text +=
      "    </PPointData>\n    <PPoints>\n" + arrayTag({"Points", kFloat32, 3}) + "    </PPoints>\n";
  for (std::size_t k = 0; k < pieces_; ++k) {
    const std::string source = name_ + "/" + name_ + "_" + std::to_string(k) + ".vtp";
    text += "    <Piece Source=\"" + translated(source, 1) + "\"/>\n";
  }
  text += "  </PPolyData>\n</VTKFile>\n";
  return writeFile(path_, text.data(), text.size());
}

/** The files that an index names, in their order; an error where it names none. */
Result<std::vector<std::string>> vtpPieces(const std::string& path) {
  const auto bytes = readFile(path);
  if (!bytes) return bytes.error();
  const std::string text(bytes->begin(), bytes->end()), mark = "<Piece Source=\"";
  std::vector<std::string> pieces;
  if (text.find("PPolyData") != std::string::npos) {
    for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at)) {
      at += mark.size();
      const std::size_t end = text.find('"', at);
      if (end == std::string::npos) break;
      pieces.push_back(
          (fs::path(path).parent_path() / translated(text.substr(at, end - at), 0)).string());
    }
  }
  if (pieces.empty()) return badInput("'" + path + "' names no pieces; write it again");
  return pieces;
}

/** A surface's surfels as points, and all further data as comments. */
PointFile pointsOf(const SLIMSurface& surface) {
  PointFile file;
  file.comments = toComments(toPointTable(surface, file.cloud));
  addTrimComments(surface, file.comments);
  return file;
}

/** The surface of all pieces of an index. */
Result<SLIMSurface> loadPieces(const std::string& path) {
  const auto pieces = vtpPieces(path);
  if (!pieces) return pieces.error();
  SLIMSurface surface;
  for (const std::string& piece : *pieces) {
    const Result<SLIMSurface> read = loadSurface(piece);
    if (!read) return read.error();
    if (!surface.empty() &&
        (read->info.degree != surface.info.degree || read->info.scale != surface.info.scale ||
         read->info.origin != surface.info.origin))
      return badInput("'" + piece + "' is of another surface than the pieces before it");
    surface.append(*read);
  }
  surface.buildLinks();
  return surface;
}

}  // namespace

Error saveSurface(const std::string& path, const SLIMSurface& surface,
                  const SlimRounding& rounding) {
  if (Error error = checkSurfaceExtension(path)) return error;
  if (Error error = surface.validate()) return error;
  const std::string extension = lowerExtension(path);
  if (extension == ".slim") return saveSlim(path, surface, rounding);
  if (rounding.share > 0.0 || rounding.color_error > 0)
    return {ErrorCode::kBadArgument, "'" + path + "' keeps floats; round a .slim file instead"};
  const PointFile file = pointsOf(surface);
  if (extension != ".pvtp") return savePointFile(path, file);
  VtpIndex index(path);
  if (Error error = index.add(file)) return error;
  return index.finish();
}

Error saveSurfacePieces(const std::string& path, SlimBlockReader& blocks) {
  if (Error error = checkVtp(path)) return error;
  VtpIndex index(path);
  std::vector<bool> one(blocks.directory().blocks.size(), false);
  for (std::size_t b = 0; b < one.size(); ++b) {
    one[b] = true;
    const Result<SLIMSurface> surface = blocks.load(one);
    one[b] = false;
    if (!surface) return surface.error();
    if (Error error = index.add(pointsOf(*surface))) return error;
  }
  return index.finish();
}

Result<SLIMSurface> surfaceFrom(const PointFile& file) {
  SurfaceMetadata metadata;
  bool found = false;
  if (Error error = fromComments(file.comments, metadata, found)) return error;
  Result<SLIMSurface> surface = surfaceFrom(file.cloud, found ? &metadata : nullptr);
  if (surface) takeTrimComments(file.comments, *surface);
  return surface;
}

Result<SLIMSurface> loadSurface(const std::string& path) {
  const std::string extension = lowerExtension(path);
  const bool nameless = isStream(path) && extension.empty();
  if (!nameless) {
    if (Error error = checkSurfaceExtension(path)) return error;
  }
  if (extension == ".pvtp") return loadPieces(path);
  const Result<std::vector<unsigned char>> bytes = readFile(path);
  if (!bytes) return bytes.error();
  const auto named = [&path](const Error& error) {
    return Error{error.code, "'" + path + "': " + error.message};
  };
  if (extension == ".slim" || (nameless && isSlim(bytes->data(), bytes->size()))) {
    Result<SLIMSurface> surface = decodeSlim(bytes->data(), bytes->size());
    return surface ? std::move(surface) : named(surface.error());
  }
  const Result<PointFile> file = parsePointFile(path, *bytes);
  if (!file) return file.error();
  Result<SLIMSurface> surface = surfaceFrom(*file);
  return surface ? std::move(surface) : named(surface.error());
}

}  // namespace pcl_slim

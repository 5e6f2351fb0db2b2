// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/surface_files.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "io/scalar_type.h"
#include "io/surface/trim_fields.h"
#include "io/vtp/vtp_file.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/filters/io/surface_conversion.h"
#include "pcl_slim/surface/surface_io.h"

namespace pcl_slim {

Error
checkSurfaceExtension(const std::string& path)
{
  const std::string extension = lowerExtension(path);
  if (extension == ".vtp" || extension == ".pvtp") return checkVtp(path);
  for (const char* known : {".pcd", ".ply", ".slim"}) {
    if (extension == known) return {};
  }
  return {ErrorCode::kBadArgument, "cannot tell the surface format of '" + path +
                                       "'; name a .pcd, .ply, .vtp, .pvtp or .slim file"};
}

namespace {

/** Writes points in pieces as VTK's parallel XML PolyData: NAME.pvtp, and NAME_0.vtp ... in the folder NAME. */
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
const char*
typeName(std::uint8_t type)
{
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

std::string
arrayTag(const VtpColumn& column)
{
  return std::string("      <PDataArray type=\"") + typeName(column.type) + "\" Name=\"" +
         column.name + "\" NumberOfComponents=\"" + std::to_string(column.components) + "\"/>\n";
}

constexpr const char* kEntities[][2] = {
    {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&apos;", "'"}, {"&amp;", "&"}};

/** Replaces what XML has other words for by these, or, from the second form on, back. */
std::string
translated(const std::string& text, std::size_t from)
{
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

bool
isSame(const VtpColumn& a, const VtpColumn& b)
{
  return a.name == b.name && a.type == b.type && a.components == b.components;
}

VtpIndex::VtpIndex(const std::string& path)
    : path_(path),
      name_(fs::path(path).stem().string()),
      folder_((fs::path(path).parent_path() / name_).string())
{
}

Error
VtpIndex::add(const PointFile& piece)
{
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

Error
VtpIndex::finish()
{
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
Result<std::vector<std::string>>
vtpPieces(const std::string& path)
{
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
PointFile
pointsOf(const SLIMSurface& surface)
{
  PointFile file;
  file.comments = toComments(toPCL(surface, file.cloud));
  addTrimComments(surface, file.comments);
  return file;
}

/** The surface of all pieces of an index. */
Result<SLIMSurface>
loadPieces(const std::string& path)
{
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

Error
saveSurface(const std::string& path, const SLIMSurface& surface, double rounding)
{
  if (Error error = checkSurfaceExtension(path)) return error;
  if (Error error = surface.validate()) return error;
  const std::string extension = lowerExtension(path);
  if (extension == ".slim") return saveSlim(path, surface, rounding);
  if (rounding > 0.0)
    return {ErrorCode::kBadArgument, "'" + path + "' keeps floats; round a .slim file instead"};
  const PointFile file = pointsOf(surface);
  if (extension != ".pvtp") return savePointFile(path, file);
  VtpIndex index(path);
  if (Error error = index.add(file)) return error;
  return index.finish();
}

Error
saveSurfacePieces(const std::string& path, SlimBlockReader& blocks)
{
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

Result<SLIMSurface>
surfaceFrom(const PointFile& file)
{
  SurfaceMetadata metadata;
  bool found = false;
  if (Error error = fromComments(file.comments, metadata, found)) return error;
  Result<SLIMSurface> surface = fromPCL(file.cloud, found ? &metadata : nullptr);
  if (surface) takeTrimComments(file.comments, *surface);
  return surface;
}

Result<SLIMSurface>
loadSurface(const std::string& path)
{
  if (Error error = checkSurfaceExtension(path)) return error;
  const std::string extension = lowerExtension(path);
  if (extension == ".slim") return loadSlim(path);
  if (extension == ".pvtp") return loadPieces(path);
  const Result<PointFile> file = loadPointFile(path);
  if (!file) return file.error();

  Result<SLIMSurface> surface = surfaceFrom(*file);
  if (surface) return surface;
  return Error{surface.error().code, "'" + path + "': " + surface.error().message};
}

}  // namespace pcl_slim

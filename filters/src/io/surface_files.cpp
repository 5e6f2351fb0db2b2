// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/surface_files.h"

#include "io/surface/trim_fields.h"
#include "io/vtp/vtp_file.h"
#include "io/vtp/vtp_index.h"
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

/** A surface's surfels as points, and what they alone do not say as comments. */
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

// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/io/surface_files.h"

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
  if (extension == ".vtp") return checkVtp(path);
  for (const char* known : {".pcd", ".ply", ".slim"}) {
    if (extension == known) return {};
  }
  return {ErrorCode::kBadArgument, "cannot tell the surface format of '" + path +
                                       "'; name a .pcd, .ply, .vtp or .slim file"};
}

Error
saveSurface(const std::string& path, const SLIMSurface& surface, double rounding)
{
  if (Error error = checkSurfaceExtension(path)) return error;
  if (Error error = surface.validate()) return error;
  const std::string extension = lowerExtension(path);
  if (extension == ".slim") return saveSlim(path, surface, rounding);
  if (rounding > 0.0)
    return {ErrorCode::kBadArgument, "'" + path + "' keeps floats; round a .slim file instead"};
  PointFile file;
  file.comments = toComments(toPCL(surface, file.cloud));
  addTrimComments(surface, file.comments);
  return savePointFile(path, file);
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
  const Result<PointFile> file = loadPointFile(path);
  if (!file) return file.error();

  Result<SLIMSurface> surface = surfaceFrom(*file);
  if (surface) return surface;
  return Error{surface.error().code, "'" + path + "': " + surface.error().message};
}

}  // namespace pcl_slim

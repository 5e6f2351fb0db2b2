// SPDX-License-Identifier: BSD-3-Clause
#include "scan/surface_input.h"

#include <utility>
#include <vector>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/surface/surface_io.h"

namespace pcl_slim {

namespace {

Error named(const std::string& path, const Error& error) {
  return {error.code, "'" + path + "': " + error.message};
}

}  // namespace

Result<ModelFile> readModelFile(const std::string& path, const PointFileOptions& options) {
  if (checkPointFileExtension(path)) {
    Result<SLIMSurface> surface = loadSurface(path);
    if (!surface) return surface.error();
    return ModelFile(std::move(*surface));
  }
  const Result<std::vector<unsigned char>> bytes = readFile(path);
  if (!bytes) return bytes.error();
  if (lowerExtension(path).empty() && isSlim(bytes->data(), bytes->size())) {
    Result<SLIMSurface> surface = decodeSlim(bytes->data(), bytes->size());
    if (!surface) return named(path, surface.error());
    return ModelFile(std::move(*surface));
  }
  Result<PointFile> points = parsePointFile(path, *bytes, options);
  if (!points) return points.error();
  return ModelFile(std::move(*points));
}

namespace {

/** The end of loading a surface. */
Error take(const std::string& path, Result<SLIMSurface> loaded, Console& console, Report& report,
           SLIMSurface& surface) {
  if (!loaded) return console.failed(loaded.error());
  surface = std::move(*loaded);
  report.time("load_surface", console.seconds());
  reportSurface(path, surface, report);
  console.done(counted(surface.numLeaves(), "surfel"));
  return {};
}

/** The surface that points, which are read already, are surfels of. */
Error takeSurfels(const std::string& path, const PointFile& surfels, Console& console,
                  Report& report, SLIMSurface& surface) {
  console.begin("Loading " + path);
  Result<SLIMSurface> made = surfaceFrom(surfels);
  if (!made) return console.failed(named(path, made.error()));
  return take(path, std::move(made), console, report, surface);
}

}  // namespace

Error loadGiven(const std::string& path, Console& console, Report& report, SLIMSurface& surface) {
  console.begin("Loading " + path);
  return take(path, loadSurface(path), console, report, surface);
}

Error loadScanOrSurface(const std::string& path, const FitJob& job, Console& console,
                        Report& report, ScanOrSurface& input) {
  if (lowerExtension(path) == ".slim")
    return loadGiven(path, console, report, input.surface.emplace());
  std::optional<ModelFile> read;
  if (isStream(path) && lowerExtension(path).empty()) {
    Result<ModelFile> file = readModelFile(path, job.input.file);
    if (!file) return file.error();
    read = std::move(*file);
    if (auto* surface = std::get_if<SLIMSurface>(&*read)) {
      console.begin("Loading " + path);
      return take(path, std::move(*surface), console, report, input.surface.emplace());
    }
  }
  PointFile* points = read ? std::get_if<PointFile>(&*read) : nullptr;
  Result<CloudFile> loaded = loadScan(path, job, console, report, points);
  if (!loaded) return loaded.error();
  if (findField(loaded->file.cloud, "c0") >= 0)
    return takeSurfels(path, loaded->file, console, report, input.surface.emplace());
  input.scan = std::move(*loaded);
  return {};
}

}  // namespace pcl_slim

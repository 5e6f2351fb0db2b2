// SPDX-License-Identifier: BSD-3-Clause
#include "projection/projection_job.h"

#include <cstdio>
#include <utility>

#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/scan/scan.h"
#include "projection/block_surface.h"
#include "scan/fit_job.h"

namespace pcl_slim {

void declareProjection(OptionTable& options, ProjectionJob& job) {
  options.input("IN", &job.files.input, kScanHelp);
  options.output("OUT.pcd|.ply|.las|.vtp", &job.files.output,
                 "the same points, with every field kept", "");
  declareSurfaceOrFit(options, job.surface, job.fit);
  declareTileOptions(options, job.tiles);
  declareReport(options, job.files);
}

Error finishProjection(const OptionTable& options, ProjectionJob& job) {
  job.tiles.asked = options.given("tile_points");
  job.projection.threads = job.fit.params.threads;
  job.projection.sharp_features = job.fit.params.sharp_features;
  if (Error error = finishFitOptions(job.fit)) return error;
  if (Error error = checkPointExtension(job.files.output, true)) return error;
  return checkPlaces(filesRead(job.fit, {job.files.input, job.surface}),
                     {job.files.output, job.files.json});
}

Error readSurface(const std::string& path, const CloudFile* near, Console& console, Report& report,
                  SLIMSurface& surface) {
  console.begin("Loading " + path);
  BlockSurface blocks;
  const bool in_blocks = near != nullptr && blocks.open(path);
  if (in_blocks) blocks.setMostBytes(memoryLeft());
  Result<SLIMSurface> loaded =
      in_blocks ? blocks.load(blocks.partOf(near->view())) : loadSurface(path);
  if (!loaded) return console.failed(loaded.error());
  surface = std::move(*loaded);
  report.time("surface", console.seconds());
  reportSurface(path, surface, report);
  console.done(std::to_string(surface.size()) + " surfels");
  if (in_blocks) blocks.reportBlocks(console, report);
  return {};
}

Result<CloudProjection> projectScan(const ProjectionJob& job, const CloudFile& scan,
                                    const SLIMSurface& surface, const PointStore* store,
                                    Console& console, Report& report) {
  console.begin("Projecting");
  const auto origin = job.surface.empty() ? SurfaceOrigin::kFitted : SurfaceOrigin::kGiven;
  const bool with_normals = job.fit.use_normals || job.fit.normal_neighbours > 0;
  auto projection = projectScan(scan.view(with_normals), surface, origin, job.fit.params,
                                job.projection, &console.progress(), store);
  if (!projection) return console.failed(projection.error());
  report.time("project", console.seconds());
  reportProjection(projection->statistics(), report);
  console.done(std::to_string(projection->statistics().moved) + " points");
  printProjection(projection->statistics(), console);
  return projection;
}

void printProjection(const CloudProjectionStatistics& statistics, Console& console) {
  if (statistics.moved > 0) {
    char text[120];
    std::snprintf(text, sizeof(text),
                  "  the surface is %.3g RMS from the points, %.3g at most, in the scan's unit",
                  statistics.rms_displacement, statistics.max_displacement);
    console.note(text);
  }
  if (statistics.unsupported > 0)
    console.note("  " + counted(statistics.unsupported, "point") +
                 " without support: there is no surface near");
}

void reportProjection(const CloudProjectionStatistics& statistics, Report& report) {
  report.add({{"moved", statistics.moved},
              {"unsupported", statistics.unsupported},
              {"non_finite", statistics.non_finite},
              {"rms_displacement", statistics.rms_displacement},
              {"max_displacement", statistics.max_displacement}});
}

void warnOfLeftOut(const CloudFile& scan, Console& console) {
  for (const std::string& name : scan.file.left_out) {
    console.warn(name + " of the scan is not written: the output holds its points and faces");
  }
}

Error savePoints(const ProjectionJob& job, const PointFile& points, Console& console,
                 Report& report) {
  const bool sensor = points.hasSensorPose();
  noteWhatIsNotKept(job.files.output, points.cloud.height > 1, sensor, console);
  return saveOutput(
      job.files.output, job.files.json, [&] { return savePointFile(job.files.output, points); },
      std::to_string(numPoints(points.cloud)) + " points", console, report);
}

}  // namespace pcl_slim

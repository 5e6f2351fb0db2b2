// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_curvature: adds curvatures and normals of its SLIM surface to a scan; nothing moves.
#include <string>
#include <vector>

#include "common/file_program.h"
#include "common/programs.h"
#include "pcl_slim/filters/table/projected_fields.h"
#include "projection/piece_stream.h"
#include "projection/projection_job.h"

namespace {

using namespace pcl_slim;

OptionTable declareOptions(ProjectionJob& job) {
  OptionTable options = programOptions("pcl_slim_curvature");
  options.toggle("directions", &job.more_fields, "also write the unit tangents of k1 and k2");
  declareProjection(options, job);
  return options;
}

std::vector<std::string> fieldNames(bool directions) {
  std::vector<std::string> names = {"k1",       "k2",       "mean_curvature", "gaussian_curvature",
                                    "normal_x", "normal_y", "normal_z"};
  if (!directions) return names;
  for (const char* direction : {"direction1_", "direction2_"}) {
    for (const char* axis : {"x", "y", "z"}) names.push_back(std::string(direction) + axis);
  }
  return names;
}

/** The scan's points, unmoved, with the surface's fields. */
PointFile withCurvatures(const PointFile& file, const CloudProjection& projection,
                         const ProjectionJob& job) {
  return withPoints(file, withProjected(file.cloud, projection, fieldNames(job.more_fields),
                                        job.projection.threads));
}

Exit run(const OptionTable& options, ProjectionJob& job) {
  Console console(job.files.quiet);
  Report report(options, job.files.input, job.fit.params.threads);

  PieceStream pieces(job);  // of a scan that is too large to be loaded
  if (Error error = pieces.open(console)) return Exit::usage(error);
  if (pieces.isOpen()) return pieces.run(withCurvatures, console, report);

  const Result<CloudFile> scan = loadScan(job.files.input, job.fit, console, report);
  if (!scan) return Exit::usage(scan.error());
  const bool fits = job.surface.empty();
  SLIMSurface surface;
  if (!fits) {
    if (Error error = readSurface(job.surface, &*scan, console, report, surface))
      return Exit::usage(error);
  }
  warnOfLeftOut(*scan, console);

  PointStore store;
  if (fits) {
    if (Error error = fitScan(job.fit, *scan, console, report, surface, &store)) return error;
  }
  const auto projection =
      projectScan(job, *scan, surface, fits ? &store : nullptr, console, report);
  if (!projection) return projection.error();
  return savePoints(job, withCurvatures(scan->file, *projection, job), console, report);
}

}  // namespace

int main(int argc, char** argv) {
  ProjectionJob job;
  job.projection.directions = job.projection.planes = true;
  OptionTable options = declareOptions(job);
  return runFileProgram(options, argc, argv,
                        {"use a smaller scan", [&] { return finishProjection(options, job); },
                         [&] { return run(options, job); }});
}

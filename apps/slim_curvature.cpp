// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_curvature: adds curvatures and normals of its SLIM surface to a scan; nothing moves.
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "common/file_program.h"
#include "common/programs.h"
#include "pcl_slim/core/parallel.h"
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

using Values = std::array<float, 13>;

/** The values of a point, in the order of fieldNames(). */
Values valuesOf(const ProjectedPoint& point) {
  const auto& n = point.normal;
  const auto& d1 = point.principal.direction1;
  const auto& d2 = point.principal.direction2;
  return {point.principal.k1,
          point.principal.k2,
          point.mean_curvature,
          point.gaussian_curvature,
          n[0],
          n[1],
          n[2],
          d1[0],
          d1[1],
          d1[2],
          d2[0],
          d2[1],
          d2[2]};
}

/** The scan's points, unmoved, with the surface's fields. */
PointFile withCurvatures(const PointFile& file, const CloudProjection& projection,
                         const ProjectionJob& job) {
  const std::vector<std::string> names = fieldNames(job.more_fields);
  PointFile made = withRealFields(file, names, kFloat32);
  std::vector<FieldWriter> fields;
  fields.reserve(names.size());
  for (const std::string& name : names) fields.emplace_back(made.cloud, name);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const ProjectedPoint unknown = CloudProjection::unknownPoint({kNan, kNan, kNan});
  parallelFor(
      projection.size(), resolveThreads(job.projection.threads), 4096, [&](std::size_t i, int) {
        const Values values = valuesOf(projection.isFinite(i) ? projection.point(i) : unknown);
        for (std::size_t k = 0; k < fields.size(); ++k) fields[k].set(i, values[k]);
      });
  return made;
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

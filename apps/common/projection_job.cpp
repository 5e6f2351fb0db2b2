// SPDX-License-Identifier: BSD-3-Clause
#include "common/projection_job.h"

#include <utility>

#include "common/program.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/filters/io/surface_files.h"

namespace pcl_slim {

namespace {

/** What can be said before the input is touched. */
Error
checkJob(ProjectionJob& job)
{
  if (Error error = finishFitOptions(job.fit)) return error;
  const std::string extension = lowerExtension(job.output);
  if (extension != ".pcd" && extension != ".ply") {
    return {ErrorCode::kBadArgument, "'" + job.output + "' must be named .pcd or .ply"};
  }
  for (const std::string* read : {&job.input, &job.surface}) {
    if (samePlace(*read, job.output) || samePlace(*read, job.json)) {
      return {ErrorCode::kBadArgument, "'" + *read + "' would be overwritten; name another file"};
    }
  }
  if (samePlace(job.output, job.json)) {
    return {ErrorCode::kBadArgument, "output and report share a file; name different ones"};
  }
  return {};
}

Error
readSurface(const std::string& path, Console& console, Report& report, SLIMSurface& surface)
{
  const Stopwatch watch;
  console.begin("Loading " + path);
  Result<SLIMSurface> loaded = loadSurface(path);
  if (!loaded) {
    console.failed();
    return loaded.error();
  }
  surface = std::move(*loaded);
  report.time("surface", watch.seconds());
  report.json()["surface"] = path;
  report.json()["surfels"] = surface.size();
  console.done(watch.seconds(), std::to_string(surface.size()) + " surfels");
  return {};
}

void
reportProjection(const CloudProjection& projection, Report& report)
{
  const CloudProjectionStatistics& statistics = projection.statistics();
  auto& json = report.json();
  json["moved"] = statistics.moved;
  json["unsupported"] = statistics.unsupported;
  json["non_finite"] = statistics.non_finite;
  json["rms_displacement"] = statistics.rms_displacement;
  json["max_displacement"] = statistics.max_displacement;
}

/** Brings the scan onto the surface. \param[in] store the scan's, or null. */
Result<CloudProjection>
projectScan(const ProjectionJob& job, const CloudFile& cloud, const SLIMSurface& surface,
            const PointStore* store, Console& console, Report& report)
{
  const Stopwatch watch;
  console.begin("Projecting");
  CloudProjectionParams params;
  params.projection = job.projection;
  params.projection.threads = job.fit.params.threads;
  params.projection.sharp_features = job.fit.params.sharp_features;
  params.projection.paper_mode = surface.info.paper_mode;
  params.has_viewpoint = job.fit.params.has_viewpoint;
  for (std::size_t a = 0; a < 3; ++a) params.viewpoint[a] = job.fit.params.viewpoint[a];
  if (!job.surface.empty()) params.least_support = kLeastSharedSupport;
  const bool with_normals = job.fit.use_normals || job.fit.normal_neighbours > 0;
  auto projection =
      CloudProjection::make(cloud.view(with_normals), surface, params, &console.progress(), store);
  if (!projection) {
    console.failed();
    return projection;
  }
  report.time("project", watch.seconds());
  reportProjection(*projection, report);
  console.done(watch.seconds(), std::to_string(projection->statistics().moved) + " points");
  if (const auto count = projection->statistics().unsupported; count > 0) {
    console.note("  " + std::to_string(count) + (count == 1 ? " point" : " points") +
                 " without support");
  }
  return projection;
}

int
run(OptionTable& options, ProjectionJob& job, int argc, const char* const* argv,
    const MakeOutput& make_output)
{
  if (const auto status = options.parse(argc, argv)) return *status;
  Error error = checkJob(job);
  if (error) return fail(options.program(), kExitUsage, error.message);
  Console console(job.quiet);
  Report report(options.program(), options.version(), job.input,
                resolveThreads(job.fit.params.threads));
  const Result<CloudFile> cloud = loadScan(job.input, job.fit, console, report);
  if (!cloud) return fail(options.program(), kExitUsage, cloud.error().message);
  SLIMSurface surface;
  if (!job.surface.empty()) {
    error = readSurface(job.surface, console, report, surface);
    if (error) return fail(options.program(), kExitUsage, error.message);
  }
  error = checkOutputs(job.output, job.json);
  if (error) return fail(options.program(), kExitFailed, error.message);

  PointStore store;
  if (job.surface.empty()) error = fitScan(job.fit, *cloud, console, report, surface, &store);
  Result<CloudProjection> projection = error;
  if (!error && !console.interrupted()) {
    projection =
        projectScan(job, *cloud, surface, job.surface.empty() ? &store : nullptr, console, report);
    if (!projection) error = projection.error();
  }
  if (console.interrupted())
    return fail(options.program(), kExitInterrupted, "stopped; nothing is written");
  if (!error) {
    const PointFile made = make_output(cloud->file, *projection);
    error = saveOutput(
        job.output, job.json, [&] { return savePointFile(job.output, made); },
        std::to_string(numPoints(made.cloud)) + " points", console, report);
  }
  return error ? fail(options.program(), kExitFailed, error.message) : kExitDone;
}

}  // namespace

void
declareScans(OptionTable& options, ProjectionJob& job)
{
  options.positional("IN.pcd|.ply", &job.input,
                     "the scan; its normals or faces are used if it has any");
  options.positional("OUT.pcd|.ply", &job.output, "the same points, with every field kept");
}

void
declareProjectionOptions(OptionTable& options, ProjectionJob& job)
{
  options.text("surface", &job.surface, "FILE",
               "use a surface made by pcl_slim_fit (.pcd, .ply, .vtp, .slim) in place of a fit");
  declareFitOptions(options, job.fit);
  options.text("json", &job.json, "FILE", "write a report");
  options.toggle("quiet", &job.quiet, "say nothing but errors");
  for (const char* name :
       {"degree", "penalty", "t_mdl", "target_error", "max_surfels", "robust", "local_noise",
        "normals_as_data", "normal_error", "paper", "compact", "lambda", "seed"}) {
    options.exclusive({"surface", name});
  }
}

int
runProjectionProgram(OptionTable& options, ProjectionJob& job, int argc, const char* const* argv,
                     const MakeOutput& make_output)
{
  return guarded(options.program(), "use a smaller scan",
                 [&] { return run(options, job, argc, argv, make_output); });
}

}  // namespace pcl_slim

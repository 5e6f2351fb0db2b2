// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_fit: turns a scan into a SLIM surface.
#include "common/fit_job.h"
#include "common/program.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/filters/io/surface_files.h"

namespace {

using namespace pcl_slim;

struct Settings {
  std::string input, output, json;
  FitJob job;
  bool quiet = false;
};

OptionTable
declareOptions(Settings& s)
{
  OptionTable options("pcl_slim_fit", PCL_SLIM_VERSION,
                      "Fits a sparse set of local polynomials (a SLIM surface) to a scan.");
  options.positional("IN.pcd|.ply", &s.input,
                     "the scan; its normals or faces are used if it has any");
  options.positional("OUT.pcd|.ply|.vtp|.slim", &s.output, "the surface");
  declareFitOptions(options, s.job);
  options.text("json", &s.json, "FILE", "write a report");
  options.toggle("quiet", &s.quiet, "say nothing but errors");
  return options;
}

/** What can be said before the input is touched. */
Error
checkSettings(Settings& s)
{
  if (Error error = finishFitOptions(s.job)) return error;
  if (Error error = checkSurfaceExtension(s.output)) return error;
  if (samePlace(s.input, s.output) || samePlace(s.json, s.input) || samePlace(s.json, s.output)) {
    return {ErrorCode::kBadArgument, "input, output and report share a file; name different ones"};
  }
  return {};
}

int
run(int argc, char** argv)
{
  Settings s;
  OptionTable options = declareOptions(s);
  if (const auto status = options.parse(argc, argv)) return *status;
  Error error = checkSettings(s);
  if (error) return fail(options.program(), kExitUsage, error.message);
  Console console(s.quiet);
  Report report(options.program(), options.version(), s.input,
                resolveThreads(s.job.params.threads));
  const Result<CloudFile> cloud = loadScan(s.input, s.job, console, report);
  if (!cloud) return fail(options.program(), kExitUsage, cloud.error().message);
  error = checkOutputs(s.output, s.json);
  if (error) return fail(options.program(), kExitFailed, error.message);

  SLIMSurface surface;
  error = fitScan(s.job, *cloud, console, report, surface);
  if (console.interrupted())
    return fail(options.program(), kExitInterrupted, "stopped; nothing is written");
  if (!error) {
    error = saveOutput(
        s.output, s.json, [&] { return saveSurface(s.output, surface); },
        std::to_string(surface.size()) + " surfels", console, report);
  }
  return error ? fail(options.program(), kExitFailed, error.message) : kExitDone;
}

}  // namespace

int
main(int argc, char** argv)
{
  return pcl_slim::guarded("pcl_slim_fit", "use a smaller scan", [&] { return run(argc, argv); });
}

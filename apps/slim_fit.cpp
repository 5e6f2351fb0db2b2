// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_fit: turns a scan into a SLIM surface.
#include <cstdio>
#include <filesystem>
#include <new>

#include "common/fit_job.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/filters/surface_files.h"

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

int
fail(const OptionTable& options, int status, const std::string& message)
{
  std::fprintf(stderr, "%s: %s\n", options.program().c_str(), message.c_str());
  return status;
}

bool
samePlace(const std::string& a, const std::string& b)
{
  std::error_code code;
  return !a.empty() && !b.empty() && (a == b || std::filesystem::equivalent(a, b, code));
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

Error
save(const Settings& s, const SLIMSurface& surface, Console& console, Report& report)
{
  const Stopwatch watch;
  console.begin("Saving " + s.output);
  if (Error error = saveSurface(s.output, surface)) {
    console.failed();
    return error;
  }
  report.time("save", watch.seconds());
  console.done(watch.seconds(), std::to_string(surface.size()) + " surfels");
  report.json()["output"] = s.output;
  Error error = report.write(s.json);
  std::error_code code;
  if (error) std::filesystem::remove(s.output, code);
  return error;
}

int
run(int argc, char** argv)
{
  Settings s;
  OptionTable options = declareOptions(s);
  if (const auto status = options.parse(argc, argv)) return *status;
  Error error = checkSettings(s);
  if (error) return fail(options, kExitUsage, error.message);
  Console console(s.quiet);
  Report report(options.program(), options.version(), s.input,
                resolveThreads(s.job.params.threads));
  const Result<CloudFile> cloud = loadScan(s.input, s.job, console, report);
  if (!cloud) return fail(options, kExitUsage, cloud.error().message);
  error = checkWritable(s.output);
  if (!error && !s.json.empty()) error = checkWritable(s.json);
  if (error) return fail(options, kExitFailed, error.message);

  SLIMSurface surface;
  error = fitScan(s.job, *cloud, console, report, surface);
  if (console.interrupted()) return fail(options, kExitInterrupted, "stopped; nothing is written");
  if (!error) error = save(s, surface, console, report);
  return error ? fail(options, kExitFailed, error.message) : kExitDone;
}

}  // namespace

int
main(int argc, char** argv)
{
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "pcl_slim_fit: not enough memory; use a smaller scan\n");
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "pcl_slim_fit: %s\n", failure.what());
  }
  return pcl_slim::kExitFailed;
}

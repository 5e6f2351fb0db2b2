// SPDX-License-Identifier: BSD-3-Clause
#include "scan/scan_program.h"

#include <optional>
#include <utility>

#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

namespace {

/** What ends a program early. */
struct Stop {
  int status = kExitDone;
  Error error;
};

/** Loads the scan. \param[out] cloud the scan; none where open() took the input. */
Stop readScan(const ScanFiles& files, const FitJob& scan, const ScanSteps& steps, Console& console,
              Report& report, std::optional<CloudFile>& cloud) {
  if (steps.open) {
    const Result<bool> taken = steps.open(console);
    if (!taken) return {kExitUsage, taken.error()};
    if (*taken) return {};
  }
  Result<CloudFile> loaded = loadScan(files.input, scan, console, report);
  if (!loaded) return {kExitUsage, loaded.error()};
  cloud = std::move(*loaded);
  return {};
}

/** Does the work. */
Stop work(const ScanSteps& steps, const CloudFile* cloud, Console& console, Report& report,
          ScanResult& result) {
  if (cloud != nullptr || !steps.stream)
    return {kExitFailed, steps.work(cloud, console, report, result)};
  const Error error = steps.stream(console, report, result);
  const bool usage = error.code == ErrorCode::kBadInput || error.code == ErrorCode::kBadArgument;
  return {usage ? kExitUsage : kExitFailed, error};
}

/** What is done once the arguments are read. */
int runSteps(const OptionTable& options, const ScanFiles& files, const FitJob& scan, int threads,
             const ScanSteps& steps) {
  const auto leave = [&](int status, const Error& error) {
    return fail(options.program(), status, error.message);
  };
  Error error = steps.check();
  if (!error) error = limitMemory(files.max_memory);
  if (error) return leave(kExitUsage, error);
  Console console(files.quiet);
  Report report(options.program(), options.version(), files.input, resolveThreads(threads));
  std::optional<CloudFile> cloud;
  Stop stop = readScan(files, scan, steps, console, report, cloud);
  const CloudFile* scan_points = cloud ? &*cloud : nullptr;
  if (!stop.error && steps.load) stop = {kExitUsage, steps.load(scan_points, console, report)};
  if (!stop.error) stop = {kExitFailed, checkOutputs(files.output, files.json)};
  if (stop.error) return leave(stop.status, stop.error);

  ScanResult result;
  stop = work(steps, scan_points, console, report, result);
  if (console.interrupted()) {
    return fail(options.program(), kExitInterrupted, "stopped; nothing is written");
  }
  error = stop.error;
  if (error && stop.status == kExitUsage) return leave(kExitUsage, error);
  if (!error && result.report_only)
    error = report.write(files.json);
  else if (!error) {
    error = saveOutput(files.output, files.json, result.save, result.detail, console, report);
  }
  if (!error && result.done) result.done();
  return error ? failWork(options.program(), error) : kExitDone;
}

}  // namespace

void declareReport(OptionTable& options, ScanFiles& files) {
  options.text("json", &files.json, "FILE", "write a report");
  declareMemoryLimit(options, &files.max_memory);
  options.toggle("quiet", &files.quiet, "say nothing but errors");
}

Error checkFilesDiffer(const ScanFiles& files, const std::vector<std::string>& read) {
  if (Error error = checkPlaces(read, {files.output, files.json})) return error;
  if (!samePlace(files.input, files.output) && !samePlace(files.json, files.input) &&
      !samePlace(files.json, files.output)) {
    return {};
  }
  return {ErrorCode::kBadArgument, "input, output and report share a file; name different ones"};
}

Error checkPointExtension(const std::string& path, bool las) {
  const std::string extension = lowerExtension(path);
  if (extension == ".vtp") return checkPointFileExtension(path);
  if (extension == ".pcd" || extension == ".ply" || (las && extension == ".las")) return {};
  return {ErrorCode::kBadArgument, "cannot tell the format of '" + path + "'; name a .pcd, .ply" +
                                       (las ? ", .las" : "") + " or .vtp file"};
}

void noteWhatIsNotKept(const std::string& path, bool rows, bool sensor, Console& console) {
  const std::string extension = lowerExtension(path);
  if (extension == ".pcd" || !(rows || sensor)) return;
  const std::string what = !sensor ? "rows" : !rows ? "sensor" : "rows and sensor";
  console.note("  " + extension + " does not keep the scan's " + what + "; .pcd does");
}

int runScanProgram(OptionTable& options, int argc, const char* const* argv, const ScanFiles& files,
                   const FitJob& scan, const int& threads, const ScanSteps& steps) {
  return guarded(options.program(), "use a smaller scan", [&]() -> int {
    if (const auto status = options.parse(argc, argv)) return *status;
    return runSteps(options, files, scan, threads, steps);
  });
}

}  // namespace pcl_slim

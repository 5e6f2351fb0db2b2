// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_demo_scan: a coloured object as a laser scanner sees it, to try the other programs on.
#include <cstdio>
#include <new>
#include <string>

#include "common/options.h"
#include "common/progress_bar.h"
#include "common/report.h"
#include "demo/scanner.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/parallel.h"

using namespace pcl_slim;

namespace {

int
fail(int status, const std::string& message)
{
  std::fprintf(stderr, "pcl_slim_demo_scan: %s\n", message.c_str());
  return status;
}

int
run(const std::string& output, const demo::ScanParams& params, const std::string& json, bool quiet)
{
  if (Error error = checkWritable(output)) return fail(kExitFailed, error.message);
  Console console(quiet);
  Report report("pcl_slim_demo_scan", PCL_SLIM_VERSION, "", resolveThreads(params.threads));
  console.begin("Scanning an amphora");
  const Stopwatch scan_time;
  const demo::Scan scan = demo::scanAmphora(params);
  report.time("scan", scan_time.seconds());
  console.done(scan_time.seconds(),
               std::to_string(scan.width) + " x " + std::to_string(scan.height) + " points");

  console.begin("Saving " + output);
  const Stopwatch save_time;
  const auto bytes = demo::encodePcd(scan);
  if (Error error = writeFile(output, bytes.data(), bytes.size())) {
    console.failed();
    return fail(kExitFailed, error.message);
  }
  report.time("save", save_time.seconds());
  console.done(save_time.seconds(), std::to_string(bytes.size()) + " bytes");
  report.json()["points"] = scan.rgb.size();
  report.json()["noise"] = params.noise;
  report.json()["seed"] = params.seed;
  if (Error error = report.write(json)) return fail(kExitFailed, error.message);
  return kExitDone;
}

}  // namespace

int
main(int argc, char** argv)
{
  demo::ScanParams params;
  std::string output, json;
  bool quiet = false;
  OptionTable table(
      "pcl_slim_demo_scan", PCL_SLIM_VERSION,
      "Writes a coloured amphora as a laser scanner on four tripods would see it: with "
      "noise, hidden parts and uneven density.");
  table.positional("OUT.pcd", &output, "binary PCD with fields x y z rgb");
  table.integer("points", &params.points, 100, 50000000, "points (organized: pixels)");
  table.number("noise", &params.noise, 0.0, 0.1,
               "noise at medium range, share of the object's diagonal");
  table.integer("seed", &params.seed, 0, 1000000000000, "start of the random numbers");
  table.toggle("organized", &params.organized, "one tripod's grid, NaN where nothing was hit");
  table.integer("threads", &params.threads, 0, 1024, "threads, 0: all cores");
  table.text("json", &json, "FILE", "write a report");
  table.toggle("quiet", &quiet, "print nothing");
  if (const auto status = table.parse(argc, argv)) return *status;
  if (lowerExtension(output) != ".pcd") {
    return fail(kExitUsage, "the scan '" + output + "' must be named .pcd");
  }
  try {
    return run(output, params, json, quiet);
  } catch (const std::bad_alloc&) {
    return fail(kExitFailed, "not enough memory; ask for fewer points");
  }
}

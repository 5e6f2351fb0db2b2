// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_demo_scan: a coloured object as a laser scanner sees it, to try the other programs on.
#include <string>

#include "common/memory_limit.h"
#include "common/options.h"
#include "common/program.h"
#include "demo/scanner.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/parallel.h"

using namespace pcl_slim;

namespace {

constexpr char kProgram[] = "pcl_slim_demo_scan";
constexpr double kBytesOfPoint = 32;  ///< in the scan and in its file

int
run(const std::string& output, const demo::ScanParams& params, const std::string& json, bool quiet)
{
  Error error = checkOutputs(output, json);
  if (error) return fail(kProgram, kExitFailed, error.message);
  Console console(quiet);
  Report report(kProgram, PCL_SLIM_VERSION, "", resolveThreads(params.threads));
  console.begin("Scanning an amphora");
  const demo::Scan scan = demo::scanAmphora(params);
  report.time("scan", console.seconds());
  report.json()["points"] = scan.rgb.size();
  report.json()["noise"] = params.noise;
  report.json()["seed"] = params.seed;
  console.done(std::to_string(scan.width) + " x " + std::to_string(scan.height) + " points");

  const auto bytes = demo::encodePcd(scan);
  error = saveOutput(
      output, json, [&] { return writeFile(output, bytes.data(), bytes.size()); },
      std::to_string(bytes.size()) + " bytes", console, report);
  return error ? failWork(kProgram, error) : kExitDone;
}

}  // namespace

int
main(int argc, char** argv)
{
  demo::ScanParams params;
  std::string output, json;
  bool quiet = false;
  std::uint64_t max_memory = 0;
  OptionTable table(
      kProgram, PCL_SLIM_VERSION,
      "Writes a coloured amphora as a laser scanner on four tripods would see it: with "
      "noise, hidden parts and uneven density.");
  table.positional("OUT.pcd", &output, "binary PCD with fields x y z rgb");
  table.integer("points", &params.points, 100, 50000000, "points (organized: pixels)");
  table.number("noise", &params.noise, 0.0, 0.1,
               "noise at medium range, share of the object's diagonal");
  table.integer("seed", &params.seed, 0, 1000000000000, "start of the random numbers");
  table.toggle("organized", &params.organized, "one tripod's grid, NaN where nothing was hit");
  table.integer("threads", &params.threads, 0, 1024, "threads, 0: all cores");
  declareMemoryLimit(table, &max_memory);
  table.text("json", &json, "FILE", "write a report");
  table.toggle("quiet", &quiet, "print nothing");
  if (const auto status = table.parse(argc, argv)) return *status;
  if (lowerExtension(output) != ".pcd") {
    return fail(kProgram, kExitUsage, "the scan '" + output + "' must be named .pcd");
  }
  return guarded(kProgram, "ask for fewer points", [&]() -> int {
    Error error = checkPlaces({}, {output, json});
    if (!error) error = limitMemory(max_memory);
    if (!error) {
      error = checkMemory(kBytesOfPoint * static_cast<double>(params.points), "such a scan");
    }
    if (error) return fail(kProgram, kExitUsage, error.message);
    return run(output, params, json, quiet);
  });
}

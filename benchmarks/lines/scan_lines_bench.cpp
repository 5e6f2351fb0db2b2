// SPDX-License-Identifier: BSD-3-Clause
// What crest lines of scans cost: CPU time a point, stage by stage.
#include <algorithm>
#include <cstdio>

#include "common/run_program.h"
#include "line_run.h"
#include "scan/cloud_file.h"

namespace {

using namespace pcl_slim;

struct Settings {
  std::string scan;
  int repeat = 5;
  FitParams fit;
  CrestParams params;

  Settings()
  {
    params.threads = 1;
    fit.trim = false;
  }
};

OptionTable
declareOptions(Settings& s)
{
  OptionTable options("scan_lines_bench", "1", "Measures what crest lines of a scan cost.");
  options.positional("SCAN.pcd|.ply", &s.scan, "the scan; its normals or faces are used");
  options.integer("repeat", &s.repeat, 1, 1000, "runs to take the least times of");
  options.integer("degree", &s.fit.degree, 1, 4, "degree of the polynomials");
  options.integer("threads", &s.params.threads, 0, 4096, "threads, 0: all cores");
  return options;
}

Error
run(Settings& s)
{
  const auto cloud = loadCloudFile(s.scan);
  if (!cloud) return cloud.error();
  // What others do on the machine only adds to a run's time.
  double fit = 1e300, project = 1e300, trace = 1e300;
  lines_bench::LineRun one;
  for (int i = 0; i < s.repeat; ++i) {
    if (Error error = runLines(cloud->view(), s.fit, s.params, one)) return error;
    fit = std::min(fit, one.fit);
    project = std::min(project, one.project);
    trace = std::min(trace, one.trace);
  }
  std::printf(
      "| points | leaves | lines | vertices | requests | fit us | projection us | lines us |\n"
      "|---|---|---|---|---|---|---|---|\n| %zu | %zu | %zu | %zu | %llu | %.2f | %.2f | %.2f |\n",
      one.points, one.leaves, one.lines.numLines(), one.lines.numVertices(),
      static_cast<unsigned long long>(one.statistics.requests), fit, project, trace);
  return {};
}

}  // namespace

int
main(int argc, char** argv)
{
  return runProgram<Settings>(
      argc, argv, "use a smaller scan", declareOptions,
      [](const OptionTable&, Settings&) { return Error(); }, run);
}

// SPDX-License-Identifier: BSD-3-Clause
// Scans as depth cameras, turning lidars and registered layers make them: RMS errors of our default
// beside those of pcl::MovingLeastSquares of order 2 at its best radius.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>

#include "common/run_program.h"
#include "sensor/sensor_errors.h"
#include "sensor/sensor_rows.h"
#include "support/lab/bench.h"

namespace {

using namespace pcl_slim;

struct Settings {
  std::string rows;
  int seed = 1, seeds = 1, threads = 0;
  bool mls = true, solids = false;
  std::optional<bool> local_noise;
  double lambda = 0, correlation = 0, range_error = 0, creases = 0;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("sensor_bench", "1", "Measures fits of scans as sensors make them.");
  options.text("rows", &s.rows, "TEXT", "only rows whose name contains this");
  options.integer("seed", &s.seed, 0, 1000000, "seed of the scans");
  options.integer("seeds", &s.seeds, 1, 100, "number of seeds, a row each");
  options.toggle("mls", &s.mls, "measure MLS too");
  options.toggle("solids", &s.solids, "errors solid by solid too");
  options.number("creases", &s.creases, 0, 1, "leave out points so near another solid [m]", "none");
  options.toggle("local_noise", &s.local_noise, "as pcl_slim_fit's", "auto");
  options.number("lambda", &s.lambda, 0, 1, "as pcl_slim_fit's", "estimated");
  options.number("correlation", &s.correlation, 1, 1e6, "as pcl_slim_fit's", "auto");
  options.number("range_error", &s.range_error, 0, 1e3, "the A of pcl_slim_fit's -noise_model",
                 "none");
  options.integer("threads", &s.threads, 0, 4096, "threads, 0: all cores; changes no result");
  return options;
}

/** MLS over the row's radii: the least error of each kind, whichever radius has it. */
measure::SensorErrors bestOfMls(const measure::SensorScan& scan, const std::vector<double>& radii) {
  measure::SensorErrors best;
  best.position = best.normal = 1e9;
  for (double radius : radii) {
    const measure::SensorErrors errors = measure::errorsOfMls(scan, radius);
    best.position = std::min(best.position, errors.position);
    best.normal = std::min(best.normal, errors.normal);
  }
  return best;
}

void printSolids(const measure::SensorErrors& errors) {
  for (std::size_t i = 0; i < errors.positions.size(); ++i)
    std::printf("|   solid %zu | %.2f | %.2f |\n", i, errors.positions[i], errors.normals[i]);
}

FitParams paramsOf(const Settings& s, const measure::SensorScan& scan) {
  FitParams params;
  params.threads = s.threads;
  params.local_noise = s.local_noise;
  params.lambda = unlessZero(s.lambda);
  params.noise_correlation = unlessZero(s.correlation);
  if (s.range_error > 0) {
    params.noise_model = {{s.range_error, 0, 0}};
    params.viewpoint = scan.sensor;
  }
  return params;
}

Error printRow(const Settings& s, const measure::SensorRow& row, std::uint64_t seed) {
  measure::SensorScan scan = row.scan(seed);
  if (s.creases > 0) measure::leaveOutCreases(s.creases, scan);
  const FitParams params = paramsOf(s, scan);
  FitStatistics fit;
  const double start = measure::cpuSeconds();
  const auto errors = measure::errorsOfFit(scan, params, fit);
  if (!errors) return errors.error();
  const double seconds = measure::cpuSeconds() - start;
  std::printf("| %s | %.2f | %.2f |", row.name.c_str(), errors->position, errors->normal);
  if (s.mls) {
    const measure::SensorErrors mls = bestOfMls(scan, row.radii);
    std::printf(" %.2f | %.2f |", mls.position, mls.normal);
  }
  std::printf(" %.2f | %.1f | %zu | %llu | %.2f |\n", errors->unit * std::sqrt(fit.lambda),
              fit.noise.correlation, scan.size(), static_cast<unsigned long long>(fit.leaves),
              seconds);
  if (s.solids) printSolids(*errors);
  std::fflush(stdout);
  return {};
}

Exit run(const Settings& s) {
  std::printf(
      "| scan | default, mm | ° |%s noise found, mm | N | points | leaves | CPU s |\n"
      "|---|---|---|%s---|---|---|---|---|\n",
      s.mls ? " MLS, best radius, mm | ° |" : "", s.mls ? "---|---|" : "");
  for (const measure::SensorRow& row : measure::sensorRows(s.rows)) {
    for (int i = 0; i < s.seeds; ++i) {
      if (Error error = printRow(s, row, static_cast<std::uint64_t>(s.seed + i))) return error;
    }
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "give fewer -rows", [&] { return run(s); });
}

// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_benchmark: time against error, SLIM compared with PCL's own classes.
#include <cmath>
#include <cstdio>

#include "benchmark/chart.h"
#include "benchmark/plan.h"
#include "benchmark/tables.h"
#include "common/program.h"
#include "common/progress_bar.h"
#include "common/report.h"
#include "measure/clocks.h"

namespace {

using namespace pcl_slim;
using comparison::Run;
using comparison::Scene;
using comparison::SceneRuns;

struct Settings {
  std::string prefix;
  comparison::Plan plan;
  bool chart = true, quiet = false;
};

OptionTable
declareOptions(Settings& s)
{
  OptionTable options("pcl_slim_benchmark", PCL_SLIM_VERSION,
                      "Measures time against error: SLIM beside pcl::MovingLeastSquares and "
                      "pcl::NormalEstimationOMP.");
  options.positional("OUT_PREFIX", &s.prefix,
                     "writes OUT_PREFIX.csv, OUT_PREFIX.md, OUT_PREFIX.png");
  s.plan.declareOptions(options);
  options.toggle("chart", &s.chart, "draw OUT_PREFIX.png; needs an X server, as xvfb-run -a gives");
  options.toggle("quiet", &s.quiet, "say nothing but errors");
  return options;
}

std::string
outcomeText(const Run& run, std::size_t points)
{
  char text[128];
  std::snprintf(text, sizeof(text), "%.3g us/pt CPU", 1e6 * run.cpu / static_cast<double>(points));
  std::string all = text;
  const auto add = [&](const char* form, double value) {
    if (!std::isfinite(value)) return;
    std::snprintf(text, sizeof(text), form, value);
    all += text;
  };
  add(", RMS %.3g", run.errors.position);
  add(", normals %.3g deg", run.errors.normal);
  return all;
}

Error
treatScene(const Settings& s, const Scene& scene, Console& console, std::vector<SceneRuns>& all)
{
  SceneRuns measured;
  measured.name = scene.name;
  measured.noise = scene.noise;
  measured.points = scene.size();
  measured.mean_edges = scene.unit_is_edge;
  measured.input = inputErrors(scene);
  for (std::size_t i = 0; i < scene.size(); ++i) measured.judged += scene.isJudged(i);
  for (const comparison::Setting& setting : s.plan.settingsFor(scene)) {
    if (console.interrupted()) return {ErrorCode::kCancelled, "stopped; nothing is written"};
    console.begin(measured.title() + ": " + methodName(setting.method) + " " + setting.text() +
                  (setting.normals ? ", normals given" : ""));
    const Result<Run> run = runSetting(scene, setting, s.plan.repeats());
    if (!run) return console.failed(run.error());
    console.done(outcomeText(*run, scene.size()));
    measured.runs.push_back(*run);
  }
  all.push_back(std::move(measured));
  return {};
}

int
runSweeps(const Settings& s, const OptionTable& options, const std::string& command)
{
  Console console(s.quiet);
  std::vector<SceneRuns> scenes;
  bool loaded = false;
  Error error = s.plan.forEachScene([&](const Scene& scene) {
    loaded = true;
    return treatScene(s, scene, console, scenes);
  });
  if (error && !loaded) return fail(options.program(), kExitUsage, error.message);
  if (error) return failWork(options.program(), error);
  error =
      comparison::writeTables(s.prefix, csvText(scenes), markdownText(scenes, command), console);
  if (error) return fail(options.program(), kExitFailed, error.message);
  if (!s.chart) return kExitDone;
  error = drawChart(scenes, s.prefix + ".png");
  console.note("> " + (error ? error.message : "Drew " + s.prefix + ".png"));
  return kExitDone;
}

int
run(int argc, char** argv)
{
  Settings s;
  OptionTable options = declareOptions(s);
  if (const auto status = options.parse(argc, argv)) return *status;
  if (Error error = s.plan.finishOptions(options)) {
    return fail(options.program(), kExitUsage, error.message);
  }
  if (const Error error = comparison::checkTables(s.prefix)) {
    return fail(options.program(), kExitFailed, error.message);
  }
  return runSweeps(s, options, commandLine(argc, argv));
}

}  // namespace

int
main(int argc, char** argv)
{
  pcl_slim::measure::keepFreedMemory();
  return pcl_slim::guarded("pcl_slim_benchmark", "give smaller -points",
                           [&] { return run(argc, argv); });
}

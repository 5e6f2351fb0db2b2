// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_lines: traces the ridges and ravines of a scan's SLIM surface.
#include <algorithm>
#include <utility>

#include "common/memory_limit.h"
#include "common/program.h"
#include "common/run_program.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/filters/cloud_projection.h"
#include "pcl_slim/filters/io/crest_files.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "scan/fit_job.h"
#include "scan/fit_report.h"

namespace {

using namespace pcl_slim;

constexpr double kPeak = 3.25;  ///< a line's peak must stand out so many times as much as the rest

struct Settings {
  std::string input, output, json, surface, type = "both";
  FitJob job;
  CrestParams crest;
  std::vector<double> view, up;
  std::uint64_t max_memory = 0;
  bool quiet = false;
};

OptionTable
declareOptions(Settings& s)
{
  OptionTable options("pcl_slim_lines", PCL_SLIM_VERSION,
                      "Traces the ridges and ravines of a scan as polylines.");
  options.positional("IN", &s.input, kScanHelp);
  options.positional("OUT.vtp|.ply|.pcd|.svg", &s.output, "the lines");
  options.choice("type", &s.type, {"ridges", "ravines", "both"}, "which lines");
  options.number("significance", &s.crest.significance, 0, 1e6,
                 "deviations of the noise that a line stands out, and 3.25 times that at its peak");
  options.number("strength", &s.crest.min_strength, 0, 1e6,
                 "least integral of curvature along a line; raise it for fewer lines");
  options.number("length", &s.crest.min_length, 0, 1e6,
                 "least length of a line, in radii of the surface's balls");
  options.numbers("view", &s.view, "X,Y,Z", "where an .svg is seen from, as a direction; 0,0,1");
  options.numbers("up", &s.up, "X,Y,Z", "the direction that points up in an .svg; 0,1,0");
  options.text("surface", &s.surface, "FILE",
               "use a surface made by pcl_slim_fit (.pcd, .ply, .vtp, .slim) in place of a fit");
  declareFitOptions(options, s.job);
  options.text("json", &s.json, "FILE", "write a report");
  declareMemoryLimit(options, &s.max_memory);
  options.toggle("quiet", &s.quiet, "say nothing but errors");
  for (const char* name :
       {"degree", "penalty", "t_mdl", "target_error", "max_surfels", "noise_factor", "least_radius",
        "outliers", "robust", "local_noise", "sides", "correlation", "noise_model",
        "normals_as_data", "normal_error", "paper", "compact", "lambda", "seed"}) {
    options.exclusive({"surface", name});
  }
  return options;
}

/** What can be said before the input is touched. */
Error
checkSettings(Settings& s)
{
  if (Error error = finishFitOptions(s.job)) return error;
  if (Error error = checkCrestExtension(s.output)) return error;
  if (Error error = checkPlaces({s.input, s.surface, s.job.trajectory}, {s.output, s.json}))
    return error;
  s.crest.ridges = s.type != "ravines";
  s.crest.ravines = s.type != "ridges";
  s.crest.peak_significance = kPeak * s.crest.significance;
  s.crest.threads = s.job.params.threads;
  return s.crest.validate();
}

CrestView
viewOf(const Settings& s, const SLIMSurface& surface)
{
  CrestView view;
  view.surface = &surface;
  if (!s.view.empty()) std::copy(s.view.begin(), s.view.end(), view.toward_viewer.begin());
  if (!s.up.empty()) std::copy(s.up.begin(), s.up.end(), view.up.begin());
  return view;
}

void
reportLines(const CrestLines& lines, const CrestStatistics& statistics, Report& report)
{
  auto& json = report.json();
  double length = 0;
  for (const double l : lines.length) length += l;
  const auto ridges = std::count(lines.type.begin(), lines.type.end(), CrestType::kRidge);
  json["lines"] = lines.numLines();
  json["length"] = length;
  json["ridges"] = ridges;
  json["ravines"] = lines.numLines() - static_cast<std::size_t>(ridges);
  json["closed"] = std::count(lines.closed.begin(), lines.closed.end(), 1);
  json["vertices"] = lines.numVertices();
  json["seeds"] = statistics.seeds;
  json["requests"] = statistics.requests;
  json["ends"] = {
      {"joined", statistics.joined}, {"ended", statistics.ended}, {"faded", statistics.faded}};
  json["left_out"] = {{"seeds_on_lines", statistics.seeds_on_lines},
                      {"seeds_insignificant", statistics.seeds_insignificant},
                      {"seeds_failed", statistics.seeds_failed},
                      {"insignificant", statistics.insignificant},
                      {"short", statistics.short_lines},
                      {"weak", statistics.weak_lines}};
}

/** The scan's points, brought onto the surface. */
Error
project(const Settings& s, const PointStore& store, const SLIMSurface& surface, Console& console,
        Report& report, Projection& projection)
{
  const Stopwatch watch;
  console.begin("Projecting");
  ProjectionParams params;
  params.extremality = true;
  params.sharp_features = s.job.params.sharp_features;
  params.paper_mode = surface.info.paper_mode;
  params.threads = s.job.params.threads;
  Error error = projectPoints(store, surface, params, projection, &console.progress());
  const double supported = static_cast<double>(store.size() - projection.num_unsupported);
  if (!error && !s.surface.empty() &&
      supported < kLeastSharedSupport * static_cast<double>(store.size())) {
    error = {
        ErrorCode::kBadArgument,
        "the surface supports less than a tenth of the points: it is of another cloud or faces "
        "the other way; give this cloud's"};
  }
  if (error) {
    console.failed();
    return error;
  }
  report.time("project", watch.seconds());
  report.json()["unsupported"] = projection.num_unsupported;
  console.done(watch.seconds(),
               std::to_string(store.size() - projection.num_unsupported) + " points");
  return {};
}

Error
trace(const Settings& s, const PointStore& store, const SLIMSurface& surface, Console& console,
      Report& report, CrestLines& lines)
{
  Projection projection;
  if (Error error = project(s, store, surface, console, report, projection)) return error;
  const Stopwatch watch;
  console.begin("Tracing");
  CrestStatistics statistics;
  Error error =
      traceCrestLines(store, projection, surface, s.crest, lines, &statistics, &console.progress());
  if (error) {
    console.failed();
    return error;
  }
  report.time("seeds", statistics.seconds_seeds);
  report.time("trace", statistics.seconds_trace);
  reportLines(lines, statistics, report);
  console.done(watch.seconds(), std::to_string(lines.numLines()) + " lines");
  if (surface.info.degree < 3) {
    console.note("  polynomials of degree 2 show few lines; -degree 4 shows them");
  }
  return {};
}

Result<PointStore>
storeOf(const Settings& s, const CloudFile& cloud)
{
  return PointStore::build(cloud.view(s.job.use_normals || s.job.normal_neighbours > 0),
                           s.job.params.threads);
}

/** The surface of the scan, fitted or read, and the scan's store. */
Error
prepare(const Settings& s, const CloudFile& cloud, const SLIMSurface* given, Console& console,
        Report& report, SLIMSurface& surface, PointStore& store)
{
  if (given == nullptr) return fitScan(s.job, cloud, console, report, surface, &store);
  surface = *given;
  Result<PointStore> built = storeOf(s, cloud);
  if (!built) return built.error();
  store = std::move(*built);
  reportSurface(s.surface, surface, report);
  return {};
}

int
run(int argc, char** argv)
{
  Settings s;
  OptionTable options = declareOptions(s);
  if (const auto status = options.parse(argc, argv)) return *status;
  Error error = checkSettings(s);
  if (!error) error = limitMemory(s.max_memory);
  if (error) return fail(options.program(), kExitUsage, error.message);
  Console console(s.quiet);
  Report report(options.program(), options.version(), s.input,
                resolveThreads(s.job.params.threads));
  const Result<CloudFile> cloud = loadScan(s.input, s.job, console, report);
  if (!cloud) return fail(options.program(), kExitUsage, cloud.error().message);
  Result<SLIMSurface> given = SLIMSurface();
  if (!s.surface.empty()) {
    given = loadSurface(s.surface);
    if (!given) return fail(options.program(), kExitUsage, given.error().message);
  }
  error = checkOutputs(s.output, s.json);
  if (error) return fail(options.program(), kExitFailed, error.message);

  SLIMSurface surface;
  PointStore store;
  CrestLines lines;
  error =
      prepare(s, *cloud, s.surface.empty() ? nullptr : &*given, console, report, surface, store);
  if (!error && !console.interrupted()) error = trace(s, store, surface, console, report, lines);
  if (console.interrupted())
    return fail(options.program(), kExitInterrupted, "stopped; nothing is written");
  if (!error) {
    error = saveOutput(
        s.output, s.json, [&] { return saveCrestLines(s.output, lines, viewOf(s, surface)); },
        std::to_string(lines.numLines()) + " lines", console, report);
  }
  return error ? failWork(options.program(), error) : kExitDone;
}

}  // namespace

int
main(int argc, char** argv)
{
  return pcl_slim::guarded("pcl_slim_lines", "use a smaller scan", [&] { return run(argc, argv); });
}

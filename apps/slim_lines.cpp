// SPDX-License-Identifier: BSD-3-Clause
// pcl_slim_lines: traces the ridges and ravines of a scan's SLIM surface.
#include <algorithm>
#include <string>
#include <utility>

#include "common/file_program.h"
#include "common/program.h"
#include "common/programs.h"
#include "pcl_slim/filters/io/crest_files.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/scan/scan.h"
#include "scan/fit_job.h"
#include "scan/scan_files.h"

namespace {

using namespace pcl_slim;

constexpr double kPeak = 3.25;  ///< peak_significance of a line over its significance

struct Settings {
  ScanFiles files;
  std::string surface, type = "both";
  FitJob job;
  CrestParams crest;
  std::vector<double> view, up;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options = programOptions("pcl_slim_lines");
  options.input("IN", &s.files.input, kScanHelp);
  options.output("OUT.vtp|.ply|.pcd|.svg", &s.files.output, "the lines", ".ply");
  options.choice("type", &s.type, {"ridges", "ravines", "both"}, "which lines");
  options.number("significance", &s.crest.significance, 0, 1e6,
                 "deviations of the noise that a line stands out, and 3.25 times that at its peak");
  options.number("strength", &s.crest.min_strength, 0, 1e6,
                 "least integral of curvature along a line; raise it for fewer lines");
  options.number("length", &s.crest.min_length, 0, 1e6,
                 "least length of a line, in radii of the surface's balls");
  options.numbers("view", &s.view, "X,Y,Z", "where an .svg is seen from, as a direction; 0,0,1");
  options.numbers("up", &s.up, "X,Y,Z", "the direction that points up in an .svg; 0,1,0");
  declareSurfaceOrFit(options, s.surface, s.job);
  declareReport(options, s.files);
  return options;
}

/** Completes the settings and checks what can be checked before the input is read. */
Error finishSettings(Settings& s) {
  if (Error error = finishFitOptions(s.job)) return error;
  if (Error error = checkCrestExtension(s.files.output)) return error;
  if (Error error =
          checkPlaces(filesRead(s.job, {s.files.input, s.surface}), {s.files.output, s.files.json}))
    return error;
  s.crest.ridges = s.type != "ravines";
  s.crest.ravines = s.type != "ridges";
  s.crest.peak_significance = kPeak * s.crest.significance;
  s.crest.threads = s.job.params.threads;
  return s.crest.validate();
}

CrestView viewOf(const Settings& s, const SLIMSurface& surface) {
  CrestView view;
  view.surface = &surface;
  if (!s.view.empty()) std::copy(s.view.begin(), s.view.end(), view.toward_viewer.begin());
  if (!s.up.empty()) std::copy(s.up.begin(), s.up.end(), view.up.begin());
  return view;
}

void reportLines(const CrestLines& lines, const CrestStatistics& statistics, Report& report) {
  double length = 0;
  for (const double l : lines.length) length += l;
  const auto ridges = std::count(lines.type.begin(), lines.type.end(), CrestType::kRidge);
  report.add(
      {{"lines", lines.numLines()},
       {"length", length},
       {"ridges", ridges},
       {"ravines", lines.numLines() - static_cast<std::size_t>(ridges)},
       {"closed", std::count(lines.closed.begin(), lines.closed.end(), 1)},
       {"vertices", lines.numVertices()},
       {"seeds", statistics.seeds},
       {"requests", statistics.requests},
       {"ends",
        {{"joined", statistics.joined}, {"ended", statistics.ended}, {"faded", statistics.faded}}},
       {"left_out",
        {{"seeds_on_lines", statistics.seeds_on_lines},
         {"seeds_insignificant", statistics.seeds_insignificant},
         {"seeds_failed", statistics.seeds_failed},
         {"insignificant", statistics.insignificant},
         {"short", statistics.short_lines},
         {"weak", statistics.weak_lines}}}});
}

/** The scan's points, brought onto the surface. */
Error project(const Settings& s, const PointStore& store, const SLIMSurface& surface,
              Console& console, Report& report, Projection& projection) {
  console.begin("Projecting");
  const auto origin = s.surface.empty() ? SurfaceOrigin::kFitted : SurfaceOrigin::kGiven;
  Error error =
      projectForLines(store, surface, origin, s.job.params, projection, &console.progress());
  if (error) return console.failed(error);
  report.time("project", console.seconds());
  report.set("unsupported", projection.num_unsupported);
  console.done(std::to_string(store.size() - projection.num_unsupported) + " points");
  return {};
}

Error trace(const Settings& s, const PointStore& store, const SLIMSurface& surface,
            Console& console, Report& report, CrestLines& lines) {
  Projection projection;
  if (Error error = project(s, store, surface, console, report, projection)) return error;
  console.begin("Tracing");
  CrestStatistics statistics;
  Error error =
      traceCrestLines(store, projection, surface, s.crest, lines, &statistics, &console.progress());
  if (error) return console.failed(error);
  report.time("seeds", statistics.seconds_seeds);
  report.time("trace", statistics.seconds_trace);
  reportLines(lines, statistics, report);
  console.done(std::to_string(lines.numLines()) + " lines");
  if (surface.info.degree < 3) {
    console.note("  polynomials of degree 2 show few lines; -degree 4 shows them");
  }
  return {};
}

/** The store of a scan whose surface was read. */
Result<PointStore> storeOf(const Settings& s, const CloudFile& scan) {
  return PointStore::build(scan.view(s.job.use_normals || s.job.normal_neighbours > 0),
                           s.job.params.threads);
}

Exit run(const OptionTable& options, Settings& s) {
  Console console(s.files.quiet);
  Report report(options, s.files.input, s.job.params.threads);

  const Result<CloudFile> scan = loadScan(s.files.input, s.job, console, report);
  if (!scan) return Exit::usage(scan.error());
  const bool fits = s.surface.empty();
  Result<SLIMSurface> surface = fits ? SLIMSurface() : loadSurface(s.surface);
  if (!surface) return Exit::usage(surface.error());

  Result<PointStore> store = fits ? PointStore() : storeOf(s, *scan);
  if (!store) return store.error();
  if (fits) {
    if (Error error = fitScan(s.job, *scan, console, report, *surface, &*store)) return error;
  } else {
    reportSurface(s.surface, *surface, report);
  }

  CrestLines lines;
  if (Error error = trace(s, *store, *surface, console, report, lines)) return error;
  return saveOutput(
      s.files.output, s.files.json,
      [&] { return saveCrestLines(s.files.output, lines, viewOf(s, *surface)); },
      std::to_string(lines.numLines()) + " lines", console, report);
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runFileProgram(
      options, argc, argv,
      {"use a smaller scan", [&] { return finishSettings(s); }, [&] { return run(options, s); }});
}

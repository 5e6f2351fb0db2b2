// SPDX-License-Identifier: BSD-3-Clause
// pcl_color_splat_sampling: turns a coloured scan into discs that cover its surface.
#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/file_program.h"
#include "common/programs.h"
#include "pcl_slim/cloud/store_frame.h"
#include "pcl_slim/filters/io/splat_files.h"
#include "pcl_slim/query/surface_samples.h"
#include "pcl_slim/splat/hole_check.h"
#include "pcl_slim/splat/splat_sampling.h"
#include "scan/fit_job.h"
#include "scan/scan_files.h"
#include "scan/small_components.h"
#include "scan/surface_input.h"

namespace {

using namespace pcl_slim;

constexpr std::uint64_t kMany = 1000000000000000000u;
constexpr double kBytesOfPoint = 36;  ///< that a sampling takes at least while points are ordered

/// Options about the normals of a scan; a surface has its own.
constexpr const char* kNormalOptions[] = {"use_normals", "estimate_normals", "viewpoint",
                                          "trajectory",  "time_field",       "time_offset",
                                          "frames"};

struct Settings {
  ScanFiles files;
  std::string surface;  ///< file of the surface that is sampled in place of the scan, or none
  double min_component = kLeastComponentPoints;
  std::string color = "mean", radius = "density";
  SplatParams params;
  FitJob scan;  ///< how the scan is loaded
  std::uint64_t min_points = 4, rays = 10000;
  bool neighbors_given = false;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options = programOptions("pcl_color_splat_sampling");
  SplatParams& p = s.params;
  options.input("IN", &s.files.input, "the scan, or a surface made by pcl_slim_fit");
  options.output("OUT.pcd|.ply|.vtp", &s.files.output, "the splats: x y z, normal, rgba, radius",
                 ".ply");
  options.integer("initial", &p.initial_resolution, 0, RootGrid::kMaxResolution,
                  "cells of the initial grid along the longest side; 0: about 50 points a cell");
  options.number("geo", &p.geometric_error, 0, 1e6,
                 "deviation of unit normals from which a cell is divided");
  options.number("color", &p.color_error, 0, 1e6,
                 "deviation of CIELAB / 100 from which a cell is divided; 1: colour is ignored");
  options.integer("min_points", &s.min_points, 0, 0xffffffffu, "cells of fewer points stay whole");
  options.integer("max_depth", &p.max_depth, 0, 1000000,
                  "halvings of an initial cell at most; 0: the initial grid itself");
  options.integer("max_splats", &p.max_splats, 0, kMany,
                  "the best picture by at most N splats, in place of -geo and -color; 0: off");
  options.number("target_error", &p.target_error, 0, 1e6,
                 "mean colour difference (Delta E) to reach, likewise", "off");
  options.toggle("paper", &p.paper_mode,
                 "the published method: large discs, the kept points' own colours, no noise guard");
  options.choice("colors", &s.color, {"mean", "gradient", "own"},
                 "colour of a splat; gradient adds nine fields");
  options.choice("radius", &s.radius, {"density", "neighbours", "corner"},
                 "how large discs become");
  options.toggle("remove_noise", &p.remove_noise, "take measured noise off deviations");
  options.toggle("use_normals", &s.scan.use_normals, "use the scan's own normals or faces");
  options.integer("estimate_normals", &p.normal_neighbors, 3, 10000,
                  "about how many neighbours give each normal of a scan without");
  declareSensorOptions(options, s.scan,
                       "what estimated normals face; not given: the scan's sensor, or outward");
  declareInputOptions(options, s.scan.input);
  options.text(
      "surface", &s.surface, "FILE",
      "take shape and colours from a surface made by pcl_slim_fit (.slim .pcd .ply .vtp): IN "
      "only gives the number of points",
      FileUse::kRead);
  declareComponentOption(options, s.min_component);
  options.integer("rays", &s.rays, 0, 100000000,
                  "rays, at random places, that look for holes; 0: no check");
  options.integer("threads", &p.threads, 0, 4096,
                  "threads, 0: all cores; never changes the result");
  declareReport(options, s.files);
  options.exclusive({"max_splats", "target_error"});
  options.exclusive({"max_splats", "initial"});
  for (const char* name : {"geo", "color"}) {
    options.exclusive({"max_splats", name});
    options.exclusive({"target_error", name});
  }
  for (const char* name : {"min_points", "colors", "radius", "remove_noise"})
    options.exclusive({"paper", name});
  for (const char* name : kNormalOptions) options.exclusive({"surface", name});
  return options;
}

/** Completes the settings and checks what can be checked before the input is read. */
Error finishSettings(const OptionTable& options, Settings& s) {
  s.neighbors_given = options.given("estimate_normals");
  s.params.min_points = static_cast<std::uint32_t>(s.min_points);
  if (s.color == "gradient") s.params.color = SplatColor::kGradient;
  if (s.color == "own") s.params.color = SplatColor::kOwn;
  if (s.radius == "neighbours") s.params.radius = RadiusRule::kNeighbors;
  if (s.radius == "corner") s.params.radius = RadiusRule::kCorner;
  if (Error error = checkInputOptions(s.scan.input)) return error;
  if (Error error = checkPointExtension(s.files.output)) return error;
  if (Error error = checkFilesDiffer(s.files, filesRead(s.scan, {s.surface}))) return error;
  return s.params.validate();
}

void reportSplats(const SplatStatistics& st, bool has_colors, Report& report) {
  report.add({{"splats", st.splats},
              {"colors", has_colors},
              {"normals_estimated", st.normals_estimated},
              {"sides_from", nameOf(st.sides)},
              {"opposed_normals", st.normals.opposed},
              {"initial", st.resolution},
              {"initial_cells", st.roots},
              {"cell", st.cell},
              {"spacing", st.spacing},
              {"single_points", st.single_points},
              {"color_noise", st.color_noise},
              {"normal_noise", st.normal_noise}});
  if (st.tree_cells > 0) report.add({{"tree_cells", st.tree_cells}, {"mean_error", st.error}});
  report.set("skipped", {{"non_finite", st.non_finite},
                         {"far_away", st.far_away},
                         {"duplicates", st.duplicates},
                         {"without_normal", st.without_normal}});
  report.time("order", st.seconds_order);
  report.time("normals", st.seconds_normals);
  report.time("divide", st.seconds_divide);
  report.time("build", st.seconds_splats);
}

/** What splats are made of: the points of a scan, or even samples of a surface. */
struct Input : ScanOrSurface {
  SurfaceSamples samples;         ///< of the surface
  std::vector<std::uint8_t> bgr;  ///< of the samples

  CloudView points(bool with_normals) const {
    if (!surface) return scan->view(with_normals);
    CloudView view;
    view.xyz = samples.position.data();
    view.xyz_stride = sizeof(samples.position[0]);
    view.scalar = CloudView::Scalar::kDouble;
    view.size = samples.size();
    if (with_normals) view.normal = samples.normal.data();
    view.normal_stride = sizeof(samples.normal[0]);
    return view;
  }
  ColorView colors() const {
    if (!surface) return colorsOf(*scan);
    return {bgr.empty() ? nullptr : bgr.data(), 3};
  }
};

/** Why the options do not suit an input that is a surface itself. */
Error checkSurfaceItself(const OptionTable& options, const Settings& s) {
  const std::string input = "'" + s.files.input + "'";
  if (!s.surface.empty()) {
    return {ErrorCode::kBadArgument,
            input + " is a surface itself: leave -surface out, or name a scan"};
  }
  for (const char* name : kNormalOptions) {
    if (!options.given(name)) continue;
    return {ErrorCode::kBadArgument,
            input + " is a surface, which has its own normals: leave -" + name + " out"};
  }
  return {};
}

Error loadInput(const OptionTable& options, const Settings& s, Console& console, Report& report,
                Input& input) {
  if (Error error = loadScanOrSurface(s.files.input, s.scan, console, report, input)) return error;
  if (input.surface) return checkSurfaceItself(options, s);
  if (!s.surface.empty()) return loadGiven(s.surface, console, report, input.surface.emplace());
  if (!options.given("min_component")) return {};
  return {ErrorCode::kBadArgument, "-min_component is of surfaces: give -surface, or leave it out"};
}

/** Spreads as many samples over the surface as the scan has points, or as it was fitted to. */
Error sampleGiven(const Settings& s, Console& console, Report& report, Input& input) {
  const std::uint64_t non_finite = input.scan ? input.scan->num_non_finite : 0;
  SurfaceSampleParams params;
  params.count = input.scan ? input.scan->size() - non_finite : input.surface->info.num_points;
  params.threads = s.params.threads;
  if (params.count == 0) return CloudView::nothingFinite();
  leaveOutComponents(s.min_component, s.params.threads, {}, console, &report, *input.surface);
  console.begin("Sampling the surface");
  if (Error error = sampleSurface(*input.surface, params, input.samples, &console.progress()))
    return console.failed(error);
  for (const auto& rgb : input.samples.color)
    input.bgr.insert(input.bgr.end(), rgb.rbegin(), rgb.rend());
  report.time("sample_surface", console.seconds());
  report.add({{"samples", input.samples.size()}, {"sample_spacing", input.samples.spacing}});
  console.done(counted(input.samples.size(), "point"));
  return {};
}

/** What had no effect on the points of a scan. */
void noteUnused(const Settings& s, const SplatStatistics& statistics, const CloudFile& cloud,
                Console& console) {
  if (!statistics.normals_estimated &&
      (s.neighbors_given || s.scan.params.viewpoint || !s.scan.trajectory.empty())) {
    console.note(
        "  the scan has normals: -estimate_normals, -viewpoint and -trajectory have no effect "
        "without -use_normals 0");
  }
  if (!s.scan.use_normals && cloud.normal_source == NormalSource::kNothing)
    console.note("  -use_normals has no effect: the scan has none");
}

Error sample(Settings& s, const Input& input, Console& console, Report& report, SplatSet& splats) {
  s.params.viewpoint = s.scan.params.viewpoint;
  const CloudView points = input.points(s.scan.use_normals);
  const double bytes = kBytesOfPoint * static_cast<double>(points.size);
  const std::string work = "sampling " + std::to_string(points.size) + " points";
  if (Error error = checkMemory(bytes, work)) return error;
  console.begin("Sampling");
  const ColorView colors = input.colors();
  SplatStatistics statistics;
  if (Error error =
          sampleSplats(points, colors, s.params, splats, &statistics, &console.progress()))
    return console.failed(error);
  report.time("sample", console.seconds());
  reportSplats(statistics, colors.bgr != nullptr, report);
  console.done(std::to_string(splats.size()) + " splats");
  if (colors.bgr == nullptr) {
    console.note(std::string("  the ") + (input.surface ? "surface" : "scan") +
                 " has no colours: shape alone decides");
  }
  printSideNotes(statistics.sides, statistics.normals, console);
  if (!input.surface) noteUnused(s, statistics, *input.scan, console);
  PointStoreStatistics skipped;
  skipped.non_finite = statistics.non_finite;
  skipped.far_away = statistics.far_away;
  const std::string text = skippedText(skipped);
  if (!text.empty()) console.note("  " + text);
  return {};
}

Error lookForHoles(const Settings& s, const Input& input, const SplatSet& splats, Console& console,
                   Report& report) {
  if (s.rays == 0) return {};
  console.begin("Looking for holes");
  const Result<PointStore> store = PointStore::build(input.points(false), s.params.threads);
  if (!store) return console.failed(store.error());
  HoleCheckParams params;
  params.rays = s.rays;
  params.threads = s.params.threads;
  const Result<HoleCheck> check = checkHoles(*store, splats, params);
  if (!check) return console.failed(check.error());
  report.time("rays", console.seconds());
  report.add({{"holes", check->holes()},
              {"overlap", check->overlap},
              {"rays",
               {{"cast", check->rays},
                {"missed", check->missed},
                {"sparse", check->sparse},
                {"rough", check->rough}}}});
  char text[96];
  std::snprintf(text, sizeof(text), "%.4f %% of rays, overlap %.2f", 100.0 * check->holes(),
                check->overlap);
  console.done(text);
  return {};
}

Exit run(const OptionTable& options, Settings& s) {
  Console console(s.files.quiet);
  Report report(options, s.files.input, s.params.threads);

  Input input;
  if (Error error = loadInput(options, s, console, report, input)) return Exit::usage(error);
  if (input.surface) {
    if (Error error = sampleGiven(s, console, report, input))
      return error.code == ErrorCode::kBadInput ? Exit::usage(error) : Exit(error);
  }

  SplatSet splats;
  if (Error error = sample(s, input, console, report, splats)) return error;
  if (Error error = lookForHoles(s, input, splats, console, report)) return error;
  return saveOutput(
      s.files.output, s.files.json,
      [&] {
        return savePointFile(s.files.output, toPointFile(splats, fileShift(input.points(false))));
      },
      std::to_string(splats.size()) + " splats", console, report);
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runFileProgram(options, argc, argv,
                        {"use a smaller scan", [&] { return finishSettings(options, s); },
                         [&] { return run(options, s); }});
}

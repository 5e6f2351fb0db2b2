// SPDX-License-Identifier: BSD-3-Clause
// pcl_color_splat_sampling: turns a coloured scan into discs that cover its surface.
#include <cstdio>

#include "common/fit_job.h"
#include "common/program.h"
#include "pcl_slim/core/file_access.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/filters/io/splat_conversion.h"
#include "pcl_slim/splat/hole_check.h"
#include "pcl_slim/splat/splat_sampling.h"

namespace {

using namespace pcl_slim;

constexpr std::uint64_t kMany = 1000000000000000000u;

struct Settings {
  std::string input, output, json, color = "mean", radius = "density";
  SplatParams params;
  FitJob scan;  ///< how the scan is loaded
  std::uint64_t min_points = 4, rays = 100000;
  bool quiet = false;
};

OptionTable
declareOptions(Settings& s)
{
  OptionTable options("pcl_color_splat_sampling", PCL_SLIM_VERSION,
                      "Thins a coloured scan to discs that cover its surface without holes.");
  SplatParams& p = s.params;
  options.positional("IN.pcd|.ply", &s.input, "the scan, with or without colours and normals");
  options.positional("OUT.pcd|.ply", &s.output, "the splats: x y z, normal, rgba, radius");
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
                  "best use of so many splats, in place of -geo and -color; 0: off");
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
                  "neighbours behind each normal of a scan without");
  options.numbers("viewpoint", &s.scan.viewpoint, "X,Y,Z",
                  "what estimated normals face; not given: the file's sensor");
  options.integer("rays", &s.rays, 0, 100000000, "rays that look for holes; 0: no check");
  options.integer("threads", &p.threads, 0, 4096,
                  "threads, 0: all cores; never changes the result");
  options.text("json", &s.json, "FILE", "write a report");
  options.toggle("quiet", &s.quiet, "say nothing but errors");
  options.exclusive({"max_splats", "target_error"});
  return options;
}

/** Brings the options into the parameters, and what can be said before the input is touched. */
Error
finishSettings(Settings& s)
{
  s.params.min_points = static_cast<std::uint32_t>(s.min_points);
  if (s.color == "gradient") s.params.color = SplatColor::kGradient;
  if (s.color == "own") s.params.color = SplatColor::kOwn;
  if (s.radius == "neighbours") s.params.radius = RadiusRule::kNeighbors;
  if (s.radius == "corner") s.params.radius = RadiusRule::kCorner;
  const std::string extension = lowerExtension(s.output);
  if (extension != ".pcd" && extension != ".ply") {
    return {ErrorCode::kBadArgument,
            "cannot tell the format of '" + s.output + "'; name a .pcd or .ply file"};
  }
  if (samePlace(s.input, s.output) || samePlace(s.json, s.input) || samePlace(s.json, s.output)) {
    return {ErrorCode::kBadArgument, "input, output and report share a file; name different ones"};
  }
  return s.params.validate();
}

ColorView
colorsOf(const CloudFile& cloud)
{
  const pcl::PCLPointCloud2& points = cloud.file.cloud;
  for (const char* name : {"rgba", "rgb"}) {
    const int i = findField(points, name);
    if (i < 0) continue;
    const pcl::PCLPointField& field = points.fields[static_cast<std::size_t>(i)];
    const bool packed = field.datatype == pcl::PCLPointField::FLOAT32 ||
                        field.datatype == pcl::PCLPointField::UINT32 ||
                        field.datatype == pcl::PCLPointField::INT32;
    if (packed) return {points.data.data() + field.offset, points.point_step};
  }
  return {};
}

void
reportSplats(const SplatStatistics& st, bool has_colors, Report& report)
{
  auto& json = report.json();
  json["splats"] = st.splats;
  json["colors"] = has_colors;
  json["normals_estimated"] = st.normals_estimated;
  json["initial"] = st.resolution;
  json["initial_cells"] = st.roots;
  json["cell"] = st.cell;
  json["spacing"] = st.spacing;
  json["single_points"] = st.single_points;
  json["color_noise"] = st.color_noise;
  json["normal_noise"] = st.normal_noise;
  if (st.tree_cells > 0) {
    json["tree_cells"] = st.tree_cells;
    json["mean_error"] = st.error;
  }
  json["skipped"] = {{"non_finite", st.non_finite}, {"without_normal", st.without_normal}};
  report.time("order", st.seconds_order);
  report.time("normals", st.seconds_normals);
  report.time("divide", st.seconds_divide);
  report.time("build", st.seconds_splats);
}

Error
sample(Settings& s, const CloudFile& cloud, Console& console, Report& report, SplatSet& splats)
{
  for (std::size_t a = 0; a < 3; ++a) {
    s.params.viewpoint[a] = s.scan.viewpoint.size() == 3
                                ? s.scan.viewpoint[a]
                                : cloud.file.sensor_origin[static_cast<Eigen::Index>(a)];
  }
  const Stopwatch watch;
  console.begin("Sampling");
  const ColorView colors = colorsOf(cloud);
  SplatStatistics statistics;
  if (Error error = sampleSplats(cloud.view(s.scan.use_normals), colors, s.params, splats,
                                 &statistics, &console.progress())) {
    console.failed();
    return error;
  }
  report.time("sample", watch.seconds());
  reportSplats(statistics, colors.bgr != nullptr, report);
  console.done(watch.seconds(), std::to_string(splats.size()) + " splats");
  if (colors.bgr == nullptr) console.note("  the scan has no colours: shape alone decides");
  if (statistics.non_finite > 0) {
    console.note("  points skipped: " + std::to_string(statistics.non_finite) + " non-finite");
  }
  return {};
}

Error
lookForHoles(const Settings& s, const CloudFile& cloud, const SplatSet& splats, Console& console,
             Report& report)
{
  if (s.rays == 0) return {};
  const Stopwatch watch;
  console.begin("Looking for holes");
  const Result<PointStore> store = PointStore::build(cloud.view(false), s.params.threads);
  if (!store) {
    console.failed();
    return store.error();
  }
  HoleCheckParams params;
  params.rays = s.rays;
  params.threads = s.params.threads;
  const Result<HoleCheck> check = checkHoles(*store, splats, params);
  if (!check) {
    console.failed();
    return check.error();
  }
  report.time("rays", watch.seconds());
  report.json()["holes"] = check->holes();
  report.json()["overlap"] = check->overlap;
  report.json()["rays"] = {{"cast", check->rays},
                           {"missed", check->missed},
                           {"sparse", check->sparse},
                           {"rough", check->rough}};
  char text[96];
  std::snprintf(text, sizeof(text), "%.4f %% of rays, overlap %.2f", 100.0 * check->holes(),
                check->overlap);
  console.done(watch.seconds(), text);
  return {};
}

int
run(int argc, char** argv)
{
  Settings s;
  OptionTable options = declareOptions(s);
  if (const auto status = options.parse(argc, argv)) return *status;
  Error error = finishSettings(s);
  if (error) return fail(options.program(), kExitUsage, error.message);
  Console console(s.quiet);
  Report report(options.program(), options.version(), s.input, resolveThreads(s.params.threads));
  const Result<CloudFile> cloud = loadScan(s.input, s.scan, console, report);
  if (!cloud) return fail(options.program(), kExitUsage, cloud.error().message);
  error = checkOutputs(s.output, s.json);
  if (error) return fail(options.program(), kExitFailed, error.message);

  SplatSet splats;
  error = sample(s, *cloud, console, report, splats);
  if (!error && !console.interrupted()) error = lookForHoles(s, *cloud, splats, console, report);
  if (console.interrupted())
    return fail(options.program(), kExitInterrupted, "stopped; nothing is written");
  if (!error) {
    error = saveOutput(
        s.output, s.json,
        [&] { return savePointFile(s.output, toPointFile(splats, splatShift(splats))); },
        std::to_string(splats.size()) + " splats", console, report);
  }
  return error ? fail(options.program(), kExitFailed, error.message) : kExitDone;
}

}  // namespace

int
main(int argc, char** argv)
{
  return pcl_slim::guarded("pcl_color_splat_sampling", "use a smaller scan",
                           [&] { return run(argc, argv); });
}

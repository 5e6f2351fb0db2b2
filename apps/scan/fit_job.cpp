// SPDX-License-Identifier: BSD-3-Clause
#include "scan/fit_job.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <utility>

#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/filters/io/trajectory.h"
#include "pcl_slim/scan/scan.h"

namespace pcl_slim {

namespace {

constexpr std::uint64_t kMany = 1000000000000000000u;
constexpr double kBytesOfPoint = 60;  ///< that a fit takes at least while the store is built

const char* normalSourceName(NormalSource source) {
  switch (source) {
    case NormalSource::kFields: return "fields";
    case NormalSource::kMesh: return "mesh";
    case NormalSource::kEstimated: return "estimated";
    default: return "none";
  }
}

}  // namespace

void declareFitOptions(OptionTable& options, FitJob& job) {
  options.integer("degree", &job.given.degree, 1, 4, "degree of the polynomials",
                  "4, with -sharp 2");
  options.number("penalty", &job.given.penalty, 1e-6, 1e6,
                 "weight of the price of a coefficient; larger is smoother", "3, with -sharp 1");
  options.number("t_mdl", &job.given.t_mdl, 1e-9, 1e3, "the paper's T_MDL in place of -penalty",
                 "off");
  options.number("target_error", &job.given.target_error, 1e-12, 1,
                 "RMS residual to reach, as a share of the box diagonal", "off");
  options.integer("max_surfels", &job.given.max_surfels, 0, kMany,
                  "most leaves allowed; 0: as many as it takes");
  options.number("noise_factor", &job.given.noise_factor, 1e-6, 1e30,
                 "residuals and penalty as if the noise variance were X times as large: what "
                 "-target_error and -max_surfels solve for",
                 "off");
  options.number("least_radius", &job.given.least_radius, 0, 1e300,
                 "radius of the smallest ball, in the scan's units: no finer detail is kept",
                 "off");
  options.toggle("sharp", &job.params.sharp_features, "keep sharp edges; needs normals");
  options.toggle("outliers", &job.params.keep_outliers,
                 "fit points that stand apart from all others, too");
  options.toggle("robust", &job.params.robust, "reweight residuals against outliers");
  options.toggle("local_noise", &job.params.local_noise,
                 "noise is measured along the scan, not once for all of it", "auto");
  options.toggle("sides", &job.params.sides,
                 "give points without normals sides first where parts are thin");
  options.text("correlation", &job.correlation, "auto|off|N",
               "points that share their errors, as those of depth cameras do");
  options.numbers("noise_model", &job.noise_model, "A,B,C",
                  "RMS error A + B z + C z^2 along the ray at distance z from the sensor");
  options.toggle("normals_as_data", &job.params.normals_as_data,
                 "fit points and normals together; for normals measured apart from the points");
  options.number("normal_error", &job.given.normal_error, 1e-6, 1.5707,
                 "their RMS error in radians; with -normals_as_data 1", "measured");
  options.toggle("paper", &job.params.paper_mode,
                 "the choices of Ohtake, Belyaev, Alexa 2005 throughout");
  options.toggle("compact", &job.compact,
                 "leaves cover their whole balls: fewer surfels, thinner overlap");
  options.number("lambda", &job.given.lambda, 1e-30, 1,
                 "noise variance, as a share of the squared box diagonal", "estimated");
  declareSensorOptions(options, job,
                       "the side that the normals of a scan without normals shall face");
  options.text("frame_field", &job.frame_field, "NAME",
               "field of a merged scan that numbers its frames: each one's noise is its own");
  options.exclusive({"frames", "frame_field"});
  options.integer("estimate_normals", &job.normal_neighbours, 0, 10000,
                  "estimate normals from N neighbours, as PCL does; 0: none");
  options.toggle("use_normals", &job.use_normals, "use the scan's own normals or faces");
  options.integer("threads", &job.params.threads, 0, 4096,
                  "threads, 0: all cores; never changes the result");
  options.integer("seed", &job.params.seed, 0, kMany,
                  "seed of the order in which centres are tried");
  options.exclusive({"penalty", "t_mdl", "target_error", "max_surfels", "noise_factor"});
  for (const char* name : {"penalty", "trim", "hole"}) options.exclusive({"paper", name});
  for (const char* name : {"t_mdl", "paper"}) options.exclusive({"normals_as_data", name});
  for (const char* name : {"lambda", "local_noise", "t_mdl", "paper"})
    options.exclusive({"noise_model", name});
}

void declareSurfaceOrFit(OptionTable& options, std::string& surface, FitJob& job) {
  options.text("surface", &surface, "FILE",
               "use a surface made by pcl_slim_fit (.pcd, .ply, .vtp, .slim) in place of a fit");
  declareFitOptions(options, job);
  for (const char* name : {"degree",      "penalty",         "t_mdl",        "target_error",
                           "max_surfels", "noise_factor",    "least_radius", "outliers",
                           "robust",      "local_noise",     "sides",        "correlation",
                           "noise_model", "normals_as_data", "normal_error", "paper",
                           "compact",     "lambda",          "seed",         "frames",
                           "frame_field"}) {
    options.exclusive({"surface", name});
  }
}

void declareSensorOptions(OptionTable& options, FitJob& job, const std::string& viewpoint_help) {
  options.numbers("viewpoint", &job.viewpoint, "X,Y,Z", viewpoint_help);
  options.text(
      "trajectory", &job.trajectory, "FILE",
      "where the sensor was, over time (TUM, or CSV with time x y z): each point faces its "
      "place at the point's time; without it, the fields vp_x vp_y vp_z");
  options.text("time_field", &job.time_field, "NAME",
               "with -trajectory: the scan's field of times; not given: found by its name");
  options.number("time_offset", &job.time_offset, -1e18, 1e18,
                 "with -trajectory: seconds added to the points' times", "0");
  options.text(
      "frames", &job.frames, "FILE,...",
      "more registered frames, whose points follow those of IN: each one's sensor is at its "
      "VIEWPOINT (or vp_x vp_y vp_z), and its noise is its own");
  options.exclusive({"viewpoint", "trajectory"});
}

void declareTrimOptions(OptionTable& options, FitJob& job) {
  job.params.trim = true;
  options.toggle("trim", &job.params.trim,
                 "end the surface where the scan ends, and keep the scan's holes");
  options.number("hole", &job.params.hole_size, 2, 50,
                 "diameter of the smallest hole kept, in spacings of the points");
}

void declareColorOption(OptionTable& options, FitJob& job) {
  job.color = true;
  options.toggle("color", &job.color, "give the surface the colours of the scan's points");
}

namespace {

/** Three numbers, if they were given. */
std::optional<std::array<double, 3>> triple(const std::vector<double>& numbers) {
  if (numbers.size() != 3) return std::nullopt;
  return std::array<double, 3>{numbers[0], numbers[1], numbers[2]};
}

/** Transfers -correlation, -noise_model, -lambda and -normal_error to the parameters. */
Error finishNoiseOptions(FitJob& job) {
  FitParams& params = job.params;
  if (job.correlation == "off") {
    params.noise_correlation = 1;
  } else if (job.correlation != "auto") {
    char* end = nullptr;
    const double points = std::strtod(job.correlation.c_str(), &end);
    params.noise_correlation = points;
    if (*end != '\0' || !(points >= 1))
      return {ErrorCode::kBadArgument,
              "-correlation '" + job.correlation + "' is neither auto, off nor a number from 1 on"};
  }
  params.noise_model = triple(job.noise_model);
  params.lambda = unlessZero(job.given.lambda);
  params.normal_error = unlessZero(job.given.normal_error);
  return {};
}

/** What decides how fine the surface is: of these options one can be given. */
SizeRule sizeRule(const FitJob::Given& given) {
  if (given.t_mdl > 0) return MDLThreshold{given.t_mdl};
  if (given.target_error > 0) return TargetError{given.target_error};
  if (given.max_surfels > 0) return MaxSurfels{given.max_surfels};
  if (given.noise_factor > 0) return NoiseFactor{given.noise_factor};
  return PenaltyWeight{unlessZero(given.penalty)};
}

}  // namespace

Error finishFitOptions(FitJob& job) {
  if (Error error = finishNoiseOptions(job)) return error;
  job.params.degree = unlessZero(job.given.degree);
  job.params.size = sizeRule(job.given);
  job.params.least_radius = unlessZero(job.given.least_radius);
  if (job.compact) job.params.cover_radius = 1.0;
  job.params.viewpoint = triple(job.viewpoint);
  if (job.normal_neighbours == 1 || job.normal_neighbours == 2) {
    return {ErrorCode::kBadArgument,
            "a normal needs 3 neighbours or more; raise -estimate_normals"};
  }
  return job.params.validate();
}

namespace {

/** Where the points were seen from: given by the user, or else by the fields. */
Error placeSensors(const FitJob& job, CloudFile& cloud) {
  if (job.trajectory.empty()) {
    if (!job.time_field.empty() || job.time_offset != 0) {
      return {
          ErrorCode::kBadArgument,
          "-time_field and -time_offset need -trajectory: name the file of the sensor's places"};
    }
    if (!job.viewpoint.empty()) cloud.sensors.clear();
    return {};
  }
  const Result<Trajectory> trajectory = loadTrajectory(job.trajectory);
  if (!trajectory) return trajectory.error();
  auto places = sensorPlaces(*trajectory, cloud.file, job.time_field, job.time_offset);
  if (!places) return places.error();
  cloud.sensors = std::move(*places);
  return {};
}

std::vector<std::string> frameFiles(const FitJob& job) {
  std::vector<std::string> files;
  std::istringstream list(job.frames);
  for (std::string file; std::getline(list, file, ',');) files.push_back(file);
  return files;
}

/** Loads a scan with its further frames. */
Result<CloudFile> loadFrames(const std::string& path, const FitJob& job) {
  Result<PointFile> file = loadPointFile(path);
  if (!file) return file.error();
  std::vector<std::uint32_t> numbers;
  if (!job.frames.empty()) {
    if (Error error = mergeFrames(path, frameFiles(job), *file, numbers)) return error;
  } else if (!job.frame_field.empty()) {
    if (Error error = framesByField(file->cloud, job.frame_field, numbers)) return error;
  }
  Result<CloudFile> cloud = asCloudFile(std::move(*file), path);
  if (!cloud) return cloud;
  cloud->frames = std::move(numbers);
  if (Error error = placeSensors(job, *cloud)) return error;
  return cloud;
}

/** How many places points were seen from, up to a number. */
std::size_t countPlaces(const CloudFile& cloud, std::size_t most) {
  std::set<std::array<double, 3>> places;
  for (std::size_t i = 0; i < cloud.sensors.size() && places.size() < most; i += 3)
    places.insert({cloud.sensors[i], cloud.sensors[i + 1], cloud.sensors[i + 2]});
  return places.size();
}

/** What a user reads of a scan's frames. */
std::string frameNote(const FitJob& job, const CloudFile& cloud, std::size_t frames) {
  std::string note = counted(frames, "frame");
  if (!job.frame_field.empty()) return note + ", numbered by field " + job.frame_field;
  if (!job.viewpoint.empty() || !job.trajectory.empty()) return note;
  const std::size_t places = countPlaces(cloud, frames);
  if (places == 0) return note + ", whose VIEWPOINTs are 0: no sensor is known";
  if (places == frames) return note + ", each with its own sensor";
  return note + ", seen from " + counted(places, "place");
}

/** Prints and reports the scan's frames and where the places of sensors are from. */
void reportSensors(const FitJob& job, const CloudFile& cloud, Console& console, Report& report) {
  if (!cloud.frames.empty()) {
    const std::size_t frames = 1 + *std::max_element(cloud.frames.begin(), cloud.frames.end());
    report.json()["frames"] = frames;
    console.note("  " + frameNote(job, cloud, frames));
  }
  const std::string source = cloud.sensors.empty()     ? "none"
                             : !job.trajectory.empty() ? "trajectory"
                             : !job.frames.empty()     ? "frames"
                                                       : "fields";
  report.json()["sensors"] = source;
  if (source == "fields") console.note("  each point's own sensor, from fields vp_x vp_y vp_z");
  if (source == "trajectory") console.note("  each point's own sensor, from " + job.trajectory);
}

}  // namespace

std::vector<std::string> filesRead(const FitJob& job, std::vector<std::string> others) {
  for (const std::string& file : frameFiles(job)) others.push_back(file);
  others.push_back(job.trajectory);
  return others;
}

Result<CloudFile> loadScan(const std::string& path, const FitJob& job, Console& console,
                           Report& report) {
  console.begin("Loading " + path);
  Result<CloudFile> cloud = loadFrames(path, job);
  if (!cloud) return console.failed(cloud.error());
  report.json()["points"] = cloud->size();
  report.time("load", console.seconds());
  console.done(counted(cloud->size(), "point"));
  if (cloud->turned_outwards)
    console.note("  the mesh is closed and inside out: its faces are turned outwards");
  if (!cloud->file.columns.empty()) {
    console.note("  columns: " + cloud->file.columns);
    report.json()["columns"] = cloud->file.columns;
  }
  reportSensors(job, *cloud, console, report);
  if (job.normal_neighbours > 0) {
    console.begin("Estimating normals");
    const Error error =
        estimateNormals(job.normal_neighbours, job.viewpoint, job.params.threads, *cloud);
    if (error) return console.failed(error);
    report.time("normals", console.seconds());
    console.done(std::to_string(job.normal_neighbours) + " neighbours");
  }
  report.json()["normals"] = normalSourceName(
      job.use_normals || job.normal_neighbours > 0 ? cloud->normal_source : NormalSource::kNothing);
  return cloud;
}

bool holdsSurface(const std::string& path, const CloudFile* cloud) {
  return lowerExtension(path) == ".slim" ||
         (cloud != nullptr && findField(cloud->file.cloud, "c0") >= 0);
}

Error loadGiven(const std::string& path, Console& console, Report& report, SLIMSurface& surface) {
  console.begin("Loading " + path);
  Result<SLIMSurface> loaded = loadSurface(path);
  if (!loaded) return console.failed(loaded.error());
  surface = std::move(*loaded);
  report.time("load_surface", console.seconds());
  reportSurface(path, surface, report);
  console.done(counted(surface.numLeaves(), "surfel"));
  return {};
}

namespace {

/** Why options about the noise had no effect, one line each. */
void addNoiseNotes(const FitParams& params, const FitStatistics& fit,
                   std::vector<std::string>& notes) {
  const char* given = params.lambda           ? "-lambda"
                      : params.hasThreshold() ? "-t_mdl"
                      : params.paper_mode     ? "-paper"
                                              : nullptr;
  if (params.local_noise == true && fit.noise.correlation > 1 && !given)
    notes.push_back("  -local_noise has no effect: shared noise is measured along the scan anyway");
  if (params.local_noise == false && given)
    notes.push_back(std::string("  -local_noise has no effect: with ") + given +
                    " noise is the same everywhere");
  if (params.noise_correlation == 1 && given)
    notes.push_back(std::string("  -correlation has no effect: with ") + given +
                    " errors count as independent");
}

/** Why -sides 0 had no effect, or null. */
const char* whyNoSides(const FitParams& params, const FitStatistics& fit) {
  if (params.sides) return nullptr;
  if (fit.sides.source == SideSource::kNormals) return "the scan has normals";
  if (fit.sides.source == SideSource::kViewpoint) return "a viewpoint gives the sides";
  if (params.paper_mode || params.hasThreshold()) return "-paper and -t_mdl give points no sides";
  if (fit.noise.line > 0) return "points on scan lines get no sides";
  return nullptr;
}

/** Options that had no effect on this scan, one line each. */
std::vector<std::string> unusedNotes(const FitJob& job, const CloudFile& cloud,
                                     const FitStatistics& fit) {
  std::vector<std::string> notes;
  addNoiseNotes(job.params, fit, notes);
  const auto* most = std::get_if<MaxSurfels>(&job.params.size);
  if (most && fit.noise_factor == 1) {
    notes.push_back("  -max_surfels " + std::to_string(most->leaves) +
                    " has no effect: this scan needs fewer");
  }
  if (const char* why = whyNoSides(job.params, fit))
    notes.push_back(std::string("  -sides has no effect: ") + why);
  if (!job.use_normals && cloud.normal_source == NormalSource::kNothing)
    notes.push_back("  -use_normals has no effect: the scan has none");
  if (job.params.sharp_features && cloud.normal_source == NormalSource::kNothing)
    notes.push_back("  -sharp has no effect: it needs normals; give -estimate_normals");
  if (!job.use_normals && job.normal_neighbours > 0)
    notes.push_back("  -use_normals 0 has no effect: estimated normals replace the scan's own");
  if (!job.params.trim && job.params.hole_size != FitParams().hole_size)
    notes.push_back("  -hole has no effect: -trim 0 keeps no borders");
  if (job.params.paper_mode && job.params.keep_outliers)
    notes.push_back("  -outliers has no effect: -paper fits all points");
  const bool own =
      cloud.normal_source == NormalSource::kFields || cloud.normal_source == NormalSource::kMesh;
  const bool places = job.params.viewpoint || !job.trajectory.empty();
  if (places && !job.params.noise_model && job.use_normals && own) {
    notes.push_back(std::string(job.params.viewpoint ? "  -viewpoint" : "  -trajectory") +
                    " has no effect: the scan's own normals give the sides");
  }
  return notes;
}

}  // namespace

Error fitScan(const FitJob& job, const CloudFile& cloud, Console& console, Report& report,
              SLIMSurface& surface, PointStore* kept) {
  const double bytes = kBytesOfPoint * static_cast<double>(cloud.size());
  if (Error error = checkMemory(bytes, "fitting " + counted(cloud.size(), "point"))) return error;
  console.begin("Preparing");
  const ScanView scan{cloud.view(job.use_normals || job.normal_neighbours > 0),
                      job.color ? colorsOf(cloud) : ColorView()};
  Result<PointStore> store = PointStore::build(scan.points, job.params.threads);
  if (!store) return console.failed(store.error());
  report.time("prepare", console.seconds());
  console.done(counted(store->size(), "point"));
  const std::string skipped = skippedText(store->statistics());
  if (!skipped.empty()) console.note("  " + skipped);

  console.begin("Fitting");
  FittedScan fitted;
  fitted.store = std::move(*store);
  Error error = fitStoredScan(scan, job.params, fitted, &console.progress());
  if (error && error.code != ErrorCode::kNoSurface) return console.failed(error);
  surface = std::move(fitted.surface);
  const FitStatistics& statistics = fitted.statistics;
  if (!error && job.color) report.time("colors", fitted.color_seconds);
  report.time("fit", console.seconds());
  reportFit(fittedPoints(fitted.store), surface, statistics, report);
  console.done(std::to_string(statistics.leaves) + " leaves, " +
               counted(surface.numLevels(), "level"));
  console.note("  " + noiseText(fitted.store.diagonal() * fitted.store.scale(), statistics));
  if (std::holds_alternative<TargetError>(job.params.size) ||
      std::holds_alternative<MaxSurfels>(job.params.size))
    console.note("  " + solvedText(statistics));
  if (statistics.sides.points > 0) console.note("  " + sidesText(statistics));
  for (const std::string& note : unusedNotes(job, cloud, statistics)) console.note(note);
  for (const std::string& note : coverNotes(statistics)) console.note(note);
  if (statistics.noise.normals_follow_points) {
    console.note(
        "  the normals follow the points' own noise, or too few points tell: "
        "used as directions, not as data");
  }
  if (kept) *kept = std::move(fitted.store);
  return error;
}

}  // namespace pcl_slim

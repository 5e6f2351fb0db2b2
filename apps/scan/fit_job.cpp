// SPDX-License-Identifier: BSD-3-Clause
#include "scan/fit_job.h"

#include <algorithm>
#include <initializer_list>
#include <iterator>
#include <set>
#include <sstream>
#include <type_traits>
#include <utility>
#include <variant>

#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/filters/io/trajectory.h"
#include "pcl_slim/scan/scan.h"

namespace pcl_slim {

namespace {

constexpr double kBytesOfPoint = 60;  ///< that a fit takes at least while the store is built

const char* normalSourceName(NormalSource source) {
  switch (source) {
    case NormalSource::kFields: return "fields";
    case NormalSource::kMesh: return "mesh";
    case NormalSource::kEstimated: return "estimated";
    default: return "none";
  }
}

void declareMember(OptionTable& options, FitParams& params, const FitParameter& row,
                   std::optional<std::array<double, 3>> FitParams::*member) {
  options.numbers(row.name, &(params.*member), row.option.parts, row.help);
}

/** Adds the option of one parameter, which is read into params. */
template <typename Holder, typename Value>
void declareMember(OptionTable& options, FitParams& params, const FitParameter& row,
                   Value Holder::*member) {
  using Number = decltype(getParameter(params, member));
  const auto& [low, high, unset, parts, on, read] = row.option;
  const std::string shown =
      *unset ? unset : numberText(static_cast<double>(getParameter(params, member)));
  if constexpr (std::is_same_v<Number, bool>) {
    options.toggle(
        row.name, [&params, member](bool value) { params.*member = value; }, row.help, shown);
  } else if constexpr (std::is_integral_v<Number>) {
    const auto store = [&params, member](std::int64_t value) {
      setParameter(params, member, static_cast<Number>(value));
    };
    options.integer(row.name, store, static_cast<std::int64_t>(low),
                    static_cast<std::int64_t>(high), row.help, shown);
  } else if (on) {
    const auto store = [&params, member, value = *on](bool chosen) {
      setParameter(params, member, chosen ? value : 0.0);
    };
    options.toggle(row.name, store, row.help, shown);
  } else {
    const auto store = [&params, member](double value) { setParameter(params, member, value); };
    options.number(row.name, store, low, high, row.help, shown);
  }
}

void declareParameter(OptionTable& options, FitJob& job, const FitParameter& row) {
  if (row.option.read) {
    std::string& word = job.words[row.name] = row.option.unset;
    options.text(row.name, &word, row.option.parts, row.help);
    return;
  }
  std::visit([&](auto member) { declareMember(options, job.params, row, member); }, row.member);
}

void declareParameters(OptionTable& options, FitJob& job, std::initializer_list<FitOption> groups) {
  for (const FitParameter& row : fitParameters()) {
    if (std::count(groups.begin(), groups.end(), row.group)) declareParameter(options, job, row);
  }
}

/** Options of a sensor's noise, which the process of one input hands on to that of the next. */
void declareSensorNoise(OptionTable& options, FitJob& job) {
  options.text("noise_from", &job.noise_from, "FILE.json",
               "noise of the sensor, saved by -save_noise of an earlier frame: used if this scan's "
               "residuals agree with it, else measured",
               FileUse::kRead);
  options.text("save_noise", &job.save_noise, "FILE.json",
               "write the noise of the sensor for the next frames", FileUse::kWritten);
  options.toggle("same_sensor", &job.same_sensor,
                 "with -out: each scan's noise is that of the one before while its residuals agree "
                 "with it",
                 "auto: those with equal rows and columns");
  for (const char* name : {"noise", "lambda", "noise_model", "t_mdl", "paper"}) {
    options.exclusive({"noise_from", name});
    options.exclusive({"save_noise", name});
  }
  options.exclusive({"noise_from", "correlation"});
  const auto wanted = [&job](const OptionTable& table) {
    const auto given = [&table](const char* name) { return table.given(name); };
    constexpr const char* kOthers[] = {"noise_from", "noise", "lambda",      "noise_model",
                                       "t_mdl",      "paper", "correlation", "local_noise",
                                       "surface",    "mesh"};
    return job.same_sensor.value_or(true) &&
           std::none_of(std::begin(kOthers), std::end(kOthers), given);
  };
  const auto keeps = [&job](const std::string& text) {
    const Result<SensorNoise> noise = sensorNoiseFromJson(text, "the scan before");
    return noise && (job.same_sensor.value_or(false) || noise->rows > 0);
  };
  options.handOn({"save_noise", "noise_from", wanted, keeps});
}

}  // namespace

void declareFitOptions(OptionTable& options, FitJob& job) {
  declareParameters(options, job, {FitOption::kFit, FitOption::kScan});
  declareSensorOptions(options, job);
  declareInputOptions(options, job.input);
  options.text("frame_field", &job.frame_field, "NAME",
               "field of a merged scan that numbers its frames: each one's noise is its own");
  options.exclusive({"frames", "frame_field"});
  options.integer("estimate_normals", &job.normal_neighbours, 0, 10000,
                  "estimate normals from N neighbours, as PCL does; 0: none");
  options.toggle("use_normals", &job.use_normals, "use the scan's own normals or faces");
  declareSensorNoise(options, job);
  declareParameters(options, job, {FitOption::kThreads, FitOption::kRun});
  for (const auto& names : exclusiveFitParameters())
    options.exclusive({names.begin(), names.end()});
}

void declareSurfaceOrFit(OptionTable& options, std::string& surface, FitJob& job) {
  options.text("surface", &surface, "FILE",
               "use a surface made by pcl_slim_fit (.pcd, .ply, .vtp, .slim) in place of a fit",
               FileUse::kRead);
  declareFitOptions(options, job);
  for (const FitParameter& row : fitParameters()) {
    if (row.group == FitOption::kFit || row.group == FitOption::kRun)
      options.exclusive({"surface", row.name});
  }
  for (const char* name : {"frames", "frame_field", "noise_from", "save_noise"})
    options.exclusive({"surface", name});
}

void declareSensorOptions(OptionTable& options, FitJob& job, const char* viewpoint_help) {
  for (FitParameter row : fitParameters()) {
    if (row.group != FitOption::kSensor) continue;
    if (viewpoint_help) row.help = viewpoint_help;
    declareParameter(options, job, row);
  }
  options.text(
      "trajectory", &job.trajectory, "FILE",
      "where the sensor was, over time (TUM, or CSV with time x y z): each point faces its "
      "place at the point's time; without it, the fields vp_x vp_y vp_z",
      FileUse::kRead);
  options.text("time_field", &job.time_field, "NAME",
               "with -trajectory: the scan's field of times; not given: found by its name");
  options.number("time_offset", &job.time_offset, -1e18, 1e18,
                 "with -trajectory: seconds added to the points' times", "0");
  options.text(
      "frames", &job.frames, "FILE,...",
      "more registered frames, whose points follow those of IN: each one's sensor is at its "
      "VIEWPOINT (or vp_x vp_y vp_z), and its noise is its own",
      FileUse::kRead);
  options.exclusive({"viewpoint", "trajectory"});
}

void declareTrimOptions(OptionTable& options, FitJob& job) {
  job.params.trim = true;
  declareParameters(options, job, {FitOption::kTrim});
}

void declareColorOption(OptionTable& options, FitJob& job) {
  job.color = true;
  options.toggle("color", &job.color, "give the surface the colours of the scan's points");
}

Error finishFitOptions(FitJob& job) {
  for (const FitParameter& row : fitParameters()) {
    if (!row.option.read) continue;
    if (Error error = row.option.read(job.words[row.name], job.params)) return error;
  }
  if (job.normal_neighbours == 1 || job.normal_neighbours == 2) {
    return {ErrorCode::kBadArgument,
            "a normal needs 3 neighbours or more; raise -estimate_normals"};
  }
  if (Error error = checkInputOptions(job.input)) return error;
  job.params.keep_sensor_noise = !job.save_noise.empty();
  if (!job.noise_from.empty()) {
    Result<SensorNoise> noise = loadSensorNoise(job.noise_from);
    if (!noise) return noise.error();
    job.params.sensor_noise = *noise;
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
    if (job.params.viewpoint) cloud.sensors.clear();
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
Result<CloudFile> loadFrames(const std::string& path, const FitJob& job, PointFile* read) {
  Result<PointFile> file = loadPoints(path, job.input, read);
  if (!file) return file.error();
  std::vector<std::uint32_t> numbers;
  if (!job.frames.empty()) {
    if (Error error = mergeFrames(path, frameFiles(job), job.input, *file, numbers)) return error;
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
  if (job.params.viewpoint || !job.trajectory.empty()) return note;
  const std::size_t places = countPlaces(cloud, frames);
  if (places == 0) return note + ", whose VIEWPOINTs are 0: no sensor is known";
  if (places == frames) return note + ", each with its own sensor";
  return note + ", seen from " + counted(places, "place");
}

/** Prints and reports the scan's frames and where the places of sensors are from. */
void reportSensors(const FitJob& job, const CloudFile& cloud, Console& console, Report& report) {
  if (!cloud.frames.empty()) {
    const std::size_t frames = 1 + *std::max_element(cloud.frames.begin(), cloud.frames.end());
    report.set("frames", frames);
    console.note("  " + frameNote(job, cloud, frames));
  }
  const std::string source = cloud.sensors.empty()     ? "none"
                             : !job.trajectory.empty() ? "trajectory"
                             : !job.frames.empty()     ? "frames"
                                                       : "fields";
  report.set("sensors", source);
  if (source == "fields") console.note("  each point's own sensor, from fields vp_x vp_y vp_z");
  if (source == "trajectory") console.note("  each point's own sensor, from " + job.trajectory);
}

}  // namespace

std::vector<std::string> filesRead(const FitJob& job, std::vector<std::string> others) {
  for (const std::string& file : frameFiles(job)) others.push_back(file);
  others.push_back(job.trajectory);
  others.push_back(job.noise_from);
  return others;
}

Result<CloudFile> loadScan(const std::string& path, const FitJob& job, Console& console,
                           Report& report, PointFile* read) {
  console.begin("Loading " + path);
  Result<CloudFile> cloud = loadFrames(path, job, read);
  if (!cloud) return console.failed(cloud.error());
  report.set("points", cloud->size());
  report.time("load", console.seconds());
  console.done(counted(cloud->size(), "point"));
  if (cloud->turned_outwards)
    console.note("  the mesh is closed and inside out: its faces are turned outwards");
  noteInput(cloud->file, job.input, console, report);
  reportSensors(job, *cloud, console, report);
  if (job.normal_neighbours > 0) {
    console.begin("Estimating normals");
    const Error error =
        estimateNormals(job.normal_neighbours, job.params.viewpoint, job.params.threads, *cloud);
    if (error) return console.failed(error);
    report.time("normals", console.seconds());
    console.done(std::to_string(job.normal_neighbours) + " neighbours");
  }
  report.set("normals", normalSourceName(job.use_normals || job.normal_neighbours > 0
                                             ? cloud->normal_source
                                             : NormalSource::kNothing));
  return cloud;
}

namespace {

/** Options that had no effect on this scan, one line each. */
std::vector<std::string> unusedNotes(const FitJob& job, const CloudFile& cloud,
                                     const FitStatistics& fit) {
  std::vector<std::string> notes;
  for (const auto& [name, reason] : idleParameters(job.params, fit))
    notes.push_back("  -" + name + " has no effect: " + reason);
  if (!job.use_normals && cloud.normal_source == NormalSource::kNothing)
    notes.push_back("  -use_normals has no effect: the scan has none");
  if (job.params.sharp_features && cloud.normal_source == NormalSource::kNothing)
    notes.push_back("  -sharp has no effect: it needs normals; give -estimate_normals");
  if (!job.use_normals && job.normal_neighbours > 0)
    notes.push_back("  -use_normals 0 has no effect: estimated normals replace the scan's own");
  for (const auto& [name, reason] : overruledParameters(job.params))
    notes.push_back("  -" + name + " has no effect: " + reason);
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
  std::string sensor_note;
  const FitParams params = paramsFor(job, cloud, sensor_note);
  Error error = fitStoredScan(scan, params, fitted, &console.progress());
  if (error && error.code != ErrorCode::kNoSurface) return console.failed(error);
  surface = std::move(fitted.surface);
  const FitStatistics& statistics = fitted.statistics;
  if (!error && job.color) report.time("colors", fitted.color_seconds);
  report.time("fit", console.seconds());
  reportFit(fittedPoints(fitted.store), surface, statistics, report);
  console.done(std::to_string(statistics.leaves) + " leaves, " +
               counted(surface.numLevels(), "level"));
  const double diagonal = fitted.store.diagonal() * fitted.store.scale();
  console.note("  " + noiseText(diagonal, statistics));
  if (std::holds_alternative<TargetError>(job.params.size) ||
      std::holds_alternative<MaxSurfels>(job.params.size))
    console.note("  " + solvedText(statistics));
  if (std::holds_alternative<TargetDistance>(job.params.size))
    console.note("  " + solvedText(statistics, diagonal));
  if (statistics.sides.points > 0) console.note("  " + sidesText(statistics));
  printSideNotes(statistics.sides.source, statistics.sides.normals, console);
  for (const std::string& note : unusedNotes(job, cloud, statistics)) console.note(note);
  for (const std::string& note : coverNotes(statistics)) console.note(note);
  for (const std::string& note : colorNotes(surface)) console.note(note);
  if (statistics.noise.normals_follow_points) {
    console.note(
        "  the normals follow the points' own noise, or too few points tell: "
        "used as directions, not as data");
  }
  const Error unsaved =
      finishSensorNoise(job, cloud, statistics.noise, sensor_note, console, report);
  if (kept) *kept = std::move(fitted.store);
  return error ? error : unsaved;
}

}  // namespace pcl_slim

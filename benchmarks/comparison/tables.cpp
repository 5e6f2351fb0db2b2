// SPDX-License-Identifier: BSD-3-Clause
#include "comparison/tables.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <thread>
#include <utility>

#include "pcl_slim/core/file_access.h"
#include "support/lab/bench.h"
#include "support/lab/scenes.h"

namespace pcl_slim::comparison {

namespace {

constexpr double kLongRun = 2.0;  // seconds; random variation is small in comparison
constexpr double kDegreesPerRadian = 180 / M_PI;

/** Angle in radians between two directions regardless of sign; sound for the smallest angles.
 * \param[out] same_side whether they point to one side. */
double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b, bool& same_side) {
  const double dot = a.dot(b);
  same_side = dot >= 0;
  return std::atan2(a.cross(b).norm(), std::abs(dot));
}

/** Sums over points, as measure() collects them. */
struct Sums {
  double position = 0, worst = 0, normal = 0, curvature = 0, true_curvature = 0;
  std::size_t points = 0, directions = 0;

  void addPosition(double distance) {
    position += distance * distance;
    worst = std::max(worst, std::abs(distance));
    ++points;
  }

  void addNormal(const pcl::PointNormal& p, const measure::Truth& truth,
                 const float* mean_curvature) {
    bool same_side = true;
    const Eigen::Vector3d true_normal(truth.normal.data());
    const double angle =
        angleBetween(p.getNormalVector3fMap().cast<double>(), true_normal, same_side);
    normal += angle * angle;
    ++directions;
    if (mean_curvature == nullptr) return;
    const double mean = (same_side ? 1 : -1) * *mean_curvature;
    curvature += (mean - truth.mean_curvature) * (mean - truth.mean_curvature);
    true_curvature += truth.mean_curvature * truth.mean_curvature;
  }
};

bool belongs(const Run& run, Family family, int given) {
  const Setting& s = run.setting;
  if (s.method == Method::kSlim && given >= 0 && s.normals != (given == 1)) return false;
  switch (family) {
    case Family::kSlimDefault: return s.method == Method::kSlim && s.automatic();
    case Family::kSlim: return s.method == Method::kSlim;
    case Family::kMls: return s.method == Method::kMls;
    case Family::kMlsOrder2: return s.method == Method::kMls && s.degree == 2;
    default: return s.method == Method::kNormals;
  }
}

/** Three digits; an empty cell for what a method does not give. */
std::string number(double value) {
  char text[32] = "";
  if (std::isfinite(value)) std::snprintf(text, sizeof(text), "%.3g", value);
  return text;
}

double microseconds(double seconds, const SceneRuns& scene) {
  return 1e6 * seconds / static_cast<double>(scene.points);
}

std::string firstLine(const char* path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.compare(0, key.size(), key) != 0) continue;
    const std::size_t colon = key.empty() ? 0 : line.find(':') + 2;
    return line.substr(std::min(colon, line.size()));
  }
  return "unknown";
}

/** CPU of MLS order 2 at its best radius against the cheapest SLIM run that is no worse. */
std::string ratioRow(const SceneRuns& scene, const Run& rival, int given) {
  const Run* cheapest = cheapestRun(scene, Family::kSlim, given, rival.errors.position);
  const Run* automatic = bestRun(scene, Family::kSlimDefault, given, &Errors::position);
  if (!cheapest && !automatic) return "";
  const auto cells = [&](const Run* run) {
    if (!run) return std::string(" none | | | |");
    const bool no_worse = run->errors.position <= rival.errors.position;
    return " " + run->setting.text() + " | " + number(run->errors.position) + " | " +
           number(microseconds(run->cpu, scene)) + " | " +
           (no_worse ? number(rival.cpu / run->cpu) : "above") + " |";
  };
  return "| " + scene.title() + " | " + rival.setting.text() + " | " +
         number(rival.errors.position) + " | " + number(microseconds(rival.cpu, scene)) + " | " +
         (given ? "given" : "none") + " |" + cells(cheapest) + cells(automatic) + "\n";
}

std::string ratioTable(const std::vector<SceneRuns>& scenes) {
  std::string rows;
  for (const SceneRuns& scene : scenes) {
    const Run* rival = bestRun(scene, Family::kMlsOrder2, -1, &Errors::position);
    if (!rival) continue;
    rows += ratioRow(scene, *rival, 0) + ratioRow(scene, *rival, 1);
  }
  if (rows.empty()) return "";
  return "## CPU at equal or lower RMS position error\n\n"
         "| scene | MLS order 2, best radius | RMS | µs/pt | normals | cheapest SLIM no worse | "
         "RMS "
         "| µs/pt | ratio | SLIM default | RMS | µs/pt | ratio |\n"
         "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n" +
         rows + "\n";
}

std::string errorRow(const SceneRuns& scene, const std::string& what, const Run* run) {
  if (!run) return "";
  const Errors& e = run->errors;
  return "| " + what + " | " + run->setting.fullText() + " | " +
         number(microseconds(run->cpu, scene)) + " | " + number(microseconds(run->wall, scene)) +
         " | " + number(e.position) + " | " + number(e.worst) + " | " + number(e.normal) + " | " +
         number(e.curvature) + " | " +
         (run->peak_bytes < 0 ? "" : number(run->peak_bytes / 1048576)) + " | " +
         std::to_string(run->kept) + " |\n";
}

std::string bestTable(const SceneRuns& scene) {
  std::string text =
      "## " + scene.title() + ", " + std::to_string(scene.points) + " points\n\n" +
      (scene.mean_edges ? "Lengths in mean edges of the truth. " : "") + "The input is off by " +
      number(scene.input.position) + " RMS, " + number(scene.input.worst) + " at most" +
      (scene.judged < scene.points ? ", at the " + std::to_string(scene.judged) +
                                         " points by the truth's surface, which alone count"
                                   : "") +
      ".\n\n" +
      "| best | run | CPU µs/pt | wall µs/pt | RMS | max | normal ° | curvature | MB "
      "| without result |\n|---|---|---|---|---|---|---|---|---|---|\n";
  for (const int given : {0, 1}) {
    text +=
        errorRow(scene, "default", bestRun(scene, Family::kSlimDefault, given, &Errors::position));
  }
  const struct {
    const char* name;
    double Errors::*error;
  } kinds[] = {{"position", &Errors::position},
               {"normal", &Errors::normal},
               {"curvature", &Errors::curvature}};
  for (const auto& kind : kinds) {
    text += errorRow(scene, kind.name, bestRun(scene, Family::kSlim, 0, kind.error));
    text += errorRow(scene, kind.name, bestRun(scene, Family::kSlim, 1, kind.error));
    text += errorRow(scene, kind.name, bestRun(scene, Family::kMls, -1, kind.error));
  }
  return text + errorRow(scene, "normal", bestRun(scene, Family::kNormals, -1, &Errors::normal)) +
         "\n";
}

}  // namespace

Errors measure(const Scene& scene, const Treated& treated) {
  Sums sums;
  for (std::size_t i = 0; i < scene.size(); ++i) {
    if (!scene.isJudged(i)) continue;
    const pcl::PointNormal& p = treated.points[i];
    const measure::Truth truth = scene.truth(i, {p.x, p.y, p.z});
    sums.addPosition(truth.distance);
    if (!treated.done[i] || truth.rim) continue;
    sums.addNormal(p, truth, treated.mean_curvature.empty() ? nullptr : &treated.mean_curvature[i]);
  }
  Errors e;
  if (treated.moves_points && sums.points > 0) {
    e.position = std::sqrt(sums.position / static_cast<double>(sums.points)) / scene.unit;
    e.worst = sums.worst / scene.unit;
  }
  if (sums.directions == 0) return e;
  if (scene.has_true_normals) {
    e.normal = kDegreesPerRadian * std::sqrt(sums.normal / static_cast<double>(sums.directions));
  }
  if (scene.has_true_curvature && !treated.mean_curvature.empty()) {
    e.curvature = std::sqrt(sums.curvature / sums.true_curvature);
  }
  return e;
}

Errors inputErrors(const Scene& scene) {
  Treated untouched;
  untouched.done.assign(scene.size(), 0);
  for (const pcl::PointXYZ& p : *scene.points) {
    untouched.points.push_back(pcl::PointNormal(p.x, p.y, p.z));
  }
  return measure(scene, untouched);
}

Result<Run> runSetting(const Scene& scene, const Setting& setting, int repeats) {
  Run run;
  run.setting = setting;
  Result<Treated> treated = Error();
  std::vector<double> cpu, wall;
  for (int r = 0; r < std::max(1, repeats); ++r) {
    treated = Error();
    // It hands free memory back to the system: the runs after the first use theirs again.
    std::optional<measure::MemoryGauge> memory;
    if (r == 0) memory.emplace();
    treated = treat(scene, setting);
    if (!treated) return treated.error();
    cpu.push_back(treated->cpu);
    wall.push_back(treated->wall);
    if (memory) run.peak_bytes = memory->peakBytes();
    if (treated->wall > kLongRun) break;
  }
  run.cpu = measure::median(cpu);
  run.wall = measure::median(wall);
  run.errors = measure(scene, *treated);
  for (const std::uint8_t done : treated->done) run.kept += done == 0;
  return run;
}

std::string SceneRuns::title() const {
  return noise > 0 ? name + ", " + number(100 * noise) + " % noise" : name;
}

const Run* bestRun(const SceneRuns& scene, Family family, int given, double Errors::*error) {
  const Run* best = nullptr;
  for (const Run& run : scene.runs) {
    if (!belongs(run, family, given) || !std::isfinite(run.errors.*error)) continue;
    if (!best || run.errors.*error < best->errors.*error) best = &run;
  }
  return best;
}

const Run* cheapestRun(const SceneRuns& scene, Family family, int given, double bound) {
  const Run* best = nullptr;
  for (const Run& run : scene.runs) {
    // Also false where there is no position error.
    const bool fits = belongs(run, family, given) && run.errors.position <= bound;
    if (fits && (!best || run.cpu < best->cpu)) best = &run;
  }
  return best;
}

std::string machineText(const std::string& command) {
  double load[1] = {0};
  const bool known = getloadavg(load, 1) == 1;
  return "Machine: " + firstLine("/proc/cpuinfo", "model name") + ", " +
         std::to_string(std::thread::hardware_concurrency()) +
         " threads; load average at the end " + (known ? number(load[0]) : "unknown") +
         ". Command:\n\n```\n" + command + "\n```\n\n";
}

std::string csvText(const std::vector<SceneRuns>& scenes) {
  std::string text =
      "scene,points,noise,unit,method,setting,normals,threads,cpu_us_per_point,wall_us_per_point,"
      "rms_position,max_position,rms_normal_deg,mean_curvature_error,peak_mb,without_result\n";
  for (const SceneRuns& scene : scenes) {
    for (const Run& run : scene.runs) {
      const Setting& s = run.setting;
      const Errors& e = run.errors;
      text += scene.name + "," + std::to_string(scene.points) + "," + number(scene.noise) + "," +
              (scene.mean_edges ? "mean_edge" : "1") + "," + methodName(s.method) + "," + s.text() +
              "," + (s.normals ? "1" : "0") + "," + std::to_string(s.threads) + "," +
              number(microseconds(run.cpu, scene)) + "," + number(microseconds(run.wall, scene)) +
              "," + number(e.position) + "," + number(e.worst) + "," + number(e.normal) + "," +
              number(e.curvature) + "," +
              (run.peak_bytes < 0 ? "" : number(run.peak_bytes / 1048576)) + "," +
              std::to_string(run.kept) + "\n";
    }
  }
  return text;
}

std::string markdownText(const std::vector<SceneRuns>& scenes, const std::string& command) {
  std::string text = "# SLIM beside PCL\n\n" + machineText(command) + ratioTable(scenes);
  for (const SceneRuns& scene : scenes) text += bestTable(scene);
  return text;
}

Error checkTables(const std::string& prefix) {
  for (const char* extension : {".csv", ".md"}) {
    if (Error error = checkWritable(prefix + extension)) return error;
  }
  return {};
}

Error writeTables(const std::string& prefix, const std::string& csv, const std::string& markdown,
                  Console& console) {
  FileTransaction files;
  Error error = writeFile(prefix + ".csv", csv.data(), csv.size());
  if (!error) error = writeFile(prefix + ".md", markdown.data(), markdown.size());
  if (!error) error = files.commit();
  if (!error) console.note("> Wrote " + prefix + ".csv and " + prefix + ".md");
  return error;
}

}  // namespace pcl_slim::comparison

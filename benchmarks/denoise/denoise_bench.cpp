// SPDX-License-Identifier: BSD-3-Clause
// The public denoising protocol on meshes with thin parts: squared errors of the default beside
// those of pcl::MovingLeastSquares and of CGAL's jets, each at its best size with hindsight.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <sstream>

#include "common/run_program.h"
#include "denoise/mesh_scan.h"
#include "fit/smoothed_points.h"
#include "pcl_slim/core/file_access.h"
#include "rivals/jets.h"
#include "rivals/mls.h"
#include "support/lab/bench.h"

namespace {

using namespace pcl_slim;
using denoise::Errors;
using denoise::MeshScan;
using denoise::Points;

struct Settings {
  std::string data, meshes, points = "10000,50000", noise = "0.01,0.02,0.03";
  std::string neighbors = "16,32,64,128,256", save;
  int threads = 1, seed = 1;
  bool jets = true, mls = true, bounds = true;

  std::vector<double> point_list, noise_list, neighbor_list;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("denoise_bench", "1",
                      "Measures denoising of points of meshes beside MLS and CGAL's jets.");
  options.positional("FOLDER", &s.data, "folder of meshes, .ply with faces");
  options.text("meshes", &s.meshes, "NAME,...", "meshes of the folder; all if empty");
  options.text("points", &s.points, "N,...", "points of a mesh");
  options.text("noise", &s.noise, "S,...",
               "RMS errors along each axis, in radii of the unit sphere");
  options.text("neighbors", &s.neighbors, "K,...",
               "neighbours of the jets; MLS takes the radius that has as many on a plane");
  options.toggle("jets", &s.jets, "run CGAL's jets");
  options.toggle("mls", &s.mls, "run pcl::MovingLeastSquares");
  options.toggle("bounds", &s.bounds, "fit with the true noise, and with the true normals, too");
  options.text("save", &s.save, "FOLDER",
               "write the noisy points there, as text: MESH_POINTS_NOISE.xyz");
  options.integer("seed", &s.seed, 0, 1000000, "seed of points and noise");
  options.integer("threads", &s.threads, 0, 4096, "threads of the fit, 0: all cores");
  return options;
}

Error finishOptions(Settings& s) {
  if (s.jets) {
    if (Error error = rivals::requireJets("-jets 0")) return error;
  }
  return measure::parseLists({{"points", &s.points, 100, 1e7, true, &s.point_list},
                              {"noise", &s.noise, 0, 1, false, &s.noise_list},
                              {"neighbors", &s.neighbors, 8, 10000, true, &s.neighbor_list}});
}

/** A method's errors, the seconds it took, and what its size was. */
struct Outcome {
  Errors errors;
  double seconds = 0, size = 0;
};

/** Least errors of each kind over a method's sizes; size and seconds are those of the least mesh
 * error. */
template <typename Run>
Outcome bestOf(const MeshScan& scan, const std::vector<double>& sizes, const Run& run) {
  Outcome best;
  best.errors.chamfer = best.errors.mesh = 1e300;
  for (const double size : sizes) {
    const double start = measure::cpuSeconds();
    const Points moved = run(size);
    const double seconds = measure::cpuSeconds() - start;
    const Errors errors = denoise::errorsOf(scan, moved);
    const double chamfer = std::min(best.errors.chamfer, errors.chamfer);
    if (errors.mesh < best.errors.mesh) best = {errors, seconds, size};
    best.errors.chamfer = chamfer;
  }
  return best;
}

/** A row of the table: errors by column, and noise found over noise. */
struct Row {
  std::map<std::string, Outcome> columns;
  double sigma_ratio = 0;
};

Error addOurs(const Settings& s, const MeshScan& scan, const Points& points, double noise,
              Row& row) {
  const double diagonal = [&] {
    Vector3 low = points.front(), high = low;
    for (const Vector3& p : points) {
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], p[a]);
        high[a] = std::max(high[a], p[a]);
      }
    }
    return length(subtract(high, low));
  }();
  std::vector<float> normals;
  for (const Vector3& n : scan.normals) normals.insert(normals.end(), n.begin(), n.end());
  for (const char* column : {"default", "true noise", "true normals"}) {
    const std::string name = column;
    if (name != "default" && !s.bounds) continue;
    CloudView view = measure::viewOf(points);
    FitParams params;
    params.trim = false;
    params.threads = s.threads;
    if (name == "true noise") params.lambda = std::pow(noise / diagonal, 2);
    if (name == "true normals") {
      view.normal = normals.data();
      view.normal_stride = 3 * sizeof(float);
    }
    const auto smoothed = measure::smoothPoints(view, params);
    if (!smoothed) return smoothed.error();
    row.columns[name] = {denoise::errorsOf(scan, smoothed->points), smoothed->seconds, 0};
    if (name == "default") row.sigma_ratio = smoothed->sigma / noise;
  }
  return {};
}

Error savePoints(const Settings& s, const MeshScan& scan, double noise, const Points& points) {
  char line[128];
  std::snprintf(line, sizeof(line), "_%zu_%g.xyz", points.size(), noise);
  const std::string path = s.save + "/" + scan.name + line;
  std::string text;
  for (const Vector3& p : points) {
    std::snprintf(line, sizeof(line), "%.9g %.9g %.9g\n", p[0], p[1], p[2]);
    text += line;
  }
  return writeFile(path, text.data(), text.size());
}

Result<Row> measureRow(const Settings& s, const MeshScan& scan, double noise) {
  const Points points =
      denoise::noisy(scan.points, noise, static_cast<std::uint64_t>(s.seed) + 1000);
  if (!s.save.empty()) {
    if (Error error = savePoints(s, scan, noise, points)) return error;
  }
  Row row;
  if (Error error = addOurs(s, scan, points, noise, row)) return error;
  row.columns["raw"] = {denoise::errorsOf(scan, points), 0, 0};
  if (s.jets) {
    row.columns["jets"] = bestOf(scan, s.neighbor_list, [&](double k) {
      return rivals::smoothByJets(points, static_cast<std::size_t>(k));
    });
  }
  if (s.mls) {
    row.columns["MLS"] = bestOf(scan, s.neighbor_list, [&](double k) {
      const double share = k / static_cast<double>(points.size());
      return rivals::smoothByMls(points, 2, std::sqrt(share * scan.area / M_PI)).points;
    });
  }
  return row;
}

/** Columns in the order they are printed. */
std::vector<std::string> columnsOf(const Settings& s) {
  std::vector<std::string> columns = {"default"};
  if (s.bounds) columns.insert(columns.end(), {"true noise", "true normals"});
  if (s.jets) columns.emplace_back("jets");
  if (s.mls) columns.emplace_back("MLS");
  columns.emplace_back("raw");
  return columns;
}

void printHeader(const Settings& s) {
  std::printf("Squared errors x 1e4: CD / P2M (size) CPU s\n\n| mesh | points | noise |");
  for (const std::string& column : columnsOf(s)) std::printf(" %s |", column.c_str());
  std::printf(" P2M / best rival's | noise found / true |\n|---|---|---|");
  for (std::size_t i = 0; i < columnsOf(s).size(); ++i) std::printf("---|");
  std::printf("---|---|\n");
}

void printRow(const Settings& s, const std::string& mesh, double points, double noise,
              const Row& row) {
  std::printf("| %s | %g | %g |", mesh.c_str(), points, noise);
  double best = 1e300;
  for (const std::string& column : columnsOf(s)) {
    const Outcome& outcome = row.columns.at(column);
    std::printf(" %.3g / %.3g", outcome.errors.chamfer, outcome.errors.mesh);
    if (outcome.size > 0) std::printf(" (%g)", outcome.size);
    if (outcome.seconds > 0) std::printf(" %.2f", outcome.seconds);
    std::printf(" |");
    if (column == "jets" || column == "MLS") best = std::min(best, outcome.errors.mesh);
  }
  const double ratio = row.columns.at("default").errors.mesh / best;
  std::printf(s.jets || s.mls ? " %.2f |" : " - |", ratio);
  std::printf(" %.2f |\n", row.sigma_ratio);
  std::fflush(stdout);
}

/** Mean errors over meshes; a rival's size is free for each. */
Row meanOf(const std::vector<Row>& rows) {
  Row mean;
  const double share = 1 / static_cast<double>(rows.size());
  for (const Row& row : rows) {
    for (const auto& [name, outcome] : row.columns) {
      Outcome& sum = mean.columns[name];
      sum.errors.chamfer += share * outcome.errors.chamfer;
      sum.errors.mesh += share * outcome.errors.mesh;
      sum.seconds += share * outcome.seconds;
    }
    mean.sigma_ratio += share * row.sigma_ratio;
  }
  return mean;
}

Result<std::vector<std::string>> meshFiles(const Settings& s) {
  std::vector<std::string> files;
  std::istringstream list(s.meshes);
  for (std::string name; std::getline(list, name, ',');)
    files.push_back(s.data + "/" + name + ".ply");
  if (!files.empty()) return files;
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(s.data, failure)) {
    if (entry.path().extension() == ".ply") files.push_back(entry.path().string());
  }
  if (failure) return Error{ErrorCode::kIo, s.data + ": " + failure.message()};
  std::sort(files.begin(), files.end());
  return files;
}

Exit run(Settings& s) {
  if (Error error = finishOptions(s)) return Exit::usage(error);
  const auto files = meshFiles(s);
  if (!files) return files.error();
  printHeader(s);
  for (const double points : s.point_list) {
    std::map<double, std::vector<Row>> rows;
    for (const std::string& file : *files) {
      const auto scan = denoise::loadMeshScan(file, static_cast<std::size_t>(points),
                                              static_cast<std::uint64_t>(s.seed));
      if (!scan) return scan.error();
      for (const double noise : s.noise_list) {
        const auto row = measureRow(s, *scan, noise);
        if (!row) return row.error();
        printRow(s, scan->name, points, noise, *row);
        rows[noise].push_back(*row);
      }
    }
    for (const auto& [noise, all] : rows) printRow(s, "**mean**", points, noise, meanOf(all));
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "give fewer -points", [&] { return run(s); });
}

// SPDX-License-Identifier: BSD-3-Clause
// Which side surfaces, smoothed points, splats and meshes of scans face, beside the true side.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>

#include "common/run_program.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "pcl_slim/scan/scan.h"
#include "pcl_slim/splat/splat_sampling.h"
#include "scan/cloud_file.h"
#include "sides/facing.h"
#include "sides/side_scenes.h"
#include "support/lab/bench.h"

namespace {

using namespace pcl_slim;
using sides::SideScene;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct Settings {
  std::string scans, scenes, splats = "0";
  int threads = 1, seed = 1;

  std::vector<double> splat_counts;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("sides_bench", "1",
                      "Measures which side surfaces, smoothed points, splats and meshes face.");
  options.text("scenes", &s.scenes, "TEXT",
               "generated scenes whose names begin with it; all: every one");
  options.text("scans", &s.scans, "FOLDER", "every .pcd and .ply in a folder");
  options.text("splats", &s.splats, "N,...", "a column for each max_splats; 0: by tolerances");
  options.integer("seed", &s.seed, 0, 1000000, "seed of the scenes");
  options.integer("threads", &s.threads, 0, 4096, "threads, 0: all cores; changes no result");
  return options;
}

/** A scan as the library gets it, and the truth about its sides. */
struct Row {
  std::string name;
  CloudView view;
  ColorView colors;
  std::optional<Vector3> viewpoint;               ///< given as FitParams::viewpoint
  std::string truth = "-";                        ///< where the right sides come from
  std::vector<Vector3> points, sensors, normals;  ///< of finite points; as in sides::Truth
  std::vector<std::size_t> kept;                  ///< their indices in the view
};

std::string givenTo(const Row& row) {
  if (row.view.normal != nullptr) return "normals";
  if (row.viewpoint) return "viewpoint";
  if (row.view.sensors != nullptr) return "sensors";
  return row.view.sensor ? "sensor" : "nothing";
}

/** Prints a share in percent, or a dash where nothing was judged. */
void printShare(double percent) {
  if (std::isfinite(percent)) {
    std::printf(" %.2f |", percent);
  } else {
    std::printf(" - |");
  }
}

/** Splats of a scan as pcl_color_splat_sampling makes them. */
Error sampleRow(const Settings& s, const Row& row, double most, SplatSet& splats) {
  SplatParams params;
  params.threads = s.threads;
  params.max_splats = static_cast<std::uint64_t>(most);
  params.viewpoint = row.viewpoint;
  return sampleSplats(row.view, row.colors, params, splats);
}

Error printSplats(const Settings& s, const Row& row, const sides::Truth& truth) {
  for (const double most : s.splat_counts) {
    SplatSet splats;
    if (Error error = sampleRow(s, row, most, splats)) return error;
    printShare(sides::facingSplats(splats, truth).percent());
  }
  return {};
}

Error printRow(const Settings& s, const Row& row) {
  const double start = measure::cpuSeconds();
  FitParams params;
  params.threads = s.threads;
  params.viewpoint = row.viewpoint;
  FittedScan fitted;
  if (Error error = fitScan({row.view, row.colors}, params, fitted)) return error;
  const auto projection = projectScan(row.view, fitted.surface, SurfaceOrigin::kFitted, params, {},
                                      nullptr, &fitted.store);
  if (!projection) return projection.error();
  MeshParams mesh_params;
  mesh_params.threads = s.threads;
  TriangleMesh mesh;
  if (Error error = extractMesh(fitted.surface, mesh_params, mesh)) return error;
  const sides::Truth truth(row.points, row.normals, row.sensors);
  const SurfaceInfo& info = fitted.surface.info;
  std::printf("| %s | %zu | %s | %s | %s%s%s |", row.name.c_str(), row.kept.size(),
              givenTo(row).c_str(), row.truth.c_str(), nameOf(fitted.statistics.sides.source),
              info.oriented ? "" : ", not oriented", info.sides_in_doubt ? ", in doubt" : "");
  printShare(sides::facingLeaves(fitted.surface, truth).percent());
  printShare(sides::facingPoints(*projection, row.kept, truth).percent());
  if (Error error = printSplats(s, row, truth)) return error;
  const sides::MeshSides faces = sides::facingMesh(mesh, truth);
  printShare(faces.all.percent());
  printShare(truth.known() ? faces.wrong_components : kNone);
  std::printf(" %.1f |\n", measure::cpuSeconds() - start);
  std::fflush(stdout);
  return {};
}

Error printScene(const Settings& s, const SideScene& scene) {
  Row row;
  row.name = scene.name;
  row.view = scene.view();
  row.colors = scene.colorView();
  row.points = scene.points;
  row.sensors = scene.sensors;
  row.normals = scene.normals;
  for (std::size_t i = 0; i < row.points.size(); ++i) row.kept.push_back(i);
  if (scene.viewpoint_known) row.viewpoint = scene.sensors[0];
  if (scene.scanned_from_origin) {
    row.truth = "origin";
  } else if (!scene.sensors.empty()) {
    row.truth = scene.sensors.size() == 1 ? "sensor" : "sensors";
  } else if (!scene.normals.empty()) {
    row.truth = scene.closed ? "outward" : "up";
  }
  return printRow(s, row);
}

/** Files whose sides are known although nothing in them says so: scanned from the air. */
bool isAerial(const std::string& name) {
  return name == "autzen_stadium" || name == "terrain_isprs_csite1_utm";
}

/** A row of a file's finite points, without truth. */
Row rowOf(const std::string& name, const CloudFile& file, bool with_normals) {
  Row row;
  row.name = name;
  row.view = file.view(with_normals);
  row.colors = colorsOf(file);
  for (std::size_t i = 0; i < row.view.size; ++i) {
    const Vector3 p = row.view.position(i);
    if (!isFinite(p)) continue;
    row.kept.push_back(i);
    row.points.push_back(p);
  }
  return row;
}

/** The file's normals are the truth: those of faces, or of fields. */
void trustNormals(const CloudFile& file, Row& row) {
  const CloudView view = file.view(true);
  row.truth = file.normal_source == NormalSource::kMesh ? "mesh" : "fields";
  for (const std::size_t i : row.kept) {
    const auto n = view.givenNormal(i);
    row.normals.push_back(isFinite(n) ? normalized({n[0], n[1], n[2]}) : Vector3{});
  }
}

/** Scans of an object of which the same folder has a mesh. */
std::filesystem::path meshOf(const std::filesystem::path& path) {
  if (path.stem() != "stanford_bunny_raw_scans") return {};
  return path.parent_path() / "stanford_bunny_zipper.ply";
}

/** The truth are the normals of a mesh, at its vertex nearest to each point. */
Error trustMesh(const std::filesystem::path& path, Row& row) {
  const auto file = loadCloudFile(path.string());
  if (!file) return file.error();
  Row mesh = rowOf("", *file, true);
  trustNormals(*file, mesh);
  const rivals::PointTree tree(mesh.points);
  for (const Vector3& p : row.points) row.normals.push_back(mesh.normals[tree.nearest(p, 1)[0]]);
  row.truth = mesh.truth;
  return {};
}

Error printFile(const Settings& s, const std::filesystem::path& path) {
  const auto file = loadCloudFile(path.string());
  if (!file) return file.error();
  const std::string name = path.stem().string();
  const bool has_normals = file->normal_source != NormalSource::kNothing;
  Row row = rowOf(name, *file, false);
  if (has_normals) {
    trustNormals(*file, row);
  } else if (const auto mesh = meshOf(path); std::filesystem::exists(mesh)) {
    if (Error error = trustMesh(mesh, row)) return error;
  } else if (row.view.sensor) {
    row.truth = "sensor";
    row.sensors = {*row.view.sensor};
  } else if (isAerial(name)) {
    row.truth = "up";
    row.normals.assign(row.points.size(), {0, 0, 1});
  }
  if (Error error = printRow(s, row)) return error;
  if (!has_normals) return {};
  row.view = file->view(true);
  return printRow(s, row);
}

Error printFolder(const Settings& s) {
  const auto files = measure::scansIn(s.scans);
  if (!files) return files.error();
  for (const std::string& file : *files) {
    if (Error error = printFile(s, file)) return error;
  }
  return {};
}

void printHead(const Settings& s) {
  std::printf(
      "%% on the right side: leaves by area, points, splats by points, mesh by area; area in mesh "
      "components most of which face wrongly; CPU s\n\n| scan | points | given | truth | sides by "
      "| leaves | points |");
  for (const double most : s.splat_counts) {
    if (most > 0) std::printf(" %.0f splats |", most);
    if (most == 0) std::printf(" splats |");
  }
  std::printf(" mesh | wrong components | s |\n|");
  for (std::size_t i = 0; i < 10 + s.splat_counts.size(); ++i) std::printf("---|");
  std::printf("\n");
}

Exit run(Settings& s) {
  if (s.scans.empty() && s.scenes.empty())
    return {kExitUsage, "nothing to measure; give -scenes all or -scans FOLDER"};
  if (Error error = measure::parseLists({{"splats", &s.splats, 0, 1e9, true, &s.splat_counts}}))
    return Exit::usage(error);
  printHead(s);
  const std::string wanted = s.scenes == "all" ? "" : s.scenes;
  for (const auto& maker : sides::sceneMakers(static_cast<std::uint64_t>(s.seed))) {
    if (s.scenes.empty() || maker.name.rfind(wanted, 0) != 0) continue;
    if (Error error = printScene(s, maker.make())) return error;
  }
  if (s.scans.empty()) return {};
  return printFolder(s);
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "give fewer scenes", [&] { return run(s); });
}

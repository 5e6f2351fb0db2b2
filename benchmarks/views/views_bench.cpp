// SPDX-License-Identifier: BSD-3-Clause
// Which view of generated scans the library chooses for surfaces, splats and meshes, beside what is
// up and what was scanned.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <random>

#include "common/run_program.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/shading.h"
#include "pcl_slim/scan/scan.h"
#include "pcl_slim/splat/splat_sampling.h"
#include "scan/cloud_file.h"
#include "support/lab/bench.h"
#include "views/view_scenes.h"

namespace {

using namespace pcl_slim;
using views::Kind;
using views::ViewScene;

struct Settings {
  std::string scenes, scans, out;
  int threads = 1, seed = 1;
  bool variants = false;
};

OptionTable declareOptions(Settings& s) {
  OptionTable options("views_bench", "1", "Measures which views of scans are chosen.");
  options.text("scenes", &s.scenes, "TEXT", "scenes whose names begin with it; all: every one");
  options.text("scans", &s.scans, "FOLDER", "every .pcd and .ply in a folder");
  options.text("out", &s.out, "FOLDER", "save the pictures of surfaces there");
  options.toggle("variants", &s.variants,
                 "also surfaces of half of the points, of rounded ones, and of turned ones");
  options.integer("seed", &s.seed, 0, 1000000, "seed of the scenes");
  options.integer("threads", &s.threads, 0, 4096, "threads, 0: all cores; changes no result");
  return options;
}

double degreesBetween(const Vector3& a, const Vector3& b) {
  return std::acos(std::clamp(dot(normalized(a), normalized(b)), -1.0, 1.0)) * 180 / M_PI;
}

/** \brief What a chosen view is like. */
struct Outcome {
  double off_up = 0;  ///< angle between the chosen upward direction and the true one [degrees]
  double facing = 0;  ///< share of the points that face the viewer
  double above = 0;   ///< elevation of the viewer [degrees]
  bool opens = false, inside = false;
  Vector3 forward{}, picture_up{};

  /** \param[in] up the true one, or null */
  Outcome(const Vector3* up, const BoundingSpheres& object);

  /** \brief Greatest angle between two views' directions [degrees]. */
  double apart(const Outcome& other) const {
    return std::max(degreesBetween(forward, other.forward),
                    degreesBetween(picture_up, other.picture_up));
  }

  bool isRight(Kind kind) const {
    if (off_up > 10) return false;
    switch (kind) {
      // Which side is out is measured by sides_bench.
      case Kind::kOneSide: return std::max(facing, 1 - facing) > 0.8;
      case Kind::kGround: return above > 25;
      case Kind::kInside: return opens && above > 20;
      case Kind::kStation: return inside && facing > 0.8;
      default: return above > 5 && above < 60;
    }
  }
};

Outcome::Outcome(const Vector3* up, const BoundingSpheres& object) {
  const SceneView view = chooseView(object);
  const Camera camera = cameraFor(view, object, {320, 240});
  opens = view.opens;
  inside = view.amid.has_value();
  forward = subtract(camera.look_at, camera.position);
  picture_up = camera.up;
  if (up != nullptr) {
    off_up = degreesBetween(view.up, *up);
    above = 90 - degreesBetween(view.direction.towards_viewer, *up);
  }
  double seen = 0, all = 0;
  for (const BoundingSphere& sphere : object.spheres) {
    const auto& c = sphere.center;
    const Vector3 at = along(object.origin, object.scale, {c[0], c[1], c[2]});
    const Vector3 normal = {sphere.normal[0], sphere.normal[1], sphere.normal[2]};
    all += sphere.points;
    if (dot(subtract(camera.position, at), normal) > 0) seen += sphere.points;
  }
  facing = seen / all;
}

/** \brief How many views are right, and how many are alike, of how many. */
struct Count {
  int surfaces = 0, splats = 0, meshes = 0, all = 0;
  int like_splats = 0, like_meshes = 0, like_variants = 0, variants = 0;
};

/** \brief A row of one object. \param[in] surface the view of the surface of the same scan */
int printRow(const std::string& name, const char* what, const Outcome& outcome,
             const Outcome& surface, const Kind* kind) {
  const bool is_right = kind != nullptr && outcome.isRight(*kind);
  std::printf("| %s | %s |", name.c_str(), what);
  if (kind != nullptr) std::printf(" %.0f | %.0f |", outcome.off_up, outcome.above);
  if (kind == nullptr) std::printf(" - | - |");
  std::printf(" %.0f | %s | %.0f | %s |\n", 100 * outcome.facing,
              outcome.inside  ? "amid the scene"
              : outcome.opens ? "cut away"
                              : "whole",
              outcome.apart(surface),
              kind == nullptr ? ""
              : is_right      ? "right"
                              : "WRONG");
  std::fflush(stdout);
  return is_right ? 1 : 0;
}

Error save(const Settings& s, const std::string& scan, const SLIMSurface& surface) {
  const BoundingSpheres object = spheresOf(surface);
  const SceneView view = chooseView(object);
  const Camera camera = cameraFor(view, object, {320, 240});
  RenderParams rendering;
  rendering.threads = s.threads;
  if (view.opens) rendering.sides = VisibleSides::kFront;
  ShadingParams shading;
  shading.threads = s.threads;
  if (surface.hasColors()) shading.mode = ShadingMode::kColor;
  const auto image = renderPicture(surface, camera, rendering, shading);
  if (!image) return image.error();
  std::string name = scan + ".png";
  std::replace(name.begin(), name.end(), ' ', '_');
  return saveImage((std::filesystem::path(s.out) / name).string(), *image);
}

/** \brief What is known of a scan. */
struct Row {
  std::string name;
  ScanView scan;
  std::optional<std::array<double, 3>> viewpoint;
  const ViewScene* truth = nullptr;
};

/** \brief What may be done to a scan without another view. */
struct Variant {
  const char* name;
  double turn = 0;      ///< about z [degrees]
  double rounding = 0;  ///< [diagonal]
  bool half = false;    ///< of the points
};

constexpr Variant kVariants[] = {{"half of its points", 0, 0, true},
                                 {"rounded to .0002 of its diagonal", 0, 0.0002, false},
                                 {"turned by 2 degrees", 2, 0, false}};

std::vector<Vector3> pointsOf(const Variant& variant, const CloudView& scan) {
  std::mt19937 random(3);
  std::vector<Vector3> points;
  Bounds box;
  for (std::size_t i = 0; i < scan.size; ++i) {
    const Vector3 p = scan.position(i);
    if (!isFinite(p) || (variant.half && random() % 2 == 0)) continue;
    points.push_back(p);
    box.add(p);
  }
  const double step = variant.rounding * box.diagonal();
  const double c = std::cos(variant.turn * M_PI / 180), t = std::sin(variant.turn * M_PI / 180);
  const Vector3 middle = scaled(along(box.low, 1, box.high), 0.5);
  for (Vector3& p : points) {
    for (std::size_t a = 0; a < 3 && step > 0; ++a) p[a] = std::round(p[a] / step) * step;
    if (variant.turn == 0) continue;
    const Vector3 off = subtract(p, middle);
    p = along(middle, 1, {c * off[0] - t * off[1], t * off[0] + c * off[1], off[2]});
  }
  return points;
}

Error printVariants(const Settings& s, const Row& row, const Outcome& original, Count& count) {
  for (const Variant& variant : kVariants) {
    const std::vector<Vector3> points = pointsOf(variant, row.scan.points);
    CloudView view;
    view.xyz = points.data();
    view.scalar = CloudView::Scalar::kDouble;
    view.xyz_stride = sizeof(Vector3);
    view.size = points.size();
    FitParams params;
    params.threads = s.threads;
    params.viewpoint = row.viewpoint;
    FittedScan fitted;
    if (Error error = fitScan({view, {}}, params, fitted)) return error;
    const Outcome outcome(nullptr, spheresOf(fitted.surface));
    printRow(row.name, variant.name, outcome, original, nullptr);
    count.like_variants += outcome.apart(original) < 10;
    ++count.variants;
  }
  return {};
}

Error printScan(const Settings& s, const Row& row, Count& count) {
  const Vector3* const up = row.truth ? &row.truth->up : nullptr;
  const Kind* const kind = row.truth ? &row.truth->kind : nullptr;
  FitParams params;
  params.threads = s.threads;
  params.viewpoint = row.viewpoint;
  FittedScan fitted;
  if (Error error = fitScan(row.scan, params, fitted)) return error;
  const Outcome of_surface(up, spheresOf(fitted.surface));
  count.surfaces += printRow(row.name, "surface", of_surface, of_surface, kind);
  if (!s.out.empty()) {
    if (Error error = save(s, row.name, fitted.surface)) return error;
  }
  SplatParams sampling;
  sampling.threads = s.threads;
  sampling.max_splats = 5000;
  sampling.viewpoint = row.viewpoint;
  SplatSet splats;
  if (Error error = sampleSplats(row.scan.points, row.scan.colors, sampling, splats)) return error;
  const Outcome of_splats(up, spheresOf(splats));
  count.splats += printRow(row.name, "splats", of_splats, of_surface, kind);
  MeshParams meshing;
  meshing.threads = s.threads;
  TriangleMesh mesh;
  if (Error error = extractMesh(fitted.surface, meshing, mesh)) return error;
  const Outcome of_mesh(up, spheresOf(mesh.vertices, mesh.triangles));
  count.meshes += printRow(row.name, "mesh", of_mesh, of_surface, kind);
  count.like_splats += of_splats.apart(of_surface) < 10;
  count.like_meshes += of_mesh.apart(of_surface) < 10;
  ++count.all;
  return s.variants ? printVariants(s, row, of_surface, count) : Error();
}

Error printScene(const Settings& s, const ViewScene& scene, Count& count) {
  Row row{scene.scan.name, {scene.scan.view(), scene.scan.colorView()}, {}, &scene};
  if (scene.scan.viewpoint_known) row.viewpoint = scene.scan.sensors[0];
  return printScan(s, row, count);
}

Error printFolder(const Settings& s, Count& count) {
  const auto files = measure::scansIn(s.scans);
  if (!files) return files.error();
  for (const std::string& path : *files) {
    const auto file = loadCloudFile(path);
    if (!file) return file.error();
    const Row row{
        std::filesystem::path(path).stem().string(), {file->view(), colorsOf(*file)}, {}, nullptr};
    if (Error error = printScan(s, row, count)) return error;
  }
  return {};
}

Exit run(const Settings& s) {
  std::printf(
      "| scan | picture of | up is off by | viewer above | %% facing it | drawn | off the "
      "surface's "
      "by | |\n|---|---|---|---|---|---|---|---|\n");
  Count scenes, scans;
  for (const auto& maker : views::sceneMakers(static_cast<std::uint64_t>(s.seed))) {
    if (s.scenes != "all" && (s.scenes.empty() || maker.name.rfind(s.scenes, 0) != 0)) continue;
    if (Error error = printScene(s, maker.make(), scenes)) return error;
  }
  if (!s.scans.empty()) {
    if (Error error = printFolder(s, scans)) return error;
  }
  std::printf("\nright: %d surfaces, %d splats, %d meshes of %d scenes\n", scenes.surfaces,
              scenes.splats, scenes.meshes, scenes.all);
  std::printf("within 10 degrees of the surface's view: %d splats, %d meshes of %d\n",
              scenes.like_splats + scans.like_splats, scenes.like_meshes + scans.like_meshes,
              scenes.all + scans.all);
  if (s.variants)
    std::printf("within 10 degrees of the original's view: %d of %d variants\n",
                scenes.like_variants + scans.like_variants, scenes.variants + scans.variants);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable options = declareOptions(s);
  return runProgram(options, argc, argv, "give fewer scenes", [&] { return run(s); });
}

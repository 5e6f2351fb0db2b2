// SPDX-License-Identifier: BSD-3-Clause
// Where drawn surfaces and meshes end beside where their data do: on scans the area far from data
// and the points without anything drawn, on scenes of known outline the rim itself; and lists of
// rows: open scenes, closed bodies, what trim maps cost.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "borders/closed_rows.h"
#include "borders/cost_rows.h"
#include "borders/drawn_area.h"
#include "borders/mesh_parts.h"
#include "borders/mesh_shape.h"
#include "borders/open_rows.h"
#include "borders/rims.h"
#include "common/options.h"
#include "common/program.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "pcl_slim/surface/surface_components.h"
#include "scan/cloud_file.h"
#include "support/lab/bench.h"

using namespace pcl_slim;

namespace {

constexpr double kFloating = 3.0;  ///< spacings, and deviations of the noise

struct Settings {
  std::string input, vectors = "best";
  FitParams fit;
  bool reference = false, draw = true, mesh = true, use_normals = true;
  int size = 1000, repeat = 3;
  double noise = 0.02;
  double hole = 0;  ///< of fits and meshes; 0: their own defaults
  std::string noises, files;
  borders::OpenSettings open;
  borders::ClosedSettings closed;
};

MeshParams meshParams(const Settings& s) {
  MeshParams params;
  params.threads = s.fit.threads;
  if (s.hole > 0) params.hole_size = s.hole;
  return params;
}

/** \brief CPU seconds of a fit without trim maps and with them, the least of several. */
struct Cost {
  double plain = 1e9, trimmed = 1e9;
};

Error fitBoth(const Settings& s, const PointStore& store, SLIMSurface& surface,
              FitStatistics& stats, Cost& cost) {
  for (int i = 0; i < s.repeat; ++i) {
    for (const bool trim : {false, true}) {
      FitParams params = s.fit;
      params.trim = trim;
      const double start = measure::cpuSeconds();
      if (Error error = fitSurface(store, params, surface, &stats)) return error;
      double& least = trim ? cost.trimmed : cost.plain;
      least = std::min(least, measure::cpuSeconds() - start);
    }
  }
  return {};
}

void printCost(const Settings& s, const SLIMSurface& surface, const FitStatistics& stats,
               const Cost& cost) {
  const double n = static_cast<double>(stats.points);
  const double leaves = static_cast<double>(stats.leaves);
  std::printf(
      "%s: %llu points, %llu leaves, %.3f open, %llu candidates of %zu surfels\n"
      "  maps %.3f us/pt CPU (fit %.2f), %.1f bytes a leaf, %.2f a point\n",
      s.input.c_str(), static_cast<unsigned long long>(stats.points),
      static_cast<unsigned long long>(stats.leaves),
      static_cast<double>(stats.open_leaves) / leaves,
      static_cast<unsigned long long>(stats.trim_candidates), surface.size(),
      1e6 * (cost.trimmed - cost.plain) / n, 1e6 * cost.plain / n,
      static_cast<double>(surface.trim_maps.size()) / leaves,
      static_cast<double>(surface.trim_maps.size()) / n);
}

/** \brief What is near a scan. */
class Near {
 public:
  Near(const SLIMSurface& surface, const PointStore& store, int threads)
      : feet(borders::feetOf(store, surface, threads)),
        points(borders::pointsOf(store, threads)),
        near(feet),
        floats(points, kFloating, kFloating * noiseOf(surface)) {}

  borders::Feet feet, points;
  borders::FootSearch near;    ///< 1.5 spacings of a foot
  borders::FootSearch floats;  ///< three spacings of a point and three deviations of the noise

 private:
  static double noiseOf(const SLIMSurface& surface) {
    return std::sqrt(std::max(0.0, surface.info.lambda)) * surface.info.diagonal *
           surface.info.scale;
  }
};

/** \brief Overshoot and loss, drawn without trim maps and with them, and what floats. */
void printBorders(const Settings& s, const SLIMSurface& surface, const Near& near) {
  borders::DrawnArea areas[2];
  double lost[2];
  for (int trim = 0; trim < 2; ++trim) {
    RenderParams params;
    params.threads = s.fit.threads;
    params.trim = trim == 1;
    areas[trim] =
        borders::drawnArea(surface, near.near, near.floats, params, {s.size, s.reference});
    lost[trim] = borders::lostShare(surface, near.feet, params);
  }
  std::printf(
      "  overshoot %.3f -> %.3f %%, loss %.3f -> %.3f %%, area kept %.3f, six frames %.2f -> %.2f "
      "s\n",
      100.0 * areas[0].far / areas[0].total, 100.0 * areas[1].far / areas[1].total, 100.0 * lost[0],
      100.0 * lost[1], areas[1].total / areas[0].total, areas[0].seconds, areas[1].seconds);
  const borders::Floating &before = areas[0].floating, &after = areas[1].floating;
  const double spacing = near.floats.usualSpacing();
  std::printf(
      "  floating: %zu -> %zu pieces, %zu -> %zu pixels, widest %.1f -> %.1f spacings (%.3g)\n",
      before.pieces, after.pieces, before.pixels, after.pixels, before.widest / spacing,
      after.widest / spacing, after.widest);
}

/** \brief The mesh of a scan: what kind of surface, and how much of it is far from points. */
Error printMesh(const Settings& s, const SLIMSurface& surface, const Near& near) {
  const MeshParams params = meshParams(s);
  TriangleMesh mesh;
  MeshStatistics statistics;
  const double start = measure::cpuSeconds();
  if (Error error = extractMesh(surface, params, mesh, &statistics)) return error;
  const double seconds = measure::cpuSeconds() - start;
  double total = 0.0, far = 0.0, floats = 0.0;
  std::vector<std::uint32_t> blocks;
  borders::forParts(mesh, near.near.usualSpacing(), [&](const std::array<Vector3, 3>& part) {
    const double area = borders::areaOf(part);
    const Vector3 middle = borders::middleOf(part);
    total += area;
    if (near.near.isNear(middle, blocks)) return;
    far += area;
    floats += near.floats.isNear(middle, blocks) ? 0.0 : area;
  });
  const MeshCensus& c = statistics.census;
  std::printf(
      "  mesh: %llu triangles, %.2f s CPU, %llu components, %llu border edges, %zu loops, %llu "
      "holes closed, %zu of zero area, overshoot %.3f %%, floating %.4f %%\n",
      static_cast<unsigned long long>(c.triangles), seconds,
      static_cast<unsigned long long>(c.components),
      static_cast<unsigned long long>(c.border_edges), borders::countLoops(mesh),
      static_cast<unsigned long long>(statistics.closed_holes), borders::countFlatTriangles(mesh),
      100.0 * far / total, 100.0 * floats / total);
  return {};
}

void printRims(const Settings& s, const SLIMSurface& surface, const borders::RimScene& scene) {
  for (int trim = 0; trim < 2; ++trim) {
    RenderParams params;
    params.threads = s.fit.threads;
    params.trim = trim == 1;
    const borders::RimFigures f = borders::measureRims(scene, surface, params, s.reference);
    std::printf("  rim %s: mean %+.2f, sd %.2f, max %.2f, jag %.2f spacings\n",
                trim == 1 ? "trimmed" : "as balls end", f.mean, f.deviation, f.farthest, f.jag);
  }
}

int run(const Settings& s, const CloudView& view, const borders::RimScene* scene) {
  const Result<PointStore> store = PointStore::build(view, s.fit.threads);
  SLIMSurface surface;
  FitStatistics stats;
  Cost cost;
  Error error = store ? fitBoth(s, *store, surface, stats, cost) : store.error();
  if (!error) {
    printCost(s, surface, stats, cost);
    const bool looks = s.draw || s.mesh;
    const auto near = looks ? std::make_unique<Near>(surface, *store, stats.threads) : nullptr;
    dropComponents(meshParams(s).min_component_points, surface, stats.threads);  // as programs do
    if (s.draw) printBorders(s, surface, *near);
    if (s.draw && scene != nullptr) printRims(s, surface, *scene);
    if (s.mesh) error = printMesh(s, surface, *near);
    std::fflush(stdout);
  }
  if (!error) return kExitDone;
  std::fprintf(stderr, "borders_bench: %s\n", error.message.c_str());
  return kExitFailed;
}

int runScene(const Settings& s) {
  const borders::RimScene scene = borders::makeRimScene(s.input, s.noise, s.fit.seed);
  CloudView view;
  view.xyz = scene.points.data();
  view.xyz_stride = 3 * sizeof(double);
  view.scalar = CloudView::Scalar::kDouble;
  view.size = scene.points.size() / 3;
  return run(s, view, &scene);
}

/** \brief The lists of rows. */
Error printRows(Settings& s) {
  const MeshParams mesh = meshParams(s);
  if (s.input == "cost") {
    borders::CostSettings cost;
    cost.fit = s.fit;
    cost.repeat = s.repeat;
    cost.files = s.files;
    cost.use_normals = s.use_normals;
    return borders::printCostRows(cost);
  }
  if (s.noises.empty()) s.noises = s.input == "open" ? "0,0.1,0.3,1" : "0.03,0.1,0.3,1";
  std::vector<double> noise;
  if (Error error = measure::parseLists({{"noises", &s.noises, 0, 10, false, &noise}}))
    return error;
  if (s.input == "open") {
    s.open.fit = s.fit;
    s.open.mesh = mesh;
    s.open.noise = noise;
    return borders::printOpenRows(s.open);
  }
  s.closed.fit = s.fit;
  s.closed.mesh = mesh;
  s.closed.noise = noise;
  s.closed.files = s.files;
  s.closed.use_normals = s.use_normals;
  return borders::printClosedRows(s.closed);
}

int runRows(Settings& s) {
  measure::keepFreedMemory();
  const Error error = printRows(s);
  if (!error) return kExitDone;
  std::fprintf(stderr, "borders_bench: %s\n", error.message.c_str());
  return error.code == ErrorCode::kBadArgument ? kExitUsage : kExitFailed;
}

void declareRows(OptionTable& table, Settings& s) {
  table.text(
      "noises", &s.noises, "LIST",
      "with open and closed: of the points, in spacings; 0 or .03, .1, .3 and 1 if not given");
  table.text("scenes", &s.open.scenes, "LIST", "with open: names of scenes or their beginnings");
  table.choice("normals", &s.open.normals, {"0", "1", "01"},
               "with open: without normals, with, or both");
  table.text("methods", &s.open.methods, "LIST",
             "with open: slim, truth (the instrument's error), poisson (trimmed), front (CGAL's)");
  table.number("poisson_trim", &s.open.poisson_trim, 0.5, 100,
               "with open: spacings from the points beyond which Poisson's mesh is cut");
  table.text("write", &s.open.folder, "FOLDER",
             "with open: write points with true normals, surfaces and meshes to it");
  table.toggle("picture", &s.open.picture, "with open: measure pictures, too");
  table.text("bodies", &s.closed.bodies, "LIST", "with closed");
  table.text("spreads", &s.closed.spreads, "LIST", "with closed: random, blue, uneven, step");
  table.text("files", &s.files, "LIST",
             "with closed: scans in place of bodies; with cost: in addition");
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  s.fit.threads = 1;
  OptionTable table("borders_bench", "", "Borders as drawn beside borders of the data.");
  table.positional(
      "SCAN|half|hole|strip|grid|open|closed|cost", &s.input,
      "a .pcd or .ply; a scene by name; or a list of rows: open scenes, closed bodies, "
      "cost of trim maps");
  table.number("hole", &s.hole, 2, 50, "diameter of the smallest hole kept, in spacings",
               "the defaults of fit and mesh");
  table.number("noise", &s.noise, 0, 10, "of a scene's points, in spacings");
  table.integer("seed", &s.fit.seed, 0, 1000000, "of a scene, and of the fit");
  table.integer("threads", &s.fit.threads, 1, 256, "threads");
  table.integer("size", &s.size, 16, 8192, "pixels a side of the views");
  table.integer("repeat", &s.repeat, 1, 100,
                "fits with maps and without, of which the fastest count");
  table.toggle("draw", &s.draw, "measure what is drawn, not only the maps' cost");
  table.toggle("mesh", &s.mesh, "measure the mesh of a scan");
  table.toggle("reference", &s.reference, "draw with the reference rasteriser");
  table.toggle("use_normals", &s.use_normals, "use the scan's own normals or faces");
  declareRows(table, s);
  table.text("vectors", &s.vectors, "NAME", "instruction set of the kernels, such as AVX2");
  if (const auto status = table.parse(argc, argv)) return *status;
  if (const Error error = measure::chooseVectors(s.vectors)) {
    std::fprintf(stderr, "borders_bench: %s\n", error.message.c_str());
    return kExitUsage;
  }
  if (s.hole > 0) s.fit.hole_size = s.hole;
  if (s.input == "open" || s.input == "closed" || s.input == "cost") return runRows(s);
  if (s.input.find('.') == std::string::npos) return runScene(s);
  const Result<CloudFile> cloud = loadCloudFile(s.input);
  if (!cloud) {
    std::fprintf(stderr, "borders_bench: %s\n", cloud.error().message.c_str());
    return kExitUsage;
  }
  return run(s, cloud->view(s.use_normals), nullptr);
}

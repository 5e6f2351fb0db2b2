// SPDX-License-Identifier: BSD-3-Clause
// Scenes of known borders: what meshes and pictures cover beside what they should.
#include "borders/open_rows.h"

#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include "borders/coverage.h"
#include "borders/lists.h"
#include "borders/mesh_shape.h"
#include "borders/open_scenes.h"
#include "borders/open_summary.h"
#include "borders/reconstructions.h"
#include "pcl_slim/filters/io/mesh_files.h"
#include "pcl_slim/filters/io/surface_files.h"
#include "pcl_slim/render/ray_tracer.h"
#include "pcl_slim/surface/surface_components.h"
#include "support/lab/bench.h"

namespace pcl_slim::borders {
namespace {

constexpr double kMostAside = 1.5;  ///< area beyond and missing over the border's length, spacings
constexpr double kFar = 3.0;        ///< spacings, and deviations of the noise

/** \brief Rays from all around through a surface's box: the share of hits far from every point. */
double strayShare(const RayTracer& tracer, const SLIMSurface& surface,
                  const rivals::PointTree& tree, const std::vector<Vector3>& points, double limit) {
  constexpr std::size_t kRays = 10000;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Bounds box;
  for (const Vector3& p : points) box.add(p);
  std::vector<WorldRay> rays(kRays);
  for (WorldRay& ray : rays) {
    for (std::size_t a = 0; a < 3; ++a) {
      ray.direction[a] = normal(random);
      ray.origin[a] =
          std::uniform_real_distribution<double>(box.low[a] - 9.0, box.high[a] + 9.0)(random);
    }
    ray.origin = along(ray.origin, -4.0 * surface.info.scale, normalized(ray.direction));
  }
  std::vector<WorldHit> hits;
  if (tracer.cast(rays, VisibleSides::kAuto, hits, 1)) return 1.0;
  double met = 0.0, stray = 0.0;
  for (const WorldHit& hit : hits) {
    if (!hit.met()) continue;
    const Vector3& next = points[tree.nearest(hit.position, 1).front()];
    ++met;
    stray += length(subtract(next, hit.position)) > limit ? 1.0 : 0.0;
  }
  return met > 0.0 ? stray / met : 0.0;
}

/** \brief What missed its target, for the end of a row. */
class Misses {
 public:
  void check(bool good, const char* name) {
    if (!good) text_ += text_.empty() ? name : std::string(",") + name;
  }
  void add(const Misses& more) {
    if (!more.none()) check(false, more.text());
  }
  bool none() const { return text_.empty(); }
  const char* text() const { return none() ? "ok" : text_.c_str(); }

 private:
  std::string text_;
};

void printHead() {
  std::printf(
      "%-18s %-7s %5s n %6s %6s %5s | %6s %6s %6s %5s %9s %9s %6s %6s %5s %5s %6s %6s | %6s %6s "
      "%5s %6s "
      "%7s | misses\n",
      "scene", "method", "noise", "points", "CPU s", "open", "tri.", "beyond", "miss", "deep",
      "kept", "loops", "closed", "border", "comp.", "zero", "far", "far s2", "beyond", "miss",
      "deep", "kept", "stray %");
}

class OpenRows {
 public:
  explicit OpenRows(const OpenSettings& settings) : s_(settings) {}

  Error add(OpenScene scene, double noise) {
    scene.sample(noise, s_.fit.seed);
    SceneCoverage coverage(scene);
    const rivals::PointTree tree(scene.points);
    for (const std::string& method : wordsOf(s_.methods)) {
      // Poisson needs normals, the advancing front has no use for them.
      const std::string normals = method == "slim" ? s_.normals : method == "poisson" ? "1" : "0";
      for (const char n : normals) {
        const Row row{scene, tree, method, n == '1'};
        if (Error error = addRow(row, coverage)) return error;
      }
    }
    return {};
  }

  void printSummary() const { summary_.print(); }

 private:
  static double limit(const OpenScene& scene) {
    return kFar * scene.widestSpacing() + kFar * scene.sigma;
  }

  /** \brief What is measured. */
  struct Row {
    const OpenScene& scene;
    const rivals::PointTree& tree;
    std::string method;
    bool normals;
  };

  /** \brief Makes a row's mesh, and the surface where there is one. */
  Error make(const Row& row, SLIMSurface& surface, FitStatistics& fit, TriangleMesh& mesh,
             MeshStatistics& statistics) const {
    if (row.method == "poisson") return trimmedPoisson(row.scene, s_.poisson_trim, mesh);
    if (row.method == "front") return advancingFront(row.scene, mesh);
    if (row.method == "truth") {
      trueMesh(row.scene, mesh);
      return {};
    }
    if (row.method != "slim") {
      return {ErrorCode::kBadArgument,
              "no method is called '" + row.method + "'; take slim, truth, poisson or front"};
    }
    const Result<PointStore> store = PointStore::build(row.scene.view(row.normals), s_.fit.threads);
    if (!store) return store.error();
    if (Error error = fitSurface(*store, s_.fit, surface, &fit)) return error;
    dropComponents(s_.mesh.min_component_points, surface, s_.fit.threads);  // as programs do
    return extractMesh(surface, s_.mesh, mesh, &statistics);
  }

  Error addRow(const Row& row, SceneCoverage& coverage) {
    SLIMSurface surface;
    FitStatistics fit;
    TriangleMesh mesh;
    MeshStatistics statistics;
    const double start = measure::cpuSeconds();
    if (Error error = make(row, surface, fit, mesh, statistics)) return error;
    const double seconds = measure::cpuSeconds() - start;
    if (Error error = write(row, surface, mesh)) return error;
    std::printf("%-18s %-7s %5.2f %d %6zu %6.2f %5llu | ", row.scene.name.c_str(),
                row.method.c_str(), row.scene.sigma, row.normals ? 1 : 0, row.scene.points.size(),
                seconds, static_cast<unsigned long long>(fit.open_leaves));
    Misses misses, of_picture;
    RowOutcome outcome;
    printMesh(row, mesh, statistics, coverage, misses, outcome);
    outcome.has_picture = s_.picture && surface.size() > 0;
    if (outcome.has_picture) printPicture(row, surface, coverage, of_picture, outcome);
    outcome.mesh = misses.none();
    outcome.picture = of_picture.none();
    summary_.add(row.method, row.scene.name, row.scene.sigma, outcome);
    misses.add(of_picture);
    std::printf("%s\n", misses.text());
    std::fflush(stdout);
    return {};
  }

  /** \brief The row's points, mesh and surface as files. */
  Error write(const Row& row, const SLIMSurface& surface, const TriangleMesh& mesh) const {
    if (s_.folder.empty()) return {};
    char level[32];
    std::snprintf(level, sizeof level, "-%g-%d", row.scene.sigma, row.normals ? 1 : 0);
    const std::string name = s_.folder + "/" + row.scene.name + level;
    TriangleMesh points;
    points.vertices = row.scene.points;
    for (std::size_t i = 0; i < 3 * points.vertices.size(); i += 3) {
      const float* n = row.scene.normals.data() + i;
      points.normals.push_back({n[0], n[1], n[2]});
    }
    if (Error error = savePointFile(name + "-points.ply", toPointFile(points, {true, false})))
      return error;
    if (Error error =
            savePointFile(name + "-" + row.method + ".ply", toPointFile(mesh, {true, false})))
      return error;
    return surface.size() == 0 ? Error() : saveSurface(name + ".slim", surface);
  }

  void printMesh(const Row& row, const TriangleMesh& mesh, const MeshStatistics& statistics,
                 SceneCoverage& coverage, Misses& misses, RowOutcome& outcome) const {
    const OpenScene& scene = row.scene;
    const MeshCensus census = censusOf(mesh);
    const double border = scene.borderLength();
    const Coverage c = coverage.ofMesh(mesh);
    const std::size_t loops = countLoops(mesh), flat = countFlatTriangles(mesh);
    const auto wanted = scene.loops();
    const FarPlaces far = farPlaces(mesh, row.tree, scene.points, limit(scene));
    outcome.beyond = c.beyond / border;
    outcome.missing = c.missing / border;
    outcome.to_keep = c.to_keep;
    outcome.kept = c.kept;
    outcome.loops = loops >= wanted[0] && loops <= wanted[1];
    misses.check(outcome.beyond <= kMostAside, "beyond");
    misses.check(outcome.missing <= kMostAside, "missing");
    misses.check(c.deepest <= limit(scene), "deep");
    misses.check(c.kept == c.to_keep, "holes");
    misses.check(outcome.loops, "loops");
    misses.check(census.components == scene.sheets.size(), "components");
    misses.check(far.area == 0.0, "far");
    misses.check(flat == 0, "zero");
    const std::string kept = std::to_string(c.kept) + "/" + std::to_string(c.to_keep);
    std::string found = std::to_string(loops) + "/" + std::to_string(wanted[0]);
    if (wanted[1] > wanted[0]) found += "-" + std::to_string(wanted[1]);
    std::printf("%6zu %6.2f %6.2f %5.1f %9s %9s %6llu %6llu %5llu %5zu %6.2f %6.1f | ",
                mesh.triangles.size(), outcome.beyond, outcome.missing, c.deepest, kept.c_str(),
                found.c_str(), static_cast<unsigned long long>(statistics.closed_holes),
                static_cast<unsigned long long>(census.border_edges),
                static_cast<unsigned long long>(census.components), flat, far.farthest, far.area);
  }

  void printPicture(const Row& row, const SLIMSurface& surface, SceneCoverage& coverage,
                    Misses& misses, RowOutcome& outcome) const {
    const OpenScene& scene = row.scene;
    const double border = scene.borderLength();
    const RayTracer tracer(surface, 1);
    const Coverage c = coverage.ofPicture(tracer);
    const double stray = strayShare(tracer, surface, row.tree, scene.points, limit(scene));
    outcome.seen_beyond = c.beyond / border;
    outcome.unseen = c.missing / border;
    outcome.open = c.kept;
    misses.check(outcome.seen_beyond <= kMostAside, "p.beyond");
    misses.check(outcome.unseen <= kMostAside, "p.missing");
    misses.check(c.deepest <= limit(scene), "p.deep");
    misses.check(c.kept == c.to_keep, "p.holes");
    misses.check(stray == 0.0, "p.stray");
    std::printf("%6.2f %6.2f %5.1f %6zu %7.3f | ", outcome.seen_beyond, outcome.unseen, c.deepest,
                c.kept, 100.0 * stray);
  }

  const OpenSettings& s_;
  OpenSummary summary_;
};

}  // namespace

Error printOpenRows(const OpenSettings& settings) {
  const std::vector<OpenScene> scenes = openScenes(settings.scenes);
  if (scenes.empty()) {
    return {ErrorCode::kBadArgument,
            "-scenes " + settings.scenes +
                " contains a name of no scene; "
                "take all, flat, wavy, bent, slab, wall, pipe or another one"};
  }
  printHead();
  OpenRows rows(settings);
  for (const OpenScene& scene : scenes) {
    for (const double noise : settings.noise) {
      if (Error error = rows.add(scene, noise)) return error;
    }
  }
  rows.printSummary();
  return {};
}

}  // namespace pcl_slim::borders

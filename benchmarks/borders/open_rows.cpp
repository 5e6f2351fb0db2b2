// SPDX-License-Identifier: BSD-3-Clause
// Scenes of known borders: what meshes and pictures cover beside what they should.
#include "borders/open_rows.h"

#include <cmath>
#include <cstdio>
#include <random>

#include "borders/coverage.h"
#include "borders/mesh_shape.h"
#include "borders/open_scenes.h"
#include "pcl_slim/render/ray_tracer.h"
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
  if (tracer.cast(rays, VisibleSides::kBoth, hits, 1)) return 1.0;
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
      "%-18s %5s n %6s %5s | %6s %6s %6s %9s %9s %6s %5s %5s %6s %6s %6s | %6s %6s %6s %7s | "
      "misses\n",
      "scene", "noise", "points", "open", "tri.", "beyond", "miss", "kept", "loops", "border",
      "comp.", "zero", "far", "far s2", "CPU s", "beyond", "miss", "kept", "stray %");
}

class OpenRows {
 public:
  explicit OpenRows(const OpenSettings& settings) : s_(settings) {}

  Error add(OpenScene scene, double noise, bool normals) {
    scene.sample(noise, s_.fit.seed);
    const double start = measure::cpuSeconds();
    const Result<PointStore> store = PointStore::build(scene.view(normals), s_.fit.threads);
    if (!store) return store.error();
    SLIMSurface surface;
    FitStatistics fit;
    if (Error error = fitSurface(*store, s_.fit, surface, &fit)) return error;
    TriangleMesh mesh;
    MeshStatistics statistics;
    if (Error error = extractMesh(surface, s_.mesh, mesh, &statistics)) return error;
    const double seconds = measure::cpuSeconds() - start;
    std::printf("%-18s %5.2f %d %6zu %5llu | ", scene.name.c_str(), noise, normals ? 1 : 0,
                scene.points.size(), static_cast<unsigned long long>(fit.open_leaves));
    Misses misses;
    SceneCoverage coverage(scene);
    const rivals::PointTree tree(scene.points);
    printMesh(scene, mesh, statistics, tree, coverage, seconds, misses);
    good_meshes_ += misses.none() ? 1 : 0;
    Misses of_picture;
    if (s_.picture) printPicture(scene, surface, tree, coverage, of_picture);
    good_pictures_ += of_picture.none() ? 1 : 0;
    good_ += misses.none() && of_picture.none() ? 1 : 0;
    ++rows_;
    misses.add(of_picture);
    std::printf("%s\n", misses.text());
    std::fflush(stdout);
    return {};
  }

  void printSummary() const {
    std::printf("%zu of %zu rows meet every target; meshes %zu", good_, rows_, good_meshes_);
    if (s_.picture) std::printf(", pictures %zu", good_pictures_);
    std::printf("\n");
  }

 private:
  static double limit(const OpenScene& scene) {
    return kFar * scene.widestSpacing() + kFar * scene.sigma;
  }

  void printMesh(const OpenScene& scene, const TriangleMesh& mesh, const MeshStatistics& statistics,
                 const rivals::PointTree& tree, SceneCoverage& coverage, double seconds,
                 Misses& misses) {
    const double border = scene.borderLength();
    const Coverage c = coverage.ofMesh(mesh);
    const std::size_t loops = countLoops(mesh), flat = countFlatTriangles(mesh);
    const auto wanted = scene.loops();
    const FarPlaces far = farPlaces(mesh, tree, scene.points, limit(scene));
    misses.check(c.beyond <= kMostAside * border, "beyond");
    misses.check(c.missing <= kMostAside * border, "missing");
    misses.check(c.kept == c.to_keep, "holes");
    misses.check(loops >= wanted[0] && loops <= wanted[1], "loops");
    misses.check(statistics.census.components == scene.sheets.size(), "components");
    misses.check(far.area == 0.0, "far");
    misses.check(flat == 0, "zero");
    const std::string kept = std::to_string(c.kept) + "/" + std::to_string(c.to_keep);
    std::string found = std::to_string(loops) + "/" + std::to_string(wanted[0]);
    if (wanted[1] > wanted[0]) found += "-" + std::to_string(wanted[1]);
    std::printf("%6zu %6.2f %6.2f %9s %9s %6llu %5llu %5zu %6.2f %6.1f %6.2f | ",
                mesh.triangles.size(), c.beyond / border, c.missing / border, kept.c_str(),
                found.c_str(), static_cast<unsigned long long>(statistics.census.border_edges),
                static_cast<unsigned long long>(statistics.census.components), flat, far.farthest,
                far.area, seconds);
  }

  void printPicture(const OpenScene& scene, const SLIMSurface& surface,
                    const rivals::PointTree& tree, SceneCoverage& coverage, Misses& misses) {
    const double border = scene.borderLength();
    const RayTracer tracer(surface, 1);
    const Coverage c = coverage.ofPicture(tracer);
    const double stray = strayShare(tracer, surface, tree, scene.points, limit(scene));
    misses.check(c.beyond <= kMostAside * border, "p.beyond");
    misses.check(c.missing <= kMostAside * border, "p.missing");
    misses.check(c.kept == c.to_keep, "p.holes");
    misses.check(stray == 0.0, "p.stray");
    std::printf("%6.2f %6.2f %6zu %7.3f | ", c.beyond / border, c.missing / border, c.kept,
                100.0 * stray);
  }

  const OpenSettings& s_;
  std::size_t rows_ = 0, good_ = 0, good_meshes_ = 0, good_pictures_ = 0;
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
      for (const char normals : settings.normals) {
        if (Error error = rows.add(scene, noise, normals == '1')) return error;
      }
    }
  }
  rows.printSummary();
  return {};
}

}  // namespace pcl_slim::borders

// SPDX-License-Identifier: BSD-3-Clause
// Closed bodies, which have no border: leaves that are open all the same, rays lost through them,
// rays that meet a surface without points, and the time of the maps.
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "borders/lists.h"
#include "closed_bodies.h"
#include "common/options.h"
#include "common/program.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/render/ray_tracer.h"
#include "rivals/point_tree.h"
#include "support/lab/bench.h"

using namespace pcl_slim;

namespace {

constexpr std::size_t kRays = 50000;

struct Settings {
  std::string bodies = "sphere,torus,bumpy,ellipsoid,amphora";
  std::string spreads = "random,blue,uneven";
  std::string points = "20000,100000", noise = "0,0.0005,0.001,0.005,0.01";
  std::string vectors = "best";
  FitParams fit;
};

/** \brief Rays from all around through places of a surface's box. */
std::vector<WorldRay> raysThrough(const SLIMSurface& surface, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-0.35, 0.35);
  const double scale = surface.info.scale;
  std::vector<WorldRay> rays(kRays);
  for (WorldRay& ray : rays) {
    for (std::size_t a = 0; a < 3; ++a) {
      const double middle = surface.info.origin[a] + scale * surface.root_ball[a];
      ray.direction[a] = normal(random);
      ray.origin[a] = middle + scale * uniform(random);
    }
    const auto& d = ray.direction;
    const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    for (std::size_t a = 0; a < 3; ++a) ray.origin[a] -= 4.0 * scale * d[a] / length;
  }
  return rays;
}

/** \brief Rays that meet a surface without its maps near points, and with them not, or farther
 * behind than the noise; and rays that meet a surface where there are no points, without and with
 * the maps. */
struct Rays {
  std::size_t lost = 0, sails = 0, sails_left = 0;
};

/** \brief Whether a place is near points of a scene: within three local spacings, or three times
 * the noise. */
class NearScene {
 public:
  NearScene(const measure::Scene& scene, double sigma)
      : points_(pointsOf(scene)), tree_(points_), sigma_(sigma) {}

  double tolerance() const { return kNear * sigma_; }

  bool operator()(const WorldHit& hit) const {
    const Vector3 place = {hit.position[0], hit.position[1], hit.position[2]};
    const Vector3& next = points_[tree_.nearest(place, 1).front()];
    const double distance = length(subtract(place, next));
    if (distance <= tolerance()) return true;
    const Vector3& last = points_[tree_.nearest(next, kNeighbors).back()];
    // On a plane, k points have the area of a disc up to the k-th.
    const double spacing = length(subtract(last, next)) * std::sqrt(M_PI / kNeighbors);
    return distance <= kNear * spacing;
  }

 private:
  static constexpr std::size_t kNeighbors = 12;
  static constexpr double kNear = 3;

  static std::vector<Vector3> pointsOf(const measure::Scene& scene) {
    std::vector<Vector3> points;
    for (std::size_t i = 0; i + 2 < scene.points.size(); i += 3)
      points.push_back({scene.points[i], scene.points[i + 1], scene.points[i + 2]});
    return points;
  }

  std::vector<Vector3> points_;
  rivals::PointTree tree_;
  double sigma_;
};

Rays countRays(const SLIMSurface& surface, const NearScene& isNear, std::uint64_t seed) {
  SLIMSurface whole = surface;
  whole.dropTrimMaps();
  const std::vector<WorldRay> rays = raysThrough(surface, seed);
  std::vector<WorldHit> hits, whole_hits;
  Rays counts;
  if (RayTracer(surface, 1).cast(rays, VisibleSides::kBoth, hits)) return counts;
  if (RayTracer(whole, 1).cast(rays, VisibleSides::kBoth, whole_hits)) return counts;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (hits[i].met()) counts.sails_left += !isNear(hits[i]);
    if (!whole_hits[i].met()) continue;
    const bool differs = !hits[i].met() || hits[i].depth - whole_hits[i].depth >
                                               isNear.tolerance() + 1e-3 * surface.info.scale;
    const bool near = isNear(whole_hits[i]);
    counts.sails += !near;
    counts.lost += near && differs;
  }
  return counts;
}

Error measureBody(const Settings& s, const measure::Scene& scene, double noise) {
  const Result<PointStore> store =
      PointStore::build(measure::viewOf(scene, nullptr, false), s.fit.threads);
  if (!store) return store.error();
  SLIMSurface surface;
  FitStatistics stats;
  double seconds[2] = {};  // of CPU: without maps, with them
  for (const bool trim : {false, true}) {
    FitParams params = s.fit;
    params.trim = trim;
    const double start = measure::cpuSeconds();
    if (Error error = fitSurface(*store, params, surface, &stats)) return error;
    seconds[trim] = measure::cpuSeconds() - start;
  }
  const Rays rays = countRays(surface, NearScene(scene, noise * scene.diagonal), s.fit.seed);
  std::printf("%6llu %5llu %6llu %5zu %5zu %5zu %7.3f %6.2f %6.1f\n",
              static_cast<unsigned long long>(stats.leaves),
              static_cast<unsigned long long>(stats.open_leaves),
              static_cast<unsigned long long>(stats.trim_candidates), rays.lost, rays.sails,
              rays.sails_left, seconds[1],
              1e6 * (seconds[1] - seconds[0]) / static_cast<double>(stats.points),
              100.0 * (seconds[1] / seconds[0] - 1.0));
  std::fflush(stdout);
  return {};
}

Error runGrid(const Settings& s, const std::vector<double>& counts,
              const std::vector<double>& noises) {
  std::printf("%-10s %-7s %8s %7s %6s %5s %6s %5s %5s %5s %7s %6s %6s\n", "body", "spread",
              "points", "noise", "leaves", "open", "cand.", "lost", "sails", "left", "fit s",
              "us/pt", "%fit");
  for (const std::string& body_name : borders::wordsOf(s.bodies)) {
    for (const std::string& spread_name : borders::wordsOf(s.spreads)) {
      measure::Body body;
      measure::Spread spread;
      if (!measure::parseBody(body_name, body) || !measure::parseSpread(spread_name, spread)) {
        return {ErrorCode::kBadArgument,
                "no body or spread is called '" + body_name + "', '" + spread_name + "'; see -h"};
      }
      for (const double count : counts) {
        for (const double noise : noises) {
          const auto scene =
              measure::makeBody(body, spread, static_cast<std::size_t>(count), noise, s.fit.seed);
          std::printf("%-10s %-7s %8.0f %7.4f ", body_name.c_str(), spread_name.c_str(), count,
                      noise);
          if (Error error = measureBody(s, scene, noise)) return error;
        }
      }
    }
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  s.fit.threads = 1;
  OptionTable table("closed_bench", "", "Leaves of closed bodies that trim maps open.");
  table.text("bodies", &s.bodies, "LIST",
             "sphere, torus, bumpy, ellipsoid, amphora, cube, slab, wedge");
  table.text("spreads", &s.spreads, "LIST", "random, blue, uneven, step");
  table.text("points", &s.points, "LIST", "numbers of points");
  table.text("noise", &s.noise, "LIST", "noise, shares of the diagonal");
  table.integer("seed", &s.fit.seed, 0, 1000000, "of the points, the rays and the fit");
  table.integer("threads", &s.fit.threads, 1, 256, "threads");
  table.text("vectors", &s.vectors, "NAME", "instruction set of the kernels, such as AVX2");
  if (const auto status = table.parse(argc, argv)) return *status;
  std::vector<double> counts, noises;
  Error error = measure::parseLists(
      {{"points", &s.points, 100, 1e8, true, &counts}, {"noise", &s.noise, 0, 1, false, &noises}});
  if (!error) error = measure::chooseVectors(s.vectors);
  if (!error) {
    measure::keepFreedMemory();
    error = runGrid(s, counts, noises);
  }
  if (!error) return kExitDone;
  std::fprintf(stderr, "closed_bench: %s\n", error.message.c_str());
  return error.code == ErrorCode::kBadArgument ? kExitUsage : kExitFailed;
}

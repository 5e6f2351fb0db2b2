// SPDX-License-Identifier: BSD-3-Clause
// What traced frames cost, whether they meet what the rasteriser meets, whether any pixel inside
// the picture of the object met nothing, and how Embree's tree does in place of our own.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "camera/camera_rays.h"
#include "common/options.h"
#include "embree_tree.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/ray_tracer.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/render/traced_picture.h"
#include "pcl_slim/surface/surface_io.h"
#include "support/lab/bench.h"
#include "support/lab/reference/reference_renderer.h"

using namespace pcl_slim;
using measure::cpuSeconds;
using measure::median;
using measure::wallSeconds;

namespace {

struct Settings {
  std::string surface, vectors = "best";
  int size = 1000, repeat = 3, threads = 2, occlusion = 0;
  bool reference = true, embree = true;
};

/** Wall and CPU seconds of some runs, the medians. */
struct Seconds {
  double wall = 0.0, cpu = 0.0;
};

template <typename Run>
Seconds timed(int repeat, const Run& run) {
  std::vector<double> wall, cpu;
  for (int i = 0; i < repeat; ++i) {
    const double wall_start = wallSeconds(), cpu_start = cpuSeconds();
    run();
    wall.push_back(wallSeconds() - wall_start);
    cpu.push_back(cpuSeconds() - cpu_start);
  }
  return {median(wall), median(cpu)};
}

void print(const char* what, const Seconds& seconds, double rays) {
  std::printf("  %-34s %7.2f s wall, %7.2f s CPU, %6.2f us CPU a ray\n", what, seconds.wall,
              seconds.cpu, 1e6 * seconds.cpu / std::max(1.0, rays));
}

/** Pixels that met nothing in groups that do not reach the picture's rim: holes of the object, or
 * gaps. \return their number and the number of pixels in groups of at most four. */
std::pair<std::size_t, std::size_t> holesOf(const GBuffer& buffer) {
  std::vector<std::uint8_t> seen(buffer.numPixels(), 0);
  std::size_t all = 0, small = 0;
  for (std::size_t start = 0; start < seen.size(); ++start) {
    if (seen[start] || buffer.covered(start)) continue;
    std::vector<std::size_t> group{start};
    seen[start] = 1;
    bool rim = false;
    for (std::size_t i = 0; i < group.size(); ++i) {
      const int x = static_cast<int>(group[i]) % buffer.width;
      const int y = static_cast<int>(group[i]) / buffer.width;
      rim = rim || x == 0 || y == 0 || x == buffer.width - 1 || y == buffer.height - 1;
      const int next[4][2] = {{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}};
      for (const auto& at : next) {
        if (at[0] < 0 || at[1] < 0 || at[0] >= buffer.width || at[1] >= buffer.height) continue;
        const std::size_t pixel = buffer.index(at[0], at[1]);
        if (seen[pixel] || buffer.covered(pixel)) continue;
        seen[pixel] = 1;
        group.push_back(pixel);
      }
    }
    if (rim) continue;
    all += group.size();
    if (group.size() <= 4) small += group.size();
  }
  return {all, small};
}

/** Pixels that differ from the reference rasteriser, lengths in local units. */
void printDifference(const GBuffer& traced, const GBuffer& reference, double diagonal) {
  std::size_t both = 0, coverage = 0, beyond = 0;
  double worst = 0.0, sum_sq = 0.0;
  for (std::size_t i = 0; i < traced.numPixels(); ++i) {
    coverage += traced.covered(i) != reference.covered(i);
    if (!traced.covered(i) || !reference.covered(i)) continue;
    ++both;
    const double d = std::abs(double{traced.depth[i]} - reference.depth[i]) / diagonal;
    beyond += d > 1e-5;
    if (d > 1e-5) continue;
    worst = std::max(worst, d);
    sum_sq += d * d;
  }
  const double within = static_cast<double>(std::max<std::size_t>(1, both - beyond));
  std::printf(
      "  beside the reference: %zu pixels of both, %zu of one alone, %zu deeper or nearer "
      "by over 1e-5 L; the others rms %.1e L, worst %.1e L\n",
      both, coverage, beyond, std::sqrt(sum_sq / within), worst);
}

TraceParams paramsOf(const Settings& s, const Camera& camera, bool lit) {
  TraceParams params;
  params.threads = s.threads;
  params.columns = kPositionColumn;
  if (lit) params.lights = defaultLights(camera);
  for (RayLight& light : params.lights) light.spread = 0.0;
  return params;
}

void printFrames(const Settings& s, RayTracer& tracer, const Camera& camera, GBuffer& buffer) {
  LightBuffer light;
  TraceStatistics counts;
  const auto frame = [&](const char* what, const TraceParams& params) {
    Error error;
    const Seconds seconds =
        timed(s.repeat, [&] { error = tracer.trace(camera, params, buffer, light, &counts); });
    if (error) return std::printf("  %s\n", error.message.c_str()), void();
    const auto rays =
        static_cast<double>(counts.rays_primary + counts.rays_shadow + counts.rays_occlusion);
    print(what, seconds, rays);
    std::printf(
        "    rays: %llu from the camera, %llu of them met, %llu to lights, %llu for "
        "occlusion; a ray: %.1f nodes, %.1f leaves to find q^, %.1f to blend; "
        "peeled %llu, gaps closed %llu\n",
        static_cast<unsigned long long>(counts.rays_primary),
        static_cast<unsigned long long>(counts.covered_pixels),
        static_cast<unsigned long long>(counts.rays_shadow),
        static_cast<unsigned long long>(counts.rays_occlusion),
        static_cast<double>(counts.nodes) / rays, static_cast<double>(counts.tested_first) / rays,
        static_cast<double>(counts.tested_blend) / rays,
        static_cast<unsigned long long>(counts.peeled),
        static_cast<unsigned long long>(counts.closed));
  };
  if (s.occlusion > 0) {
    TraceParams params = paramsOf(s, camera, true);
    params.occlusion_rays = s.occlusion;
    frame("two lights and occlusion", params);
  }
  frame("camera rays alone", paramsOf(s, camera, false));
  frame("two lights with shadows", paramsOf(s, camera, true));
}

std::vector<detail::BoundedRay> cameraRays(const SLIMSurface& surface, const Camera& camera) {
  const detail::CameraRays rays(camera, surface.info.origin, surface.info.scale);
  std::vector<detail::BoundedRay> all;
  for (int y = 0; y < camera.size.height; ++y) {
    for (int x = 0; x < camera.size.width; ++x) all.push_back({rays.ray(x, y)});
  }
  return all;
}

std::vector<detail::BoundedRay> shadowRays(const SLIMSurface& surface, const Camera& camera,
                                           const GBuffer& buffer) {
  std::vector<detail::BoundedRay> all;
  for (const RayLight& light : defaultLights(camera)) {
    for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
      if (!buffer.covered(i)) continue;
      const auto &p = buffer.position[i], &n = buffer.normal[i];
      const Vector3 normal{n[0], n[1], n[2]}, towards = normalized(light.towards);
      if (!(dot(normal, towards) > 0.0)) continue;
      detail::BoundedRay ray;
      const double radius = surface.radius[buffer.surfel[i]];
      ray.ray = {along({p[0], p[1], p[2]}, 0.01 * radius, normal), towards};
      ray.nearest_behind = radius;
      all.push_back(ray);
    }
  }
  return all;
}

/** Our tree and Embree's with the same rays and the same rules, q^ alone. */
void printTrees(const Settings& s, const SLIMSurface& surface, const Camera& camera,
                const GBuffer& buffer) {
  const double start = wallSeconds();
  const auto other = bench::embreeTree(surface, s.threads);
  if (!other) return;
  std::printf("  Embree's tree built in %.2f s\n", wallSeconds() - start);
  const detail::RayScene scene(surface, s.threads);
  detail::RayRules rules;
  rules.front_only = surface.info.oriented;
  rules.min_coverage = 0.0;  // any root counts, in both
  const auto primary = cameraRays(surface, camera), shadow = shadowRays(surface, camera, buffer);
  std::vector<double> own(primary.size()), others(primary.size());
  std::vector<std::uint8_t> own_met(shadow.size()), others_met(shadow.size());
  detail::RayCounts counts;
  const auto batched = [&](std::size_t count, const auto& run) {
    constexpr std::size_t kBatch = 256;
    parallelFor((count + kBatch - 1) / kBatch, s.threads, 1, [&](std::size_t b, int) {
      detail::RayCounts mine;
      run(b * kBatch, std::min(count, (b + 1) * kBatch) - b * kBatch, mine);
    });
  };
  const auto n = static_cast<double>(primary.size()), m = static_cast<double>(shadow.size());
  for (int round = 0; round < 2; ++round) {
    print("first root, own tree",
          timed(s.repeat,
                [&] {
                  batched(primary.size(), [&](std::size_t at, std::size_t count, auto& mine) {
                    detail::kernels::traceDepths(scene, rules, primary.data() + at, count,
                                                 own.data() + at, mine);
                  });
                }),
          n);
    print("first root, Embree",
          timed(s.repeat, [&] { other->first(primary, rules.front_only, s.threads, others); }), n);
    print("any root, own tree",
          timed(s.repeat,
                [&] {
                  batched(shadow.size(), [&](std::size_t at, std::size_t count, auto& mine) {
                    detail::kernels::traceBlocked(scene, rules, shadow.data() + at, count,
                                                  own_met.data() + at, mine);
                  });
                }),
          m);
    print("any root, Embree", timed(s.repeat, [&] { other->any(shadow, s.threads, others_met); }),
          m);
  }
  std::size_t differ = 0, differ_met = 0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    differ += std::isfinite(own[i]) != std::isfinite(others[i]) ||
              (std::isfinite(own[i]) && std::abs(own[i] - others[i]) > 1e-5);
  }
  for (std::size_t i = 0; i < own_met.size(); ++i) differ_met += own_met[i] != others_met[i];
  std::printf("  the trees differ in %zu of %zu first roots and %zu of %zu shadow rays\n", differ,
              own.size(), differ_met, own_met.size());
}

int run(const Settings& s) {
  const auto surface = loadSlim(s.surface);
  if (!surface) {
    std::fprintf(stderr, "rays_bench: %s\n", surface.error().message.c_str());
    return kExitUsage;
  }
  const BoundingSpheres object = spheresOf(*surface);
  const Camera camera = cameraFor(chooseView(object), object, {s.size, s.size});
  const double start = wallSeconds();
  RayTracer tracer(*surface, s.threads);
  std::printf("%s: %zu leaves of degree %d; tree built in %.2f s, %d threads\n", s.surface.c_str(),
              surface->numLeaves(), surface->info.degree, wallSeconds() - start, s.threads);
  GBuffer buffer;
  printFrames(s, tracer, camera, buffer);
  const auto [all, small] = holesOf(buffer);
  std::printf("  pixels inside the object that met nothing: %zu, in groups of up to four: %zu\n",
              all, small);
  if (s.reference) {
    RenderParams params;
    params.columns = 0;
    params.threads = s.threads;
    GBuffer reference;
    if (lab::renderReference(*surface, camera, params, reference)) return kExitFailed;
    printDifference(buffer, reference, surface->info.diagonal);
  }
  if (s.embree) printTrees(s, *surface, camera, buffer);
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable table("rays_bench", "", "Seconds a traced frame, and Embree's tree beside our own.");
  table.positional("SURFACE.slim", &s.surface, "surface of pcl_slim_fit");
  table.integer("size", &s.size, 16, 8192, "pixels a side");
  table.integer("repeat", &s.repeat, 1, 1000, "frames to take the median of");
  table.integer("threads", &s.threads, 1, 256, "threads");
  table.integer("occlusion", &s.occlusion, 0, 4096, "occlusion rays a point");
  table.toggle("reference", &s.reference, "compare with the reference rasteriser");
  table.toggle("embree", &s.embree, "compare with Embree's tree");
  table.text("vectors", &s.vectors, "NAME", "instruction set of the kernels, such as AVX2");
  if (const auto status = table.parse(argc, argv)) return *status;
  if (Error error = measure::chooseVectors(s.vectors)) {
    std::fprintf(stderr, "rays_bench: %s\n", error.message.c_str());
    return kExitUsage;
  }
  return run(s);
}

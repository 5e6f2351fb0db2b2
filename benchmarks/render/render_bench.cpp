// SPDX-License-Identifier: BSD-3-Clause
// Milliseconds a frame of the fast rasteriser beside the reference in double, in one run, and by
// how much their pictures differ.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "common/options.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/surface/surface_io.h"
#include "render/made_sphere.h"
#include "support/lab/bench.h"
#include "support/lab/reference/reference_renderer.h"

using namespace pcl_slim;
using measure::median;
using measure::wallSeconds;

namespace {

struct Settings {
  std::string surface, vectors = "best";
  int size = 1000, repeat = 15, threads = 2, leaves = 48000, degree = 2;
  double zoom = 1.0, lod = 0.0;
  bool reference = true, trim = true;
};

/** \brief Milliseconds a frame: by the clock, of all threads together, and of the quickest. */
struct FrameTime {
  double wall = 0.0, cpu = 0.0;
  double least = 0.0;  ///< wall of the quickest frame
};

/** \brief Milliseconds a frame: the median of warm ones, each from a camera turned a little. */
template <typename Renderer>
FrameTime frameTime(Renderer& renderer, const Camera& camera, const RenderParams& params,
                    int repeat, GBuffer& buffer, RenderStatistics& counts) {
  std::vector<double> times, cpu;
  for (int i = 0; i <= repeat; ++i) {
    Camera moved = camera;
    moved.pixel_offset = {0.01 * i, -0.02 * i};
    const double start = wallSeconds(), cpu_start = measure::cpuSeconds();
    if (Error error = renderer.render(moved, params, buffer, &counts)) {
      std::fprintf(stderr, "render_bench: %s\n", error.message.c_str());
      return {};
    }
    if (i == 0) continue;
    times.push_back(1e3 * (wallSeconds() - start));
    cpu.push_back(1e3 * (measure::cpuSeconds() - cpu_start));
  }
  return {median(times), median(cpu), *std::min_element(times.begin(), times.end())};
}

/** \brief How a frame differs from the reference's of the same camera. */
void printDifference(const GBuffer& a, const GBuffer& b) {
  std::size_t coverage = 0, both = 0, far = 0, tilted = 0;
  double depth_sq = 0.0, cosine_sum = 0.0;
  for (std::size_t i = 0; i < a.numPixels(); ++i) {
    coverage += a.covered(i) != b.covered(i);
    if (!a.covered(i) || !b.covered(i)) continue;
    ++both;
    const double d = a.depth[i] - b.depth[i];
    if (std::abs(d) > 1e-3) {
      ++far;
      continue;
    }
    depth_sq += d * d;
    double chord_sq = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      chord_sq += std::pow(double{a.normal[i][k]} - b.normal[i][k], 2);
    }
    const double angle = std::sqrt(chord_sq);
    tilted += angle > 0.02;
    cosine_sum += angle;
  }
  const double n = static_cast<double>(std::max<std::size_t>(both, 1));
  std::printf(
      "  differ: coverage %zu pixels, depth by over 1e-3 in %zu, normal by over .02 in %zu; "
      "rms depth %.2e, mean angle %.2e\n",
      coverage, far, tilted, std::sqrt(depth_sq / n), cosine_sum / n);
}

/** \brief A surface and the camera before it. */
struct Scene {
  SLIMSurface surface;
  Camera camera;
};

Result<Scene> sceneOf(const Settings& s) {
  if (s.surface == "sphere" || s.surface == "cap") {
    const MadeSphere sphere{static_cast<std::size_t>(s.leaves), s.degree, s.surface == "cap",
                            s.lod > 0.0};
    return Scene{makeSphere(sphere), cameraBeforeSphere(s.size, s.zoom)};
  }
  Result<SLIMSurface> surface = loadSlim(s.surface);
  if (!surface) return surface.error();
  const BoundingSpheres object = spheresOf(*surface);
  Camera camera = cameraFor(chooseView(object), object, {s.size, s.size});
  camera.fov /= s.zoom;
  return Scene{std::move(*surface), camera};
}

void printCounts(const RenderStatistics& counts) {
  const auto n = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf(
      "  outside %llu, back-facing %llu, below detail %llu, coarse %llu, entries %llu, "
      "rays %llu + %llu, bracketed %llu\n",
      n(counts.outside_frustum), n(counts.back_facing), n(counts.below_detail),
      n(counts.coarse_surfels), n(counts.tile_entries), n(counts.rays_first), n(counts.rays_blend),
      n(counts.rays_bracketed));
}

/** \brief The same frame by the reference: how much slower it is, and what differs. */
void compareWithReference(const Settings& s, const Camera& camera, const FrameTime& plain,
                          SurfaceRenderer& renderer, GBuffer& buffer) {
  RenderParams params;
  params.threads = s.threads;
  params.columns = 0;
  params.trim = s.trim;
  GBuffer reference;
  RenderStatistics counts;
  lab::ReferenceRenderer exact(renderer.surface());
  const FrameTime slow = frameTime(exact, camera, params, 3, reference, counts);
  std::printf("  reference %.1f ms (%.1f): %.1f times, %.1f of threads\n", slow.wall, slow.cpu,
              slow.wall / plain.wall, slow.cpu / plain.cpu);
  std::printf("  quickest: reference %.1f, %.1f times\n", slow.least, slow.least / plain.least);
  frameTime(renderer, camera, params, 3, buffer, counts);
  printDifference(buffer, reference);
}

int run(const Settings& s) {
  const Result<Scene> scene = sceneOf(s);
  if (!scene) {
    std::fprintf(stderr, "render_bench: %s\n", scene.error().message.c_str());
    return kExitUsage;
  }
  const double start = wallSeconds();
  SurfaceRenderer renderer(scene->surface, s.threads);
  std::printf("%s: %zu leaves of degree %d, index %.1f ms\n", s.surface.c_str(),
              scene->surface.numLeaves(), scene->surface.info.degree,
              1e3 * (wallSeconds() - start));
  RenderParams params;
  params.threads = s.threads;
  params.lod = s.lod;
  params.trim = s.trim;
  GBuffer buffer;
  RenderStatistics counts;
  const auto time = [&] {
    return frameTime(renderer, scene->camera, params, s.repeat, buffer, counts);
  };
  params.columns = kCurvatureColumn;
  const FrameTime curvature = time();
  params.columns = 0;
  const FrameTime plain = time();
  params.threads = 1;
  const FrameTime single = time();
  std::printf(
      "  %llu pixels covered; %.2f ms a frame (%.2f of threads), with curvature %.2f "
      "(%.2f: %.2f times), on one thread %.2f (%.2f)\n"
      "  quickest: %.2f, %.2f, %.2f\n",
      static_cast<unsigned long long>(counts.covered_pixels), plain.wall, plain.cpu, curvature.wall,
      curvature.cpu, curvature.cpu / plain.cpu, single.wall, single.cpu, plain.least,
      curvature.least, single.least);
  printCounts(counts);
  if (s.reference) compareWithReference(s, scene->camera, plain, renderer, buffer);
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable table("render_bench", "", "Milliseconds a frame beside the reference rasteriser.");
  table.positional("SURFACE.slim|sphere|cap", &s.surface,
                   "surface of pcl_slim_fit, a sphere made here, or its middle alone");
  table.integer("leaves", &s.leaves, 100, 10000000, "of the sphere");
  table.integer("degree", &s.degree, 2, 4, "of the sphere's leaves");
  table.integer("size", &s.size, 16, 8192, "pixels a side");
  table.integer("repeat", &s.repeat, 1, 1000, "frames to take the median of");
  table.integer("threads", &s.threads, 1, 256, "threads");
  table.number("zoom", &s.zoom, 0.01, 1000.0, "narrows the field of view");
  table.number("lod", &s.lod, 0.0, 1024.0, "level of detail in pixels");
  table.toggle("trim", &s.trim, "end open surfaces where their trim maps say so");
  table.toggle("reference", &s.reference, "compare with the reference");
  table.text("vectors", &s.vectors, "NAME", "instruction set of the kernels, such as AVX2");
  if (const auto status = table.parse(argc, argv)) return *status;
  if (Error error = measure::chooseVectors(s.vectors)) {
    std::fprintf(stderr, "render_bench: %s\n", error.message.c_str());
    return kExitUsage;
  }
  return run(s);
}

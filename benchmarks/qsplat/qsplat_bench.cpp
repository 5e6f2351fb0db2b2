// SPDX-License-Identifier: BSD-3-Clause
// One row of a table: a SLIM surface fitted to the generated surface of rays_model, and a plain
// QSplat of as many points of that surface, drawn with the same camera and lights; each beside the
// picture that the surface's formula gives.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/render/image.h"
#include "pcl_slim/render/shading.h"
#include "pcl_slim/surface/surface_io.h"
#include "qsplat/qsplat.h"
#include "rays/generated_surface.h"
#include "support/lab/bench.h"

using namespace pcl_slim;
using namespace pcl_slim::bench;

namespace {

struct Settings {
  std::string surface, pictures;
  int size = 600, threads = 2;
  double zoom = 1.0, per_leaf = 1.0;
};

Camera cameraOf(const Settings& s) {
  Camera camera;
  camera.position = {1.6, -3.6, 1.4};
  camera.fov = 36.0 / s.zoom;
  camera.up = {0.0, 0.0, 1.0};
  camera.size = {s.size, s.size};
  return camera;
}

/** Depth of the formula's surface on a ray; infinity where it is missed. Steps are a quarter of the
 * finest wave, so that none is stepped over. */
double exactDepth(const detail::Ray& ray) {
  constexpr double kOutside = 1.3, kStep = 0.004;
  const double middle = -dot(ray.origin, ray.direction);
  const double half_sq = kOutside * kOutside - (dot(ray.origin, ray.origin) - middle * middle);
  if (!(half_sq > 0.0)) return HUGE_VAL;
  const auto height = [&](double t) {
    const Vector3 p = along(ray.origin, t, ray.direction);
    return length(p) - generatedRadius(normalized(p));
  };
  const double end = middle + std::sqrt(half_sq);
  for (double t = middle - std::sqrt(half_sq); t < end; t += kStep) {
    if (height(t) > 0.0) continue;
    double low = t - kStep, high = t;
    for (int i = 0; i < 40; ++i) {
      const double at = 0.5 * (low + high);
      (height(at) > 0.0 ? low : high) = at;
    }
    return 0.5 * (low + high);
  }
  return HUGE_VAL;
}

GBuffer exactFrame(const Settings& s, const detail::CameraRays& rays) {
  GBuffer buffer;
  buffer.resize(s.size, s.size, kPositionColumn);
  parallelFor(static_cast<std::size_t>(s.size), s.threads, 1, [&](std::size_t y, int) {
    for (int x = 0; x < s.size; ++x) {
      const detail::Ray ray = rays.ray(x, static_cast<int>(y));
      const double depth = exactDepth(ray);
      if (!(depth < HUGE_VAL)) continue;
      const std::size_t pixel = buffer.index(x, static_cast<int>(y));
      const Vector3 p = along(ray.origin, depth, ray.direction), n = generatedNormal(normalized(p));
      buffer.depth[pixel] = static_cast<float>(depth);
      buffer.surfel[pixel] = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        buffer.normal[pixel][a] = static_cast<float>(n[a]);
        buffer.position[pixel][a] = static_cast<float>(p[a]);
      }
    }
  });
  return buffer;
}

/** Points of the formula's surface; radii reach to the farther neighbours of a hexagonal lattice
 * that is stretched as the surface is there, so that discs overlap without holes. */
std::vector<Splat> splatsOf(std::size_t count) {
  std::vector<Splat> splats(count);
  const double cell = std::sqrt(4.0 * std::acos(-1.0) / static_cast<double>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3 d = generatedDirection(i, count), p = generatedPoint(d), n = generatedNormal(d);
    const double slant = std::max(0.2, dot(d, n));
    splats[i] = {p, n, 0.75 * cell * length(p) / slant};
  }
  return splats;
}

/** What a frame is off by. */
struct Deviation {
  double depth = 0.0, normal = 0.0,
         shade = 0.0;  ///< root mean squares: length, degrees, grey levels
  std::size_t coverage = 0;

  Deviation(const GBuffer& frame, const Image& picture, const GBuffer& exact, const Image& right,
            double scale) {
    double depth_sq = 0.0, angle_sq = 0.0, shade_sq = 0.0, n = 0.0;
    for (std::size_t i = 0; i < exact.numPixels(); ++i) {
      coverage += frame.covered(i) != exact.covered(i);
      if (!frame.covered(i) || !exact.covered(i)) continue;
      const double off = scale * frame.depth[i] - exact.depth[i];
      // Another sheet behind a silhouette is a matter of coverage, not of depth.
      if (std::abs(off) > 0.02) {
        ++coverage;
        continue;
      }
      double cosine = 0.0;
      for (std::size_t a = 0; a < 3; ++a) cosine += double{frame.normal[i][a]} * exact.normal[i][a];
      const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / std::acos(-1.0);
      const double step = static_cast<double>(picture.rgb[3 * i]) - right.rgb[3 * i];
      depth_sq += off * off;
      angle_sq += angle * angle;
      shade_sq += step * step;
      n += 1.0;
    }
    n = std::max(1.0, n);
    depth = std::sqrt(depth_sq / n);
    normal = std::sqrt(angle_sq / n);
    shade = std::sqrt(shade_sq / n);
  }
};

void printRow(const char* name, std::size_t primitives, double seconds, const Deviation& d) {
  constexpr double kDiagonal = 4.0;  // of the surface's box, within 2 %
  std::printf("| %s | %zu | %.1e | %.2f | %.2f | %zu | %.0f |\n", name, primitives,
              d.depth / kDiagonal, d.normal, d.shade, d.coverage, 1e3 * seconds);
}

int run(const Settings& s) {
  const auto surface = loadSlim(s.surface);
  if (!surface) {
    std::fprintf(stderr, "qsplat_bench: %s\n", surface.error().message.c_str());
    return kExitUsage;
  }
  const Camera camera = cameraOf(s);
  const detail::CameraRays rays(camera, {0.0, 0.0, 0.0}, 1.0);
  const GBuffer exact = exactFrame(s, rays);

  const std::size_t leaves = surface->numLeaves();
  const auto count = static_cast<std::size_t>(s.per_leaf * static_cast<double>(leaves));
  GBuffer points, slim;
  points.resize(s.size, s.size, kPositionColumn);
  const QSplat qsplat(splatsOf(count));
  const double start = measure::cpuSeconds();
  qsplat.draw(rays, points);
  const double points_seconds = measure::cpuSeconds() - start;

  RenderParams params;
  params.columns = kPositionColumn;
  params.threads = 1;
  SurfaceRenderer renderer(*surface);
  double slim_seconds = 0.0;
  for (int i = 0; i < 2; ++i) {
    const double begin = measure::cpuSeconds();
    if (renderer.render(camera, params, slim)) return kExitFailed;
    slim_seconds = measure::cpuSeconds() - begin;
  }

  ShadingParams shading;
  shading.ambient_occlusion = 0.0;
  const auto right = shade(exact, camera, shading), of_points = shade(points, camera, shading),
             of_slim = shade(slim, camera, shading, surface->info.scale);
  if (!right || !of_points || !of_slim) return kExitFailed;
  printRow("QSplat", count, points_seconds, Deviation(points, *of_points, exact, *right, 1.0));
  printRow("SLIM", leaves, slim_seconds,
           Deviation(slim, *of_slim, exact, *right, surface->info.scale));
  if (s.pictures.empty()) return kExitDone;
  const std::pair<const char*, const Image*> all[] = {
      {"exact", &*right}, {"qsplat", &*of_points}, {"slim", &*of_slim}};
  for (const auto& [name, image] : all) {
    if (saveImage(s.pictures + "_" + name + ".png", *image)) return kExitFailed;
  }
  return kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  OptionTable table("qsplat_bench", "", "A SLIM surface and a plain QSplat of as many points.");
  table.positional("SURFACE.slim", &s.surface, "fit of rays_model's points");
  table.text("pictures", &s.pictures, "NAME",
             "write NAME_exact.png, NAME_qsplat.png, NAME_slim.png");
  table.integer("size", &s.size, 16, 4096, "pixels a side");
  table.number("zoom", &s.zoom, 0.1, 100.0, "narrows the field of view");
  table.number("per_leaf", &s.per_leaf, 0.01, 100.0, "points of QSplat for each leaf");
  table.integer("threads", &s.threads, 1, 256, "threads of the exact picture");
  if (const auto status = table.parse(argc, argv)) return *status;
  return run(s);
}

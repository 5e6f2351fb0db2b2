// SPDX-License-Identifier: BSD-3-Clause
// color_bench: how sharp the colours of surfaces are, in pictures beside those of the scan's points.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "common/options.h"
#include "pcl_slim/core/cielab.h"
#include "pcl_slim/core/stopwatch.h"
#include "pcl_slim/query/surface_probe.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/bounding_spheres.h"
#include "pcl_slim/render/image.h"
#include "pcl_slim/render/shading.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/scan/scan.h"
#include "splats/picture_quality.h"

namespace {

using namespace pcl_slim;
using namespace pcl_slim::measure;

/** CIELAB of the pixels of a picture; L* below 0 where nothing is. */
std::vector<std::array<float, 3>> labOf(const GBuffer& buffer) {
  std::vector<std::array<float, 3>> lab(buffer.numPixels(), {-1.0f, 0.0f, 0.0f});
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    if (!buffer.covered(i)) continue;
    const auto& rgb = buffer.color[i];
    const auto value = labFromRgb({rgb[0], rgb[1], rgb[2]});
    for (std::size_t k = 0; k < 3; ++k) lab[i][k] = static_cast<float>(value[k]);
  }
  return lab;
}

void save(const GBuffer& buffer, const std::string& path) {
  Image image{buffer.width, buffer.height, {}};
  for (int y = 0; y < buffer.height; ++y)
    for (int x = 0; x < buffer.width; ++x) {
      const std::size_t i = buffer.index(x, y);
      for (int c = 0; c < 3; ++c)
        image.rgb.push_back(buffer.covered(i)
                                ? static_cast<std::uint8_t>(std::lround(
                                      255 * buffer.color[i][static_cast<std::size_t>(c)]))
                                : 255);
    }
  if (const Error error = saveImage(path, image))
    std::fprintf(stderr, "%s\n", error.message.c_str());
}

Error measureScan(const std::string& path, int size, const std::string& out) {
  Result<ColoredScan> scan = loadColoredScan(path);
  if (!scan) return scan.error();
  const SplatSet points = everyPoint(*scan);
  const BoundingSpheres object = spheresOf(points);
  FittedScan fitted;
  const Stopwatch fitting;
  if (Error error = fitScan({scan->file.view(false), scan->colors}, {}, fitted)) return error;
  const double fit_seconds = fitting.seconds();
  Camera camera = fitCamera(object, chooseView(object).direction, {size, size});
  GBuffer truth, made;
  if (Error error = renderDiscs(points, camera, {}, truth)) return error;
  // As many covered pixels as points: 1:1.
  const double scale =
      std::sqrt(static_cast<double>(points.size()) / static_cast<double>(truth.numCovered()));
  size = static_cast<int>(size * scale);
  camera = fitCamera(object, chooseView(object).direction, {size, size});
  if (Error error = renderDiscs(points, camera, {}, truth)) return error;
  SurfaceRenderer renderer(fitted.surface);
  RenderParams params;
  const Stopwatch watch;
  if (Error error = renderer.render(camera, params, made)) return error;
  const double drawn = watch.seconds();
  std::vector<Vector3> places;
  std::vector<std::array<float, 3>> normals;
  std::vector<std::size_t> pixels;
  const SurfaceInfo& info = fitted.surface.info;
  for (std::size_t i = 0; i < made.numPixels(); ++i) {
    if (!made.covered(i)) continue;
    const auto &p = made.position[i], &n = made.normal[i];
    places.push_back(along(info.origin, info.scale, Vector3{p[0], p[1], p[2]}));
    const float sign = made.back_face[i] ? -1.0f : 1.0f;
    normals.push_back({sign * n[0], sign * n[1], sign * n[2]});
    pixels.push_back(i);
  }
  const auto colors = surfaceColors(fitted.surface, places, normals, 0);
  made.color.assign(made.numPixels(), {1, 1, 1});
  for (std::size_t k = 0; k < pixels.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c) made.color[pixels[k]][c] = colors[k][c] / 255.0f;
  const double painted = watch.seconds() - drawn;
  if (!out.empty()) {
    save(truth, out + "_points.png");
    save(made, out + "_surface.png");
  }
  const auto a = labOf(truth), b = labOf(made);
  double own = 0, other = 0, difference = 0;
  std::size_t count = 0, both = 0;
  std::vector<float> differences;
  for (int y = 1; y + 1 < size; ++y) {
    for (int x = 1; x + 1 < size; ++x) {
      const std::size_t i = truth.index(x, y);
      if (a[i][0] >= 0 && b[i][0] >= 0) {
        differences.push_back(std::hypot(a[i][0] - b[i][0], a[i][1] - b[i][1], a[i][2] - b[i][2]));
        difference += differences.back();
        ++both;
      }
      const std::size_t around[4] = {i - 1, i + 1, truth.index(x, y - 1), truth.index(x, y + 1)};
      bool inner = true;
      for (const std::size_t k : around)
        inner = inner && a[k][0] >= 0 && b[k][0] >= 0 &&
                std::abs(truth.depth[k] - truth.depth[i]) < .01 * truth.depth[i];
      if (!inner) continue;
      own += std::hypot(a[around[1]][0] - a[around[0]][0], a[around[3]][0] - a[around[2]][0]);
      other += std::hypot(b[around[1]][0] - b[around[0]][0], b[around[3]][0] - b[around[2]][0]);
      ++count;
    }
  }
  std::nth_element(differences.begin(),
                   differences.begin() + static_cast<std::ptrdiff_t>(differences.size() * 19 / 20),
                   differences.end());
  std::printf(
      "%s: %zu points, %d px, gradient %.2f of points, %.2f of surface: ratio %.3f; dE %.2f, p95 "
      "%.2f; fit %.3f s, colours %.3f s; frame %.3f s, paint %.3f s\n",
      path.c_str(), points.size(), size, own / count, other / count, other / own, difference / both,
      differences[differences.size() * 19 / 20], fit_seconds, fitted.color_seconds, drawn, painted);
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i + 1 < argc; i += 2)
    if (const Error error = measureScan(argv[i], 1000, argv[i + 1]))
      std::fprintf(stderr, "%s\n", error.message.c_str());
}

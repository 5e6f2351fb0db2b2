// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include "color/color_rows.h"
#include "color/texture_jpeg.h"
#include "pcl_slim/core/cielab.h"
#include "pcl_slim/core/stopwatch.h"
#include "pcl_slim/query/surface_probe.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/bounding_spheres.h"
#include "pcl_slim/render/image.h"
#include "pcl_slim/render/surface_renderer.h"
#include "pcl_slim/scan/scan.h"
#include "pcl_slim/surface/surface_io.h"
#include "splats/picture_quality.h"

namespace pcl_slim::measure {
namespace {

constexpr int kFirstSize = 1000;  ///< of the picture that shows how many pixels the points cover
constexpr int kColorError = 2;    ///< of rounded textures
constexpr float kStep = 0.01f;    ///< of the depth: pixels farther apart are of different parts

using Lab = std::array<float, 3>;

/** CIELAB of the pixels of a picture; L* below 0 where nothing is. */
std::vector<Lab> labOf(const GBuffer& buffer) {
  std::vector<Lab> lab(buffer.numPixels(), {-1.0f, 0.0f, 0.0f});
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    if (!buffer.covered(i)) continue;
    const auto& rgb = buffer.color[i];
    const auto value = labFromRgb({rgb[0], rgb[1], rgb[2]});
    for (std::size_t k = 0; k < 3; ++k) lab[i][k] = static_cast<float>(value[k]);
  }
  return lab;
}

Error save(const GBuffer& buffer, const std::string& path) {
  Image image{buffer.width, buffer.height, {}};
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    for (const float channel : buffer.color[i]) {
      const float shown = buffer.covered(i) ? channel : 1.0f;
      image.rgb.push_back(static_cast<std::uint8_t>(std::lround(255 * shown)));
    }
  }
  return saveImage(path, image);
}

/** How a picture differs from that of the points. */
struct Comparison {
  double sharpness = 0;   ///< mean gradient of L* over the points'
  double difference = 0;  ///< mean Delta E
};

Comparison compare(const GBuffer& points, const GBuffer& surface) {
  const auto a = labOf(points), b = labOf(surface);
  const auto gradient = [&](const std::vector<Lab>& lab, std::size_t i, std::size_t row) {
    return std::hypot(lab[i + 1][0] - lab[i - 1][0], lab[i + row][0] - lab[i - row][0]);
  };
  double own = 0, other = 0, sum = 0, both = 0;
  const auto row = static_cast<std::size_t>(points.width);
  for (int y = 1; y + 1 < points.height; ++y) {
    for (int x = 1; x + 1 < points.width; ++x) {
      const std::size_t i = points.index(x, y);
      if (a[i][0] < 0 || b[i][0] < 0) continue;
      sum += std::hypot(a[i][0] - b[i][0], a[i][1] - b[i][1], a[i][2] - b[i][2]);
      ++both;
      const std::size_t around[4] = {i - 1, i + 1, i - row, i + row};
      const bool inner = std::all_of(around, around + 4, [&](std::size_t k) {
        const float step = std::abs(points.depth[k] - points.depth[i]);
        return a[k][0] >= 0 && b[k][0] >= 0 && step < kStep * points.depth[i];
      });
      if (!inner) continue;
      own += gradient(a, i, row);
      other += gradient(b, i, row);
    }
  }
  return {other / own, sum / both};
}

/** The root mean square difference of the channels of two surfaces' textures, 0..255. */
double textureError(const SLIMSurface& exact, const SLIMSurface& rounded) {
  double sum = 0;
  for (std::size_t i = 0; i < exact.textures.size(); ++i) {
    const double difference = static_cast<double>(exact.textures[i]) - rounded.textures[i];
    sum += difference * difference;
  }
  return std::sqrt(sum / static_cast<double>(exact.textures.size()));
}

/** Bytes of a surface's textures. */
struct TextureBytes {
  double exact = 0, rounded = 0;  ///< in a .slim; rounded: with -color_error 2
  std::optional<double> jpeg;     ///< as a picture of the rounded ones' error
};

Error measureTextures(SLIMSurface surface, TextureBytes& bytes) {
  const auto exact = encodeSlim(surface), rounded = encodeSlim(surface, {0.0, kColorError});
  const Result<SLIMSurface> decoded = decodeSlim(rounded.data(), rounded.size());
  if (!decoded) return decoded.error();
  if (const auto jpeg = jpegBytes(surface, textureError(surface, *decoded))) {
    bytes.jpeg = static_cast<double>(*jpeg);
  }
  surface.dropTextures();
  const auto bare = static_cast<double>(encodeSlim(surface).size());
  bytes.exact = static_cast<double>(exact.size()) - bare;
  bytes.rounded = static_cast<double>(rounded.size()) - bare;
  return {};
}

/** Seconds of a frame, without colours and with them. */
struct FrameSeconds {
  double bare = 0, colored = 0;
};

/** Draws a surface in its colours. \param[out] seconds of second frames: the first builds indices */
Error draw(const SLIMSurface& surface, const Camera& camera, GBuffer& made, FrameSeconds& seconds) {
  SurfaceRenderer renderer(surface);
  RenderParams plain, colored;
  colored.columns |= kColorColumn;
  if (Error error = renderer.render(camera, colored, made)) return error;
  const Stopwatch first;
  if (Error error = renderer.render(camera, plain, made)) return error;
  seconds.bare = first.seconds();
  const Stopwatch second;
  if (Error error = renderer.render(camera, colored, made)) return error;
  seconds.colored = second.seconds();
  return {};
}

}  // namespace

Error printScan(const std::string& path, const std::string& pictures) {
  const Result<ColoredScan> scan = loadColoredScan(path);
  if (!scan) return scan.error();
  const Stopwatch watch;
  FittedScan fitted;
  if (Error error = fitScan({scan->file.view(false), scan->colors}, {}, fitted)) return error;
  const double fit_seconds = watch.seconds() - fitted.color_seconds;
  const SplatSet points = everyPoint(*scan);
  const BoundingSpheres object = spheresOf(points);
  const ViewDirection view = chooseView(object).direction;
  GBuffer truth, made;
  Camera camera = fitCamera(object, view, {kFirstSize, kFirstSize});
  if (Error error = renderDiscs(points, camera, {}, truth)) return error;
  const double pixels = static_cast<double>(truth.numCovered());
  const int size =
      static_cast<int>(kFirstSize * std::sqrt(static_cast<double>(points.size()) / pixels));
  camera = fitCamera(object, view, {size, size});
  if (Error error = renderDiscs(points, camera, {}, truth)) return error;

  FrameSeconds with, without;
  if (Error error = draw(fitted.surface, camera, made, with)) return error;
  const Comparison textured = compare(truth, made);
  if (!pictures.empty()) {
    if (Error error = save(made, pictures + "_textures.png")) return error;
    if (Error error = save(truth, pictures + "_points.png")) return error;
  }
  const TextureStatistics textures = fitted.surface.textureStatistics();
  TextureBytes bytes;
  if (Error error = measureTextures(fitted.surface, bytes)) return error;
  fitted.surface.dropTextures();
  if (Error error = draw(fitted.surface, camera, made, without)) return error;
  const Comparison plain = compare(truth, made);
  if (!pictures.empty()) {
    if (Error error = save(made, pictures + "_polynomials.png")) return error;
  }
  const auto count = static_cast<double>(points.size());
  char jpeg[32] = "–";
  if (bytes.jpeg) std::snprintf(jpeg, sizeof jpeg, "%.2f", *bytes.jpeg / count);
  std::printf(
      "| %s | %zu | %.2f → %.2f | %.2f → %.2f | %.1f | %.2f, %.2f, %s | %.3f + %.3f | %.0f + "
      "%.0f → %.0f |\n",
      path.substr(path.rfind('/') + 1).c_str(), points.size(), plain.sharpness, textured.sharpness,
      plain.difference, textured.difference, static_cast<double>(textures.texels) / count,
      bytes.exact / count, bytes.rounded / count, jpeg, fit_seconds, fitted.color_seconds,
      1e3 * with.bare, 1e3 * (without.colored - without.bare), 1e3 * (with.colored - with.bare));
  return {};
}

}  // namespace pcl_slim::measure

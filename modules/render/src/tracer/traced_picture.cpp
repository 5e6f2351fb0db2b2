// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/traced_picture.h"

#include <algorithm>
#include <cmath>

#include "camera/camera_rays.h"
#include "pcl_slim/core/parallel.h"
#include "shading/shading.h"

namespace pcl_slim {

using namespace detail;
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr Color kClay{0.80f, 0.74f, 0.66f};      ///< sRGB
constexpr Color kClayBack{0.52f, 0.56f, 0.64f};  ///< the inner side, where both are shown

/** \brief What shades the points of a frame. */
struct TracedRig {
  const GBuffer& buffer;
  const LightBuffer& light;
  const std::vector<RayLight>& lights;
  const ShadingParams& params;
  std::vector<Vector3> towards;
  Vector3 up;
  CameraRays rays;

  TracedRig(const GBuffer& b, const LightBuffer& l, const Camera& camera,
            const std::vector<RayLight>& all, const ShadingParams& p)
      : buffer(b), light(l), lights(all), params(p), rays(camera, {0.0, 0.0, 0.0}, 1.0) {
    for (const RayLight& one : lights) towards.push_back(normalized(one.towards));
    up = CameraAxes(camera).up;
  }

  Color base(std::size_t pixel) const {
    if (!buffer.color.empty()) {
      return params.mode == ShadingMode::kColor ? buffer.color[pixel] : kClay;
    }
    return buffer.back_face[pixel] ? kClayBack : kClay;
  }
  bool glossy() const { return params.mode != ShadingMode::kColor; }
};

/** \brief Diffuse and specular light of a pixel, a channel each. */
struct Received {
  Color diffuse, specular{};

  Received(const TracedRig& rig, std::size_t pixel, const Vector3& ray) {
    const auto& n = rig.buffer.normal[pixel];
    const Vector3 normal{n[0], n[1], n[2]};
    const double dim = 1.0 - rig.params.ambient_occlusion * (1.0 - rig.light.open[pixel]);
    const double sky = 0.20 * (0.75 + 0.25 * dot(normal, rig.up)) * dim;
    diffuse.fill(static_cast<float>(sky));
    for (std::size_t l = 0; l < rig.lights.size(); ++l) {
      const double visible = rig.light.visible[l * rig.buffer.numPixels() + pixel];
      const double cosine = dot(normal, rig.towards[l]);
      if (!(visible > 0.0 && cosine > 0.0)) continue;
      const Vector3 half = normalized(subtract(rig.towards[l], ray));
      const double gloss = 0.14 * std::pow(std::max(0.0, dot(normal, half)), 40.0);
      for (std::size_t k = 0; k < 3; ++k) {
        const double strength = visible * rig.lights[l].color[k];
        diffuse[k] += static_cast<float>(strength * cosine);
        if (rig.glossy()) specular[k] += static_cast<float>(strength * gloss);
      }
    }
  }
};

Color colorAt(const TracedRig& rig, int x, int y, const Color& empty) {
  const std::size_t pixel = rig.buffer.index(x, y);
  if (!rig.buffer.covered(pixel)) return empty;
  const Color base = toLinear(rig.base(pixel));
  const Received light(rig, pixel, rig.rays.ray(x, y).direction);
  Color color;
  for (std::size_t k = 0; k < 3; ++k) {
    color[k] = std::min(1.0f, base[k] * light.diffuse[k] + light.specular[k]);
  }
  return color;
}

Error checkMode(ShadingMode mode, bool colored) {
  if (mode == ShadingMode::kShaded || (mode == ShadingMode::kColor && colored)) return {};
  return {ErrorCode::kBadArgument, colored ? "what is traced is shaded or shows its colours"
                                           : "a traced surface without colours is shaded"};
}

void add(const std::vector<Color>& frame, std::vector<Color>& sums) {
  sums.resize(frame.size(), Color{0.0f, 0.0f, 0.0f});
  for (std::size_t i = 0; i < frame.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) sums[i][k] += frame[i][k];
  }
}

Image averaged(const std::vector<Color>& sums, const ImageSize& size, int frames) {
  Image image;
  image.width = size.width;
  image.height = size.height;
  image.rgb.reserve(3 * sums.size());
  for (const Color& sum : sums) {
    for (const float channel : sum) {
      image.rgb.push_back(toByte(channel / static_cast<float>(frames)));
    }
  }
  return image;
}

/** \brief The n x n frames of a picture one after the other, each of another sample. */
struct FrameSequence {
  const Camera& camera;
  const TraceParams& trace;
  int n;
  unsigned columns;

  Camera shifted(int pass) const {
    Camera moved = camera;
    moved.pixel_offset = {(pass % n + 0.5) / n - 0.5, (pass / n + 0.5) / n - 0.5};
    return moved;
  }
  TraceParams sampled(int pass) const {
    TraceParams params = trace;
    params.columns = columns;
    params.sample = trace.sample * static_cast<unsigned>(n * n) + static_cast<unsigned>(pass);
    if (params.lights.empty()) params.lights = defaultLights(camera);
    return params;
  }
};

}  // namespace

std::array<double, 3> lightDirection(const Camera& camera, double azimuth, double elevation) {
  const CameraAxes axes(camera);
  const double a = azimuth * kDegree, e = elevation * kDegree;
  const Vector3 level = along(scaled(axes.forward, -std::cos(e) * std::cos(a)),
                              std::cos(e) * std::sin(a), axes.right);
  return along(level, std::sin(e), axes.up);
}

std::vector<RayLight> defaultLights(const Camera& camera) {
  return {{lightDirection(camera, -48.0, 44.0), {0.86f, 0.82f, 0.76f}, 1.5},
          {lightDirection(camera, 52.0, 22.0), {0.24f, 0.27f, 0.32f}, 1.5}};
}

std::vector<Color> shadeTraced(const GBuffer& buffer, const LightBuffer& light,
                               const Camera& camera, const std::vector<RayLight>& lights,
                               const ShadingParams& params) {
  const TracedRig rig(buffer, light, camera, lights, params);
  std::vector<Color> colors(buffer.numPixels());
  parallelFor(static_cast<std::size_t>(buffer.height), resolveThreads(params.threads), 8,
              [&](std::size_t row, int) {
                const int y = static_cast<int>(row);
                const Color empty = backgroundAt(params, y, buffer.height);
                for (int x = 0; x < buffer.width; ++x) {
                  colors[buffer.index(x, y)] = colorAt(rig, x, y, empty);
                }
              });
  return colors;
}

Result<Image> renderTracedPicture(RayTracer& tracer, const Camera& camera,
                                  const TraceParams& trace_params,
                                  const ShadingParams& shading_params, TraceStatistics* statistics,
                                  Progress* progress) {
  if (Error error = shading_params.validate()) return error;
  if (Error error = checkMode(shading_params.mode, tracer.hasColors())) return error;
  const FrameSequence frames{camera, trace_params, shading_params.supersampling,
                             kPositionColumn | columnsFor(shading_params)};
  const int count = frames.n * frames.n;
  std::vector<Color> sums;
  GBuffer buffer;
  LightBuffer light;
  TraceStatistics total;
  for (int pass = 0; pass < count; ++pass) {
    const Camera shifted = frames.shifted(pass);
    const TraceParams params = frames.sampled(pass);
    TraceStatistics counts;
    if (Error error = tracer.trace(shifted, params, buffer, light, &counts, progress)) {
      return error;
    }
    total += counts;
    add(shadeTraced(buffer, light, shifted, params.lights, shading_params), sums);
  }
  if (statistics) *statistics = total;
  return averaged(sums, camera.size, count);
}

}  // namespace pcl_slim

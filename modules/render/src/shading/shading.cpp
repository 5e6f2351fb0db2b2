// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/shading.h"

#include <algorithm>
#include <cmath>

#include "camera/camera_rays.h"
#include "pcl_slim/core/parallel.h"
#include "shading/ambient_occlusion.h"
#include "shading/linear_light.h"

namespace pcl_slim {

using namespace detail;
namespace {

/** \brief Lights that move with the camera, directions towards the light, world axes. */
struct LightRig {
  Vector3 head, key, sky;
  CameraRays rays;

  explicit LightRig(const Camera& camera) : rays(camera, {0.0, 0.0, 0.0}, 1.0)
  {
    const CameraAxes axes(camera);
    head = scaled(axes.forward, -1.0);
    key = normalized(along(along(scaled(axes.right, -0.55), 0.75, axes.up), -0.65, axes.forward));
    sky = axes.up;
  }
};

constexpr Color kClay{0.80f, 0.74f, 0.66f};      ///< sRGB
constexpr Color kClayBack{0.52f, 0.56f, 0.64f};  ///< the inner side, where both are shown

/** \brief Diffuse and specular light a unit normal receives, viewed along a unit ray. */
struct Light {
  double diffuse, specular;

  Light(const LightRig& rig, const Vector3& normal, const Vector3& ray)
  {
    const Vector3 to_viewer = scaled(ray, -1.0);
    const Vector3 half = normalized(along(rig.key, 1.0, to_viewer));
    const double key = std::max(0.0, dot(normal, rig.key));
    const double head = std::max(0.0, dot(normal, to_viewer));
    diffuse = 0.10 + 0.12 * (0.5 + 0.5 * dot(normal, rig.sky)) + 0.28 * head + 0.62 * key;
    specular = 0.16 * std::pow(std::max(0.0, dot(normal, half)), 40.0) * (key > 0.0 ? 1.0 : 0.0);
  }
};

Color
baseColor(const GBuffer& buffer, std::size_t pixel, const ShadingParams& params,
          const ShadingRange& range)
{
  switch (params.mode) {
    case ShadingMode::kMean: return divergingColor(buffer.mean_curvature[pixel] / range.curvature);
    case ShadingMode::kLevel: return categoryColor(buffer.level[pixel]);
    case ShadingMode::kSize: {
      const double span = std::log(range.radius_max / range.radius_min);
      const double x = span > 0.0 ? std::log(buffer.radius[pixel] / range.radius_min) / span : 0.5;
      return sizeColor(x);
    }
    case ShadingMode::kColor: return buffer.color[pixel];
    default: return buffer.back_face[pixel] ? kClayBack : kClay;
  }
}

Color
normalColor(const std::array<float, 3>& n)
{
  return toLinear({0.5f * n[0] + 0.5f, 0.5f * n[1] + 0.5f, 0.5f * n[2] + 0.5f});
}

Color
background(const ShadingParams& params, int y, int height)
{
  if (!params.gradient_background) return {1.0f, 1.0f, 1.0f};
  const float t = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
  const float level = 0.985f - 0.145f * t * t;
  return toLinear({level, level, level + 0.006f});
}

/** \brief Light of one covered pixel. */
Color
litColor(const GBuffer& buffer, std::size_t pixel, int x, int y, const LightRig& rig,
         const ShadingParams& params, const ShadingRange& range, float open)
{
  const auto& n = buffer.normal[pixel];
  if (params.mode == ShadingMode::kNormal) return normalColor(n);
  const Color base = toLinear(baseColor(buffer, pixel, params, range));
  if (!params.lighting) return base;
  const Light light(rig, {n[0], n[1], n[2]}, rig.rays.ray(x, y).direction);
  const bool clay = params.mode == ShadingMode::kShaded;
  // Colour-coded pictures keep their colours legible: less contrast, no highlight.
  const double diffuse = clay ? light.diffuse : 0.45 + 0.55 * std::min(1.0, light.diffuse);
  const double specular = clay ? light.specular : 0.0;
  const double dim = 1.0 - params.ambient_occlusion * (1.0 - open);
  Color color;
  for (std::size_t k = 0; k < 3; ++k) {
    color[k] = static_cast<float>(std::min(1.0, (base[k] * diffuse + specular) * dim));
  }
  return color;
}

/** \brief The value below which a share of the (finite) values lies; 0 when there are none. */
double
quantile(std::vector<float>& values, double share)
{
  if (values.empty()) return 0.0;
  const auto k = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(k), values.end());
  return values[k];
}

}  // namespace

std::optional<ShadingMode>
shadingModeOf(const std::string& name)
{
  if (name == "shaded") return ShadingMode::kShaded;
  if (name == "normal") return ShadingMode::kNormal;
  if (name == "mean") return ShadingMode::kMean;
  if (name == "level") return ShadingMode::kLevel;
  if (name == "size") return ShadingMode::kSize;
  if (name == "color") return ShadingMode::kColor;
  return std::nullopt;
}

Error
ShadingParams::validate() const
{
  const auto bad = [](const char* what) { return Error{ErrorCode::kBadArgument, what}; };
  if (!(range >= 0.0 && std::isfinite(range))) return bad("the colour range must be 0 or more");
  if (!(percentile > 0.0 && percentile <= 1.0)) return bad("the percentile must be in (0, 1]");
  if (!(ambient_occlusion >= 0.0 && ambient_occlusion <= 1.0)) {
    return bad("the strength of ambient occlusion must be in [0, 1]");
  }
  if (supersampling < 1 || supersampling > 8) return bad("supersampling must be 1 to 8");
  return checkThreads(threads);
}

ShadingRange
rangeOf(const GBuffer& buffer, const ShadingParams& params, double scale)
{
  std::vector<float> curvature, radius;
  for (std::size_t i = 0; i < buffer.numPixels(); ++i) {
    if (!buffer.covered(i)) continue;
    curvature.push_back(std::abs(buffer.mean_curvature[i]));
    radius.push_back(buffer.radius[i]);
  }
  ShadingRange range;
  if (radius.empty()) return range;
  range.curvature =
      params.range > 0.0 ? params.range * scale : quantile(curvature, params.percentile);
  if (!(range.curvature > 0.0)) range.curvature = 1.0;
  range.radius_min = quantile(radius, 0.02);
  range.radius_max = quantile(radius, 0.98);
  return range;
}

std::vector<Color>
shadeLinear(const GBuffer& buffer, const Camera& camera, const ShadingParams& params,
            const ShadingRange& range)
{
  const int threads = resolveThreads(params.threads);
  const LightRig rig(camera);
  std::vector<float> open(buffer.numPixels(), 1.0f);
  if (params.ambient_occlusion > 0.0 && params.lighting && params.mode != ShadingMode::kNormal) {
    open = ambientOcclusion(buffer, threads);
  }
  std::vector<Color> colors(buffer.numPixels());
  parallelFor(static_cast<std::size_t>(buffer.height), threads, 8, [&](std::size_t row, int) {
    const int y = static_cast<int>(row);
    const Color empty = background(params, y, buffer.height);
    for (int x = 0; x < buffer.width; ++x) {
      const std::size_t i = buffer.index(x, y);
      colors[i] =
          buffer.covered(i) ? litColor(buffer, i, x, y, rig, params, range, open[i]) : empty;
    }
  });
  return colors;
}

}  // namespace pcl_slim

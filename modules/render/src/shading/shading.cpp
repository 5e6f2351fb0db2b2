// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/render/shading.h"

#include <algorithm>
#include <cmath>

#include "camera/camera_rays.h"
#include "pcl_slim/core/parallel.h"
#include "shading/ambient_occlusion.h"
#include "shading/linear_light.h"
#include "shading/value_range.h"

namespace pcl_slim {

using namespace detail;
namespace {

/** \brief Lights that move with the camera, directions towards the light, world axes. */
struct LightRig {
  Vector3 head, key, sky, right;
  CameraRays rays;

  explicit LightRig(const Camera& camera) : rays(camera, {0.0, 0.0, 0.0}, 1.0)
  {
    const CameraAxes axes(camera);
    head = scaled(axes.forward, -1.0);
    key = normalized(along(along(scaled(axes.right, -0.55), 0.75, axes.up), -0.65, axes.forward));
    sky = axes.up;
    right = axes.right;
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
          const ShadingRange& range, double scale)
{
  if (showsNumbers(params.mode)) {
    return colorOf(params, range, valueAt(buffer, pixel, params.mode, scale));
  }
  switch (params.mode) {
    case ShadingMode::kLevel: return categoryColor(buffer.level[pixel]);
    case ShadingMode::kColor: return buffer.color[pixel];
    default: return buffer.back_face[pixel] ? kClayBack : kClay;
  }
}

/** \brief Vertical stripes of light, far away all around the viewer, as the surface mirrors them. */
Color
mirroredStripes(const LightRig& rig, const Vector3& normal, const Vector3& ray)
{
  constexpr double kStripes = 12.0;  ///< phase per radian
  constexpr double kEdge = 0.15;     ///< of a stripe, by the sine of its phase
  constexpr Color kDark{0.08f, 0.09f, 0.12f};
  constexpr float kLight = 0.96f;
  const Vector3 mirrored = along(ray, -2.0 * dot(ray, normal), normal);
  const double phase = kStripes * std::asin(std::clamp(dot(mirrored, rig.right), -1.0, 1.0));
  const auto share = static_cast<float>(std::clamp(0.5 + std::sin(phase) / kEdge, 0.0, 1.0));
  Color color;
  for (std::size_t k = 0; k < 3; ++k) color[k] = kDark[k] + share * (kLight - kDark[k]);
  return toLinear(color);
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
         const ShadingParams& params, const ShadingRange& range, double scale, float open)
{
  const auto& n = buffer.normal[pixel];
  if (params.mode == ShadingMode::kNormal) return normalColor(n);
  const Vector3 normal{n[0], n[1], n[2]}, ray = rig.rays.ray(x, y).direction;
  if (params.mode == ShadingMode::kReflection) return mirroredStripes(rig, normal, ray);
  const Color base = toLinear(baseColor(buffer, pixel, params, range, scale));
  if (!params.lighting) return base;
  const Light light(rig, normal, ray);
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

}  // namespace

std::string
nameOf(ShadingMode mode)
{
  static const std::array<const char*, 11> kNames{"shaded", "normal",     "mean",  "gauss",
                                                  "kmax",   "kmin",       "level", "size",
                                                  "error",  "reflection", "color"};
  return kNames[static_cast<std::size_t>(mode)];
}

std::optional<ShadingMode>
shadingModeOf(const std::string& name)
{
  for (int k = 0; k <= static_cast<int>(ShadingMode::kColor); ++k) {
    if (nameOf(static_cast<ShadingMode>(k)) == name) return static_cast<ShadingMode>(k);
  }
  return std::nullopt;
}

Error
ShadingParams::validate() const
{
  const auto bad = [](const char* what) { return Error{ErrorCode::kBadArgument, what}; };
  if (!(std::isfinite(range[0]) && std::isfinite(range[1]) && range[0] <= range[1])) {
    return bad("the colour range must be two finite numbers, the lower one first");
  }
  if (mode == ShadingMode::kSize && range[0] < range[1] && !(range[0] > 0.0)) {
    return bad("the colour range of sizes must be positive: its colours are logarithmic");
  }
  if (!(percentile > 0.0 && percentile <= 1.0)) return bad("the percentile must be in (0, 1]");
  if (!(ambient_occlusion >= 0.0 && ambient_occlusion <= 1.0)) {
    return bad("the strength of ambient occlusion must be in [0, 1]");
  }
  if (!std::all_of(unit.begin(), unit.end(), [](char c) { return c >= 'a' && c <= 'z'; })) {
    return bad("the unit of length must be lower-case letters, such as mm");
  }
  if (supersampling < 1 || supersampling > 8) return bad("supersampling must be 1 to 8");
  return checkThreads(threads);
}

std::vector<Color>
shadeLinear(const GBuffer& buffer, const Camera& camera, const ShadingParams& params,
            const ShadingRange& range, double scale)
{
  const int threads = resolveThreads(params.threads);
  const LightRig rig(camera);
  std::vector<float> open(buffer.numPixels(), 1.0f);
  if (wantsAmbientOcclusion(params)) {
    open = ambientOcclusion(buffer, threads);
  }
  std::vector<Color> colors(buffer.numPixels());
  parallelFor(static_cast<std::size_t>(buffer.height), threads, 8, [&](std::size_t row, int) {
    const int y = static_cast<int>(row);
    const Color empty = background(params, y, buffer.height);
    for (int x = 0; x < buffer.width; ++x) {
      const std::size_t i = buffer.index(x, y);
      colors[i] =
          buffer.covered(i) ? litColor(buffer, i, x, y, rig, params, range, scale, open[i]) : empty;
    }
  });
  return colors;
}

}  // namespace pcl_slim

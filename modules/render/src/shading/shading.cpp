// SPDX-License-Identifier: BSD-3-Clause
// A frame's colours: of the surface itself, by light and shade; and pictures averaged over shifted
// frames.
#include "pcl_slim/render/shading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <string>
#include <vector>

#include "camera/camera_rays.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/render/detail/bar_text.h"
#include "pcl_slim/render/detail/light.h"
#include "pcl_slim/render/mesh_renderer.h"
#include "shading/shading.h"

namespace pcl_slim::detail {

namespace {

constexpr int kSide = 4;  ///< pixels a side of the blocks that are painted at a time
static_assert(kSide * kSide <= static_cast<int>(SurfaceProbe::kMost));

/** The covered pixels of one block. */
struct PixelBlock {
  std::array<Vector3, SurfaceProbe::kMost> places, sides;
  std::array<float, SurfaceProbe::kMost> widths{};  ///< of the pixels, local units
  std::array<std::size_t, SurfaceProbe::kMost> pixels;
  std::size_t count = 0;

  PixelBlock(const GBuffer& buffer, const CameraRays& rays, int x0, int y0) {
    for (int y = y0; y < std::min(buffer.height, y0 + kSide); ++y) {
      for (int x = x0; x < std::min(buffer.width, x0 + kSide); ++x) {
        const std::size_t pixel = buffer.index(x, y);
        if (!buffer.covered(pixel)) continue;
        const auto &p = buffer.position[pixel], &n = buffer.normal[pixel];
        // Normals of a surface that is seen from behind are turned to the viewer.
        const double sign = buffer.back_face[pixel] ? -1.0 : 1.0;
        places[count] = {p[0], p[1], p[2]};
        sides[count] = {sign * n[0], sign * n[1], sign * n[2]};
        widths[count] =
            static_cast<float>(rays.pixelAtEye() + rays.pixelPerDepth() * buffer.depth[pixel]);
        pixels[count++] = pixel;
      }
    }
  }
};

}  // namespace

void SurfacePainter::paint(const Camera& camera, int threads, GBuffer& buffer) {
  buffer.color.clear();
  if (!surface_.hasColors()) return;
  if (!index_) index_ = std::make_unique<ProbeIndex>(surface_);
  buffer.color.assign(buffer.numPixels(), {1.0f, 1.0f, 1.0f});
  std::deque<SurfaceProbe> probes;
  for (int t = 0; t < threads; ++t) probes.emplace_back(*index_);
  const CameraRays rays(camera, surface_.info.origin, surface_.info.scale);
  const auto rows = static_cast<std::size_t>((buffer.height + kSide - 1) / kSide);
  parallelFor(rows, threads, 1, [&](std::size_t row, int thread) {
    SurfaceProbe& probe = probes[static_cast<std::size_t>(thread)];
    std::array<std::array<float, 3>, SurfaceProbe::kMost> colors;
    for (int x = 0; x < buffer.width; x += kSide) {
      const PixelBlock block(buffer, rays, x, static_cast<int>(row) * kSide);
      if (block.count == 0) continue;
      probe.restart(0);  // no result depends on the blocks before
      probe.colors(block.places.data(), block.sides.data(), block.count, colors.data(),
                   block.widths.data());
      for (std::size_t i = 0; i < block.count; ++i) {
        for (std::size_t c = 0; c < 3 && colors[i][c] >= 0.0f; ++c)
          buffer.color[block.pixels[i]][c] = colors[i][c] / 255.0f;
      }
    }
  });
}

}  // namespace pcl_slim::detail

namespace pcl_slim {

using namespace detail;
namespace {

constexpr int kSamples = static_cast<int>(kHollowSamples);
constexpr int kPatterns = 16;  ///< rotations of the spiral, repeating in 4 x 4 pixels

struct Offset {
  int dx, dy;
};
using Spiral = std::array<Offset, kSamples>;

std::array<Spiral, kPatterns> makeSpirals(double reach) {
  std::array<Spiral, kPatterns> spirals;
  for (int p = 0; p < kPatterns; ++p) {
    // Steps of 7 spread neighbouring rotations over the 4 x 4 pattern.
    const double turn = 2.0 * M_PI * ((p * 7) % kPatterns) / kPatterns;
    for (int i = 0; i < kSamples; ++i) {
      const double distance = std::max(1.0, reach * std::sqrt((i + 0.5) / kSamples));
      const double angle = turn + kGoldenAngle * i;
      spirals[static_cast<std::size_t>(p)][static_cast<std::size_t>(i)] = {
          static_cast<int>(std::lround(distance * std::cos(angle))),
          static_cast<int>(std::lround(distance * std::sin(angle)))};
    }
  }
  return spirals;
}

/** \brief How much one neighbour hides: its elevation over the tangent plane, faded by distance. */
float hiddenBy(const GBuffer& buffer, std::size_t pixel, std::size_t other, float reach) {
  const auto &p = buffer.position[pixel], &q = buffer.position[other], &n = buffer.normal[pixel];
  const float d[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
  const float distance_sq = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  if (!(distance_sq > 0.0f)) return 0.0f;
  const float rise = (d[0] * n[0] + d[1] * n[1] + d[2] * n[2]) / std::sqrt(distance_sq);
  constexpr auto kLeast = static_cast<float>(kHollowRise);
  const float fade = std::max(0.0f, 1.0f - distance_sq / (4.0f * reach * reach));
  return std::max(0.0f, rise - kLeast) * fade;
}

/** \brief How open each covered pixel's surroundings are: 1 open, towards 0 in a hollow.
 *
 * Looks at neighbouring pixels on a fixed spiral up to a fixed share of the picture and measures
 * how far they rise over the pixel's tangent plane; those that are farther away than twice the
 * spiral's radius at the pixel's depth belong to other parts and have faded out. A depth cue, not a
 * light simulation. O(pixels).
 * \param[in] rays of the camera, in the buffer's units
 */
std::vector<float> ambientOcclusion(const GBuffer& buffer, const CameraRays& rays, int threads) {
  std::vector<float> open(buffer.numPixels(), 1.0f);
  const double reach_pixels = std::max(2.0, kHollowReach * std::min(buffer.width, buffer.height));
  const auto reach_at_eye = static_cast<float>(reach_pixels * rays.pixelAtEye());
  const auto reach_per_depth = static_cast<float>(reach_pixels * rays.pixelPerDepth());
  const auto spirals = makeSpirals(reach_pixels);
  parallelFor(static_cast<std::size_t>(buffer.height), threads, 8, [&](std::size_t row, int) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < buffer.width; ++x) {
      const std::size_t pixel = buffer.index(x, y);
      if (!buffer.covered(pixel)) continue;
      const float reach = reach_at_eye + reach_per_depth * buffer.depth[pixel];
      if (!(reach > 0.0f)) continue;
      float hidden = 0.0f;
      for (const Offset& offset : spirals[static_cast<std::size_t>((y & 3) * 4 + (x & 3))]) {
        const int nx = x + offset.dx, ny = y + offset.dy;
        if (nx < 0 || ny < 0 || nx >= buffer.width || ny >= buffer.height) continue;
        const std::size_t other = buffer.index(nx, ny);
        if (buffer.covered(other)) hidden += hiddenBy(buffer, pixel, other, reach);
      }
      open[pixel] = std::max(0.0f, 1.0f - static_cast<float>(kHollowStrength) * hidden / kSamples);
    }
  });
  return open;
}

/** \brief Lights that move with the camera, directions towards the light, world axes. */
struct LightRig {
  Vector3 head, key, sky, right;
  CameraRays rays;

  explicit LightRig(const Camera& camera) : rays(camera, {0.0, 0.0, 0.0}, 1.0) {
    const CameraAxes axes(camera);
    head = scaled(axes.forward, -1.0);
    key = normalized(along(along(scaled(axes.right, kKeyLight[0]), kKeyLight[1], axes.up),
                           kKeyLight[2], axes.forward));
    sky = axes.up;
    right = axes.right;
  }
};

Color asColor(const std::array<double, 3>& c) {
  return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
}

/** \brief Diffuse and specular light a unit normal receives, viewed along a unit ray. */
struct Light {
  double diffuse, specular;

  Light(const LightRig& rig, const Vector3& normal, const Vector3& ray) {
    const Vector3 to_viewer = scaled(ray, -1.0);
    const Vector3 half = normalized(along(rig.key, 1.0, to_viewer));
    const double key = std::max(0.0, dot(normal, rig.key));
    const double head = std::max(0.0, dot(normal, to_viewer));
    diffuse = kAmbientLight + kSkyLight * (0.5 + 0.5 * dot(normal, rig.sky)) + kHeadLight * head +
              kKeyStrength * key;
    specular = key > 0.0 ? kShine * std::pow(std::max(0.0, dot(normal, half)), kShinePower) : 0.0;
  }
};

/** Whether a mode shows the colours of what is drawn. */
bool isPainted(ShadingMode mode) {
  return mode == ShadingMode::kColor || mode == ShadingMode::kUncertainty;
}

Color baseColor(const GBuffer& buffer, std::size_t pixel, const ShadingParams& params,
                const ShadingRange& range, double scale) {
  if (isPainted(params.mode)) return buffer.color[pixel];
  if (showsNumbers(params.mode)) {
    return colorOf(params, range, valueAt(buffer, pixel, params.mode, scale));
  }
  switch (params.mode) {
    case ShadingMode::kLevel: return categoryColor(buffer.level[pixel]);
    default: return asColor(buffer.back_face[pixel] ? kClayBack : kClay);
  }
}

/** \brief Vertical stripes of light, far away all around the viewer, as the surface mirrors them.
 */
Color mirroredStripes(const LightRig& rig, const Vector3& normal, const Vector3& ray) {
  const Color dark = asColor(kStripeDark);
  constexpr auto kLight = static_cast<float>(kStripeLight);
  const Vector3 mirrored = along(ray, -2.0 * dot(ray, normal), normal);
  const double phase = kStripes * std::asin(std::clamp(dot(mirrored, rig.right), -1.0, 1.0));
  const auto share = static_cast<float>(std::clamp(0.5 + std::sin(phase) / kStripeEdge, 0.0, 1.0));
  Color color;
  for (std::size_t k = 0; k < 3; ++k) color[k] = dark[k] + share * (kLight - dark[k]);
  return toLinear(color);
}

Color normalColor(const std::array<float, 3>& n) {
  return toLinear({0.5f * n[0] + 0.5f, 0.5f * n[1] + 0.5f, 0.5f * n[2] + 0.5f});
}

/** \brief Light of one covered pixel. */
Color litColor(const GBuffer& buffer, std::size_t pixel, int x, int y, const LightRig& rig,
               const ShadingParams& params, const ShadingRange& range, double scale, float open) {
  const auto& n = buffer.normal[pixel];
  if (params.mode == ShadingMode::kNormal) return normalColor(n);
  const Vector3 normal{n[0], n[1], n[2]}, ray = rig.rays.ray(x, y).direction;
  if (params.mode == ShadingMode::kReflection) return mirroredStripes(rig, normal, ray);
  const Color base = toLinear(baseColor(buffer, pixel, params, range, scale));
  if (!params.lighting) return base;
  const Light light(rig, normal, ray);
  const bool clay = params.mode == ShadingMode::kShaded;
  // Colour-coded pictures keep their colours legible: less contrast, no highlight.
  const double diffuse =
      clay ? light.diffuse : kCodedAmbient + kCodedDiffuse * std::min(1.0, light.diffuse);
  const double specular = clay ? light.specular : 0.0;
  const double dim = 1.0 - params.ambient_occlusion * (1.0 - open);
  Color color;
  for (std::size_t k = 0; k < 3; ++k) {
    color[k] = static_cast<float>(std::min(1.0, (base[k] * diffuse + specular) * dim));
  }
  return color;
}

}  // namespace

std::string nameOf(ShadingMode mode) {
  static const std::array<const char*, 12> kNames{"shaded", "normal",     "mean",  "gauss",
                                                  "kmax",   "kmin",       "level", "size",
                                                  "error",  "reflection", "color", "uncertainty"};
  return kNames[static_cast<std::size_t>(mode)];
}

std::optional<ShadingMode> shadingModeOf(const std::string& name) {
  for (int k = 0; k <= static_cast<int>(ShadingMode::kUncertainty); ++k) {
    if (nameOf(static_cast<ShadingMode>(k)) == name) return static_cast<ShadingMode>(k);
  }
  return std::nullopt;
}

Error ShadingParams::validate() const {
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
  if (!isLengthUnit(unit)) {
    return bad("the unit of length must be up to eight letters, such as mm, µm or ft");
  }
  if (supersampling < 1 || supersampling > 8) return bad("supersampling must be 1 to 8");
  return checkThreads(threads);
}

std::vector<Color> shadeLinear(const GBuffer& buffer, const Camera& camera,
                               const ShadingParams& params, const ShadingRange& range,
                               double scale) {
  const int threads = resolveThreads(params.threads);
  const LightRig rig(camera);
  std::vector<float> open(buffer.numPixels(), 1.0f);
  if (wantsAmbientOcclusion(params)) {
    open = ambientOcclusion(buffer, CameraRays(camera, {0.0, 0.0, 0.0}, scale), threads);
  }
  std::vector<Color> colors(buffer.numPixels());
  parallelFor(static_cast<std::size_t>(buffer.height), threads, 8, [&](std::size_t row, int) {
    const int y = static_cast<int>(row);
    const Color empty = backgroundAt(params, y, buffer.height);
    for (int x = 0; x < buffer.width; ++x) {
      const std::size_t i = buffer.index(x, y);
      colors[i] =
          buffer.covered(i) ? litColor(buffer, i, x, y, rig, params, range, scale, open[i]) : empty;
    }
  });
  return colors;
}

namespace {

Image toImage(const std::vector<Color>& sums, const ImageSize& size, int samples, int threads) {
  Image image;
  image.width = size.width;
  image.height = size.height;
  image.rgb.resize(3 * sums.size());
  const float factor = 1.0f / static_cast<float>(samples);
  parallelFor(sums.size(), threads, 4096, [&](std::size_t i, int) {
    for (std::size_t k = 0; k < 3; ++k) image.rgb[3 * i + k] = toByte(sums[i][k] * factor);
  });
  return image;
}

/** \brief Renders supersampling^2 shifted frames and averages them.
 * \param[in] render Error(const Camera&, GBuffer&); \param[in] scale world units per local unit */
template <typename Render>
Result<Image> averageFrames(const Camera& camera, const ShadingParams& params, double scale,
                            const Render& render) {
  const int n = params.supersampling;
  std::vector<Color> sums;
  ShadingRange range;
  GBuffer buffer;
  for (int pass = 0; pass < n * n; ++pass) {
    Camera shifted = camera;
    shifted.pixel_offset = {(pass % n + 0.5) / n - 0.5, (pass / n + 0.5) / n - 0.5};
    if (Error error = render(shifted, buffer)) return error;
    if (pass == 0) range = rangeOf(buffer, params, scale);
    const auto colors = shadeLinear(buffer, shifted, params, range, scale);
    sums.resize(colors.size(), Color{0.0f, 0.0f, 0.0f});
    for (std::size_t i = 0; i < colors.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) sums[i][k] += colors[i][k];
    }
  }
  Image image = toImage(sums, camera.size, n * n, resolveThreads(params.threads));
  if (params.color_bar) addColorBar(params, range, image);
  return image;
}

Error noColors() {
  return {ErrorCode::kBadArgument,
          "the surface has no colours; fit a coloured scan, or choose another mode than color"};
}

/** \brief Names what a mode needs and a buffer was made without. */
Error lacksColumns(const GBuffer& buffer, const ShadingParams& params) {
  const unsigned needed = columnsFor(params);
  const std::size_t n = buffer.numPixels();
  const bool complete = ((needed & kPositionColumn) == 0 || buffer.position.size() == n) &&
                        ((needed & kCurvatureColumn) == 0 || buffer.principal.size() == n) &&
                        ((needed & kLeafColumns) == 0 || buffer.radius.size() == n) &&
                        ((needed & kResidualColumn) == 0 || buffer.residual.size() == n);
  if (complete) return {};
  return {ErrorCode::kBadArgument,
          "the G-buffer lacks a column that the mode shows; render it with columnsFor()"};
}

}  // namespace

Result<Image> shade(const GBuffer& buffer, const Camera& camera, const ShadingParams& params,
                    double scale) {
  if (Error error = params.validate()) return error;
  if (Error error = camera.validate()) return error;
  if (buffer.width != camera.size.width || buffer.height != camera.size.height) {
    return Error{
        ErrorCode::kBadArgument,
        "the G-buffer and the camera differ in size; shade with the camera it was made by"};
  }
  if (isPainted(params.mode) && buffer.color.size() != buffer.numPixels()) {
    return noColors();
  }
  if (Error error = lacksColumns(buffer, params)) return error;
  const ShadingRange range = rangeOf(buffer, params, scale);
  const auto colors = shadeLinear(buffer, camera, params, range, scale);
  Image image = toImage(colors, camera.size, 1, resolveThreads(params.threads));
  if (params.color_bar) addColorBar(params, range, image);
  return image;
}

Result<Image> renderPicture(SurfaceRenderer& renderer, const Camera& camera,
                            const RenderParams& render_params, const ShadingParams& shading_params,
                            RenderStatistics* statistics) {
  if (Error error = shading_params.validate()) return error;
  if (isPainted(shading_params.mode) && !renderer.surface().hasColors()) return noColors();
  RenderParams needed = render_params;
  needed.columns = columnsFor(shading_params);
  RenderStatistics total;
  auto image = averageFrames(camera, shading_params, renderer.surface().info.scale,
                             [&](const Camera& shifted, GBuffer& buffer) {
                               RenderStatistics counts;
                               Error error = renderer.render(shifted, needed, buffer, &counts);
                               total += counts;
                               return error;
                             });
  if (image && statistics) *statistics = total;
  return image;
}

Result<Image> renderPicture(const SLIMSurface& surface, const Camera& camera,
                            const RenderParams& render_params, const ShadingParams& shading_params,
                            RenderStatistics* statistics) {
  SurfaceRenderer renderer(surface, render_params.threads);
  return renderPicture(renderer, camera, render_params, shading_params, statistics);
}

Result<Image> renderPicture(const SplatSet& splats, const Camera& camera,
                            const DiscRenderParams& render_params,
                            const ShadingParams& shading_params, DiscRenderStatistics* statistics) {
  if (Error error = shading_params.validate()) return error;
  const unsigned of_leaves = kCurvatureColumn | kLeafColumns | kResidualColumn;
  if ((columnsFor(shading_params) & of_leaves) != 0 && shading_params.mode != ShadingMode::kSize) {
    return Error{
        ErrorCode::kBadArgument,
        "splats have no curvature, levels or residuals; choose color, shaded, normal, size "
        "or reflection"};
  }
  DiscRenderStatistics total;
  auto image =
      averageFrames(camera, shading_params, 1.0, [&](const Camera& shifted, GBuffer& buffer) {
        DiscRenderStatistics counts;
        Error error = renderDiscs(splats, shifted, render_params, buffer, &counts);
        total += counts;
        return error;
      });
  if (image && statistics) *statistics = total;
  return image;
}

Result<Image> renderPicture(const TriangleMesh& mesh, const Camera& camera,
                            const MeshRenderParams& render_params,
                            const ShadingParams& shading_params, MeshRenderStatistics* statistics) {
  if (Error error = shading_params.validate()) return error;
  const unsigned columns = columnsFor(shading_params);
  const bool curved = !mesh.k1.empty() && !mesh.k2.empty();
  if ((columns & (kLeafColumns | kResidualColumn)) != 0 ||
      ((columns & kCurvatureColumn) != 0 && !curved))
    return Error{ErrorCode::kBadArgument,
                 std::string("the mesh has no ") +
                     ((columns & kCurvatureColumn) != 0 ? "curvatures k1 and k2"
                                                        : "levels, sizes or residuals") +
                     "; choose color, shaded, normal or reflection, or draw the surface"};
  if (isPainted(shading_params.mode) && mesh.colors.empty())
    return Error{ErrorCode::kBadArgument,
                 "the mesh has no colours; choose another mode than color"};
  MeshRenderStatistics total;
  auto image =
      averageFrames(camera, shading_params, 1.0, [&](const Camera& shifted, GBuffer& buffer) {
        MeshRenderStatistics counts;
        Error error = renderMesh(mesh, shifted, render_params, columns, buffer, &counts);
        total += counts;
        return error;
      });
  if (image && statistics) *statistics = total;
  return image;
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/render/shading.h"
#include "shading/linear_light.h"

namespace pcl_slim {

using namespace detail;
namespace {

Image
toImage(const std::vector<Color>& sums, const ImageSize& size, int samples, int threads)
{
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
Result<Image>
averageFrames(const Camera& camera, const ShadingParams& params, double scale, const Render& render)
{
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

Error
noColors()
{
  return {ErrorCode::kBadArgument,
          "the surface has no colours; fit a coloured scan, or choose another mode than color"};
}

/** \brief Names what a mode needs and a buffer was made without. */
Error
lacksColumns(const GBuffer& buffer, const ShadingParams& params)
{
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

Result<Image>
shade(const GBuffer& buffer, const Camera& camera, const ShadingParams& params, double scale)
{
  if (Error error = params.validate()) return error;
  if (Error error = camera.validate()) return error;
  if (buffer.width != camera.size.width || buffer.height != camera.size.height) {
    return Error{
        ErrorCode::kBadArgument,
        "the G-buffer and the camera differ in size; shade with the camera it was made by"};
  }
  if (params.mode == ShadingMode::kColor && buffer.color.size() != buffer.numPixels()) {
    return noColors();
  }
  if (Error error = lacksColumns(buffer, params)) return error;
  const ShadingRange range = rangeOf(buffer, params, scale);
  const auto colors = shadeLinear(buffer, camera, params, range, scale);
  Image image = toImage(colors, camera.size, 1, resolveThreads(params.threads));
  if (params.color_bar) addColorBar(params, range, image);
  return image;
}

Result<Image>
renderPicture(SurfaceRenderer& renderer, const Camera& camera, const RenderParams& render_params,
              const ShadingParams& shading_params, RenderStatistics* statistics)
{
  if (Error error = shading_params.validate()) return error;
  if (shading_params.mode == ShadingMode::kColor && !renderer.surface().hasColors())
    return noColors();
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

Result<Image>
renderPicture(const SLIMSurface& surface, const Camera& camera, const RenderParams& render_params,
              const ShadingParams& shading_params, RenderStatistics* statistics)
{
  SurfaceRenderer renderer(surface, render_params.threads);
  return renderPicture(renderer, camera, render_params, shading_params, statistics);
}

Result<Image>
renderPicture(const SplatSet& splats, const Camera& camera, const DiscRenderParams& render_params,
              const ShadingParams& shading_params, DiscRenderStatistics* statistics)
{
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

}  // namespace pcl_slim

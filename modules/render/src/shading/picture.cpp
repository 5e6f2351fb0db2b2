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
    const auto colors = shadeLinear(buffer, shifted, params, range);
    sums.resize(colors.size(), Color{0.0f, 0.0f, 0.0f});
    for (std::size_t i = 0; i < colors.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) sums[i][k] += colors[i][k];
    }
  }
  return toImage(sums, camera.size, n * n, resolveThreads(params.threads));
}

Error
noColors()
{
  return {ErrorCode::kBadArgument, "a surface has no colours; choose another mode than color"};
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
  const auto colors = shadeLinear(buffer, camera, params, rangeOf(buffer, params, scale));
  return toImage(colors, camera.size, 1, resolveThreads(params.threads));
}

Result<Image>
renderPicture(const SLIMSurface& surface, const Camera& camera, const RenderParams& render_params,
              const ShadingParams& shading_params, RenderStatistics* statistics)
{
  if (Error error = shading_params.validate()) return error;
  if (shading_params.mode == ShadingMode::kColor) return noColors();
  RenderStatistics total;
  auto image = averageFrames(
      camera, shading_params, surface.info.scale, [&](const Camera& shifted, GBuffer& buffer) {
        RenderStatistics counts;
        Error error = renderSurface(surface, shifted, render_params, buffer, &counts);
        total += counts;
        return error;
      });
  if (image && statistics) *statistics = total;
  return image;
}

Result<Image>
renderPicture(const SplatSet& splats, const Camera& camera, const DiscRenderParams& render_params,
              const ShadingParams& shading_params, DiscRenderStatistics* statistics)
{
  if (Error error = shading_params.validate()) return error;
  if (shading_params.mode == ShadingMode::kMean || shading_params.mode == ShadingMode::kLevel) {
    return Error{ErrorCode::kBadArgument,
                 "splats have no curvature and no levels; choose color, shaded, normal or size"};
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

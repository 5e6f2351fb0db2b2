// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "linear_light.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/render/shading.h"

namespace pcl_slim {
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
  const auto colors = shadeLinear(buffer, camera, params, rangeOf(buffer, params, scale));
  return toImage(colors, camera.size, 1, resolveThreads(params.threads));
}

Result<Image>
renderPicture(const SLIMSurface& surface, const Camera& camera, const RenderParams& render_params,
              const ShadingParams& shading_params, RenderStatistics* statistics)
{
  if (Error error = shading_params.validate()) return error;
  const int n = shading_params.supersampling;
  const int threads = resolveThreads(shading_params.threads);
  std::vector<Color> sums;
  ShadingRange range;
  GBuffer buffer;
  RenderStatistics total;
  for (int pass = 0; pass < n * n; ++pass) {
    Camera shifted = camera;
    shifted.pixel_offset = {(pass % n + 0.5) / n - 0.5, (pass / n + 0.5) / n - 0.5};
    RenderStatistics counts;
    if (Error error = renderSurface(surface, shifted, render_params, buffer, &counts)) return error;
    total += counts;
    if (pass == 0) range = rangeOf(buffer, shading_params, surface.info.scale);
    const auto colors = shadeLinear(buffer, shifted, shading_params, range);
    sums.resize(colors.size(), Color{0.0f, 0.0f, 0.0f});
    for (std::size_t i = 0; i < colors.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) sums[i][k] += colors[i][k];
    }
  }
  if (statistics) *statistics = total;
  return toImage(sums, camera.size, n * n, threads);
}

}  // namespace pcl_slim

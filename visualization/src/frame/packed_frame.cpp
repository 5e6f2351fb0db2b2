// SPDX-License-Identifier: BSD-3-Clause
#include "frame/packed_frame.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {
namespace {

void
packPixel(const GBuffer& buffer, std::size_t pixel, float scale, PackedFrame& frame)
{
  float* geometry = frame.geometry.data() + 4 * pixel;
  float* attributes = frame.attributes.data() + 4 * pixel;
  if (!buffer.covered(pixel)) {
    for (int k = 0; k < 4; ++k) geometry[k] = attributes[k] = 0.0f;
    return;
  }
  const auto& n = buffer.normal[pixel];
  for (std::size_t k = 0; k < 3; ++k) geometry[k] = n[k];
  geometry[3] = buffer.depth[pixel] * scale * (buffer.back_face[pixel] ? -1.0f : 1.0f);
  attributes[0] = buffer.principal.empty() ? 0.0f : buffer.principal[pixel][0] / scale;
  attributes[1] = buffer.principal.empty() ? 0.0f : buffer.principal[pixel][1] / scale;
  attributes[2] = buffer.radius.empty() ? 0.0f : buffer.radius[pixel] * scale;
  const float residual = buffer.residual.empty() ? 0.0f : buffer.residual[pixel];
  attributes[3] = buffer.level.empty()
                      ? 0.0f
                      : levelAndResidual(buffer.level[pixel], residual, buffer.radius[pixel]);
}

}  // namespace

float
levelAndResidual(int level, float residual, float radius)
{
  const float share = radius > 0.0f ? std::clamp(residual / radius, 0.0f, 0.999f) : 0.0f;
  return static_cast<float>(level) + share;
}

void
packFrame(const GBuffer& buffer, double scale, int threads, PackedFrame& frame)
{
  const std::size_t pixels = buffer.numPixels();
  const bool colored = !buffer.color.empty();
  frame.geometry.resize(4 * pixels);
  frame.attributes.resize(4 * pixels);
  frame.colors.assign(colored ? 4 * pixels : 0, 255);
  parallelFor(pixels, threads, 16384, [&](std::size_t pixel, int) {
    packPixel(buffer, pixel, static_cast<float>(scale), frame);
    for (std::size_t k = 0; colored && k < 3; ++k) {
      frame.colors[4 * pixel + k] =
          static_cast<std::uint8_t>(std::lround(255.0f * buffer.color[pixel][k]));
    }
  });
}

}  // namespace pcl_slim::detail

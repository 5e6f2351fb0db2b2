// SPDX-License-Identifier: BSD-3-Clause
#include "render/frame_clock.h"

#include <algorithm>
#include <vector>

#include "common/report.h"

namespace pcl_slim {
namespace {

double
medianOf(std::vector<double> values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Result<FrameSeconds>
timeFrames(SurfaceRenderer& renderer, const Camera& camera, const RenderParams& params,
           const ShadingParams& shading, int repeat)
{
  RenderParams needed = params;
  needed.columns = columnsFor(shading);
  GBuffer buffer;
  std::vector<double> frames, shades;
  for (int i = 0; i <= repeat; ++i) {
    Camera moved = camera;
    moved.pixel_offset = {0.37 * (i % 3), 0.21 * (i % 5)};
    const Stopwatch frame;
    if (Error error = renderer.render(moved, needed, buffer)) return error;
    const double frame_seconds = frame.seconds();
    const Stopwatch shade_time;
    const auto image = shade(buffer, moved, shading, renderer.surface().info.scale);
    if (!image) return image.error();
    if (i == 0) continue;  // the first frame allocates its buffers
    frames.push_back(frame_seconds);
    shades.push_back(shade_time.seconds());
  }
  return FrameSeconds{medianOf(frames), medianOf(shades)};
}

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#include "tracer/gap_closer.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {
namespace {

constexpr int kReach = 8;         ///< pixels from a gap's rim inwards that one pass closes
constexpr int kLeastCovered = 6;  ///< of the eight directions from a pixel in a gap

/** Whether most directions from a pixel soon lead to one that met something. */
bool
isEnclosed(const GBuffer& buffer, int x, int y)
{
  int covered = 0, looked = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (dx == 0 && dy == 0) continue;
      bool met = false;
      for (int k = 1; k <= kReach && !met; ++k) {
        const int px = x + k * dx, py = y + k * dy;
        if (px < 0 || py < 0 || px >= buffer.width || py >= buffer.height) break;
        met = buffer.covered(buffer.index(px, py));
      }
      covered += met ? 1 : 0;
      if (++looked - covered > 8 - kLeastCovered) return false;
    }
  }
  return true;
}

using Rows = std::vector<std::vector<int>>;  ///< columns of pixels, row by row

/** Pixels not tried yet that met nothing within what did; they count as tried from now on. */
Rows
enclosedPixels(const GBuffer& buffer, int threads, std::vector<std::uint8_t>& tried)
{
  Rows rows(static_cast<std::size_t>(buffer.height));
  parallelFor(rows.size(), threads, 16, [&](std::size_t y, int) {
    for (int x = 0; x < buffer.width; ++x) {
      const int row = static_cast<int>(y);
      const std::size_t pixel = buffer.index(x, row);
      if (tried[pixel] || buffer.covered(pixel) || !isEnclosed(buffer, x, row)) continue;
      tried[pixel] = 1;
      rows[y].push_back(x);
    }
  });
  return rows;
}

}  // namespace

std::uint64_t
GapCloser::close(const Camera& camera, const RenderParams& params, int threads, GBuffer& buffer)
{
  const CameraRays rays(camera, surface_.info.origin, surface_.info.scale);
  TraceParams tracing;
  tracing.sides = params.sides;
  tracing.columns = params.columns;
  const TraceView view{tracing, &rays};
  std::vector<std::uint8_t> tried(buffer.numPixels(), 0);
  std::uint64_t all = 0;
  for (;;) {  // from the rims of wide gaps inwards
    const Rows rows = enclosedPixels(buffer, threads, tried);
    if (std::all_of(rows.begin(), rows.end(), [](const auto& row) { return row.empty(); })) break;
    if (!leaves_) leaves_ = tracedLeaves(surface_, threads);
    std::atomic<std::uint64_t> filled{0};
    parallelFor(rows.size(), threads, 4, [&](std::size_t y, int) {
      std::vector<BoundedRay> bounded;
      std::vector<std::size_t> pixels;
      for (const int x : rows[y]) {
        bounded.emplace_back();
        bounded.back().ray = rays.ray(x, static_cast<int>(y));
        bounded.back().nearest = params.near_plane / surface_.info.scale;
        pixels.push_back(buffer.index(x, static_cast<int>(y)));
      }
      std::vector<MetPoint> met(bounded.size());
      RayCounts counts;
      leaves_->trace(view, bounded.data(), bounded.size(), met.data(), &buffer, pixels.data(),
                     counts);
      filled += static_cast<std::uint64_t>(
          std::count_if(met.begin(), met.end(), [](const MetPoint& p) { return p.met(); }));
    });
    if (filled == 0) break;
    all += filled;
  }
  return all;
}

}  // namespace pcl_slim::detail

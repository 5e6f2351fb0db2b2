// SPDX-License-Identifier: BSD-3-Clause
#include "tracer/gap_closer.h"

#include <algorithm>
#include <atomic>
#include <vector>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {
namespace {

constexpr int kReach = 8;         ///< pixels between a gap's middle and its rim
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

/** Pixels that met nothing within what did, row by row. */
std::vector<std::vector<int>>
enclosedPixels(const GBuffer& buffer, int threads)
{
  std::vector<std::vector<int>> rows(static_cast<std::size_t>(buffer.height));
  parallelFor(rows.size(), threads, 16, [&](std::size_t y, int) {
    for (int x = 0; x < buffer.width; ++x) {
      const int row = static_cast<int>(y);
      if (!buffer.covered(buffer.index(x, row)) && isEnclosed(buffer, x, row)) rows[y].push_back(x);
    }
  });
  return rows;
}

}  // namespace

std::uint64_t
GapCloser::close(const Camera& camera, const RenderParams& params, int threads, GBuffer& buffer)
{
  const auto rows = enclosedPixels(buffer, threads);
  if (std::all_of(rows.begin(), rows.end(), [](const auto& row) { return row.empty(); })) return 0;
  if (!leaves_) leaves_ = tracedLeaves(surface_, threads);
  const CameraRays rays(camera, surface_.info.origin, surface_.info.scale);
  TraceParams tracing;
  tracing.sides = params.sides;
  tracing.columns = params.columns;
  const TraceView view{tracing, &rays};
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
  return filled;
}

}  // namespace pcl_slim::detail

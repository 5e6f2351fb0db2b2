// SPDX-License-Identifier: BSD-3-Clause
#include "reference/tile_passes.h"

#include <algorithm>
#include <limits>

namespace pcl_slim::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/** \brief Largest first depth of the pending pixels: the rays' far ends until each has one. */
double
farthestFirst(const Tile& tile)
{
  double depth = 0.0;
  for (int y = tile.pending.y0; y <= tile.pending.y1; ++y) {
    for (int x = tile.pending.x0; x <= tile.pending.x1; ++x) {
      const std::size_t pixel = tile.index(x, y);
      if (tile.is_pending[pixel]) depth = std::max(depth, tile.first_depth[pixel]);
    }
  }
  return depth;
}

}  // namespace

void
Tile::begin(const FrameContext& frame, const ImageSize& size, std::size_t t)
{
  const auto columns = static_cast<std::size_t>(frame.bins.columns);
  x0 = static_cast<int>(t % columns) * kTileSize;
  y0 = static_cast<int>(t / columns) * kTileSize;
  width = std::min(kTileSize, size.width - x0);
  height = std::min(kTileSize, size.height - y0);
  rays.resize(kTileSize * kTileSize);
  nearest.assign(kTileSize * kTileSize, frame.rules.near_plane);
  farthest.assign(kTileSize * kTileSize, kInfinity);
  is_pending.assign(kTileSize * kTileSize, 1);
  sums.assign(kTileSize * kTileSize, BlendSum());
  pending = {x0, y0, x0 + width - 1, y0 + height - 1};
  for (int y = y0; y < y0 + height; ++y) {
    for (int x = x0; x < x0 + width; ++x) {
      const Ray ray = rays[index(x, y)] = frame.rays.ray(x, y);
      const RayStretch seen = within(frame.rules.cuts, ray, {frame.rules.near_plane, kInfinity});
      nearest[index(x, y)] = seen.near;
      farthest[index(x, y)] = seen.far;
    }
  }
  first_depth = farthest;
}

PixelRect
Tile::clip(const PixelRect& rect) const
{
  return {std::max(rect.x0, pending.x0), std::max(rect.y0, pending.y0),
          std::min(rect.x1, pending.x1), std::min(rect.y1, pending.y1)};
}

void
findFirstIntersections(const FrameContext& frame, std::size_t t, Tile& tile,
                       RenderStatistics& statistics)
{
  constexpr std::uint64_t kLookEvery = 16;  // entries between looks at the whole tile's depth
  const SurfelBins& bins = frame.bins;
  for (std::uint64_t e = bins.begin[t]; e < bins.begin[t + 1]; ++e) {
    const VisibleLeaf& leaf = bins.leaves[bins.entries[e]];
    if (frame.rules.skip && (e - bins.begin[t]) % kLookEvery == 0 &&
        leaf.nearest > farthestFirst(tile)) {
      statistics.occluded_entries += bins.begin[t + 1] - e;
      return;  // entries are sorted: every later one is as far
    }
    const PixelRect rect = tile.clip(leaf.first);
    if (rect.empty()) continue;
    const RaySurfel surfel(frame.surface, leaf.surfel);
    for (int y = rect.y0; y <= rect.y1; ++y) {
      for (int x = rect.x0; x <= rect.x1; ++x) {
        const std::size_t pixel = tile.index(x, y);
        double& first = tile.first_depth[pixel];
        if (!tile.is_pending[pixel] || leaf.nearest > first) continue;
        first = std::min(first, firstRoot(frame.rules, surfel, tile.rays[pixel],
                                          tile.nearest[pixel], first, statistics.rays_first));
      }
    }
  }
}

void
gatherBlends(const FrameContext& frame, std::size_t t, Tile& tile, RenderStatistics& statistics)
{
  const SurfelBins& bins = frame.bins;
  double last = 0.0;
  for (std::size_t i = 0; i < tile.first_depth.size(); ++i) {
    if (tile.first_depth[i] < tile.farthest[i]) last = std::max(last, tile.first_depth[i]);
  }
  for (std::uint64_t e = bins.begin[t]; e < bins.begin[t + 1]; ++e) {
    const VisibleLeaf& leaf = bins.leaves[bins.entries[e]];
    if (frame.rules.skip && leaf.nearest > last) return;
    const PixelRect rect = tile.clip(leaf.blend);
    if (rect.empty()) continue;
    const RaySurfel surfel(frame.surface, leaf.surfel);
    for (int y = rect.y0; y <= rect.y1; ++y) {
      for (int x = rect.x0; x <= rect.x1; ++x) {
        const std::size_t pixel = tile.index(x, y);
        const double first = tile.first_depth[pixel];
        if (!tile.is_pending[pixel] || !(first < tile.farthest[pixel])) continue;
        blendLeaf(frame.rules, frame.surface.info.blend_kernel, surfel, leaf.surfel,
                  tile.rays[pixel], first, tile.sums[pixel], statistics.rays_blend);
      }
    }
  }
}

bool
peelUncovered(const FrameContext& frame, Tile& tile)
{
  // Nothing well covered is within a leaf's reach of an uncovered q^, or it would have been
  // blended: a step of a share of its radius passes over the other leaves of the same flap.
  PixelRect left;
  left.x0 = left.y0 = std::numeric_limits<int>::max();
  for (int y = tile.pending.y0; y <= tile.pending.y1; ++y) {
    for (int x = tile.pending.x0; x <= tile.pending.x1; ++x) {
      const std::size_t pixel = tile.index(x, y);
      if (!tile.is_pending[pixel]) continue;
      BlendSum& sum = tile.sums[pixel];
      const bool met = sum.surfel != GBuffer::kNothing;
      if (!met || isSupported(sum, frame.rules.min_coverage)) {
        tile.is_pending[pixel] = 0;
        continue;
      }
      tile.nearest[pixel] = tile.first_depth[pixel] + kPeelStep * frame.surface.radius[sum.surfel];
      tile.first_depth[pixel] = tile.farthest[pixel];
      sum = BlendSum();
      left = {std::min(left.x0, x), std::min(left.y0, y), std::max(left.x1, x),
              std::max(left.y1, y)};
    }
  }
  tile.pending = left;
  return !left.empty();
}

}  // namespace pcl_slim::detail

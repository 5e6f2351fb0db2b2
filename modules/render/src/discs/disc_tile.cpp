// SPDX-License-Identifier: BSD-3-Clause
#include "discs/disc_tile.h"

#include <algorithm>

namespace pcl_slim::detail {

PixelRect
DiscTile::clip(const PixelRect& rect) const
{
  return {std::max(rect.x0, x0_), std::max(rect.y0, y0_), std::min(rect.x1, x0_ + width_ - 1),
          std::min(rect.y1, y0_ + height_ - 1)};
}

void
DiscTile::begin(const DiscFrame& frame, const ImageSize& size, std::size_t t)
{
  tile_ = t;
  x0_ = static_cast<int>(t) % frame.bins.columns * kTileSize;
  y0_ = static_cast<int>(t) / frame.bins.columns * kTileSize;
  width_ = std::min(kTileSize, size.width - x0_);
  height_ = std::min(kTileSize, size.height - y0_);
  constexpr std::size_t kPixels = std::size_t{kTileSize} * kTileSize;
  rays_.resize(kPixels);
  first_.assign(kPixels, FirstDisc());
  sums_.assign(kPixels, DiscSum());
  for (int y = y0_; y < y0_ + height_; ++y) {
    for (int x = x0_; x < x0_ + width_; ++x) rays_[index(x, y)] = frame.rays.ray(x, y);
  }
}

/** \brief Runs body(leaf, disc, pixel) for every disc of the tile and every pixel it may cover. */
template <typename Body>
void
DiscTile::forEachPixel(const DiscFrame& frame, const Body& body) const
{
  for (std::uint64_t e = frame.bins.begin[tile_]; e < frame.bins.begin[tile_ + 1]; ++e) {
    const VisibleLeaf& leaf = frame.bins.leaves[frame.bins.entries[e]];
    const Disc disc(frame, leaf.surfel);
    const PixelRect rect = clip(leaf.blend);
    for (int y = rect.y0; y <= rect.y1; ++y) {
      for (int x = rect.x0; x <= rect.x1; ++x) {
        body(leaf, disc, index(x, y));
      }
    }
  }
}

void
DiscTile::findFirst(const DiscFrame& frame, DiscRenderStatistics& statistics)
{
  forEachPixel(frame, [&](const VisibleLeaf& leaf, const Disc& disc, std::size_t pixel) {
    FirstDisc& first = first_[pixel];
    if (frame.params.skip && leaf.nearest > first.depth) return;
    ++statistics.rays_first;
    DiscHit hit;
    if (!intersect(frame, rays_[pixel], disc, hit) || hit.depth >= first.depth) return;
    first = {hit.depth, hit.cosine, disc.radius, leaf.surfel};
  });
}

void
DiscTile::blend(const DiscFrame& frame, DiscRenderStatistics& statistics)
{
  forEachPixel(frame, [&](const VisibleLeaf& leaf, const Disc& disc, std::size_t pixel) {
    const FirstDisc& first = first_[pixel];
    if (first.disc == GBuffer::kNothing) return;
    if (!frame.params.filtered && first.disc != leaf.surfel) return;
    if (frame.params.skip && !countsBehind(frame, first, disc, leaf.nearest, 0.0)) return;
    ++statistics.rays_blend;
    DiscHit hit;
    if (!intersect(frame, rays_[pixel], disc, hit)) return;
    if (!countsBehind(frame, first, disc, hit.depth, hit.cosine)) return;
    ++statistics.blended;
    addDisc(frame, hit, disc, leaf.surfel, sums_[pixel]);
  });
}

void
DiscTile::resolve(const DiscFrame& frame, GBuffer& buffer, DiscRenderStatistics& statistics) const
{
  for (int y = y0_; y < y0_ + height_; ++y) {
    for (int x = x0_; x < x0_ + width_; ++x) {
      const std::size_t pixel = index(x, y);
      if (!(sums_[pixel].weight > 0.0)) continue;
      writeDiscs(frame, rays_[pixel], first_[pixel], sums_[pixel], buffer.index(x, y), buffer);
      ++statistics.covered_pixels;
    }
  }
}

}  // namespace pcl_slim::detail

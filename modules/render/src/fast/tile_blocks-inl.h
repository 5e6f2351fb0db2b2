// SPDX-License-Identifier: BSD-3-Clause
// A tile's leaves by blocks of pixels. The guard toggles: Highway compiles a kernel file once per
// instruction set.
#if defined(PCL_SLIM_TILE_BLOCKS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_TILE_BLOCKS_INL
#undef PCL_SLIM_TILE_BLOCKS_INL
#else
#define PCL_SLIM_TILE_BLOCKS_INL
#endif

#include <algorithm>

#include "fast/frame_scene.h"
#include "fast/leaf_rays-inl.h"
#include "tiles/surfel_bins.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kBlockWidth = 4;
constexpr int kBlockColumns = kTileSize / kBlockWidth;

inline int
blockHeight()
{
  return static_cast<int>(hn::Lanes(Tag())) / kBlockWidth;
}

/** One tile: its corner, and its leaves in its coordinates, listed by block. */
class TileBlocks {
 public:
  TileBlocks(const FrameScene& scene, std::size_t t, TileScratch& scratch)
      : scene_(scene), scratch_(scratch)
  {
    const auto columns = static_cast<std::size_t>(scene.tiles.columns);
    x0 = static_cast<int>(t % columns) * kTileSize;
    y0 = static_cast<int>(t / columns) * kTileSize;
    width = std::min(kTileSize, scene.view.width - x0);
    height = std::min(kTileSize, scene.view.height - y0);
    rows = kTileSize / blockHeight();
    placeLeaves(t);
    std::fill_n(scratch_.counts, kBlockColumns * rows, 0u);
    stride_ = scratch_.leaves.size();
    const std::size_t needed = stride_ * static_cast<std::size_t>(kBlockColumns * rows);
    if (scratch_.lists.size() < needed) scratch_.lists.resize(needed);
    for (std::size_t i = 0; i < stride_; ++i) listLeaf(static_cast<std::uint32_t>(i));
  }

  const std::uint32_t* list(int block) const
  {
    return scratch_.lists.data() + stride_ * static_cast<std::size_t>(block);
  }
  std::uint32_t count(int block) const { return scratch_.counts[block]; }
  const TileLeaf& leaf(std::uint32_t entry) const { return scratch_.leaves[entry >> 1]; }

  int x0, y0, width, height, rows;
  float depth = 0.0f;  ///< D of the tile, from which depths here are counted

 private:
  void placeLeaves(std::size_t t)
  {
    const FrameTiles& tiles = scene_.tiles;
    const bool perspective = scene_.view.perspective;
    scratch_.leaves.clear();
    float middle = 0.0f;  // z of the tile
    for (std::uint32_t e = tiles.begin[t]; e < tiles.begin[t + 1]; ++e) {
      const FrameLeaf& leaf = scene_.leaf(tiles.entries[e]);
      if (middle == 0.0f && leaf.degree != kNearLeaf) {
        middle = leaf.depth;
        depth = perspective ? -1.0f / middle : middle;
      }
      TileLeaf placed;
      placed.leaf = &leaf;
      placed.x = (static_cast<float>(x0) - leaf.x) * leaf.per_pixel;
      placed.y = (leaf.y - static_cast<float>(y0)) * leaf.per_pixel;
      // z_c / r (1 - z_c / z) at the tile's z: no difference of large numbers.
      const float behind = (middle - leaf.depth) * leaf.inverse_radius;
      placed.sigma = perspective ? behind * (leaf.depth / middle) : behind;
      placed.nearest = leaf.nearest - depth;
      scratch_.leaves.push_back(placed);
    }
  }

  /** Puts a leaf on the lists of the blocks that the picture of its ball touches. */
  void listLeaf(std::uint32_t place)
  {
    const FrameLeaf& leaf = *scratch_.leaves[place].leaf;
    const float high = static_cast<float>(blockHeight());
    const float bx = leaf.blend_x - static_cast<float>(x0),
                by = leaf.blend_y - static_cast<float>(y0);
    const float fx = leaf.first_x - static_cast<float>(x0),
                fy = leaf.first_y - static_cast<float>(y0);
    const auto clamped = [](float value, int last) {
      return static_cast<int>(std::clamp(value, -1.0f, static_cast<float>(last + 1)));
    };
    // A block's pixels stand at 0 ... 3 from its corner.
    const int column0 = std::max(0, clamped((bx - leaf.blend_reach - 3.0f) / kBlockWidth, 7));
    const int column1 =
        std::min(kBlockColumns - 1, clamped((bx + leaf.blend_reach) / kBlockWidth, 7));
    const int row0 = std::max(0, clamped((by - leaf.blend_reach - high + 1.0f) / high, rows - 1));
    const int row1 = std::min(rows - 1, clamped((by + leaf.blend_reach) / high, rows - 1));
    const float blend_sq = leaf.blend_reach * leaf.blend_reach;
    const float first_sq = leaf.first_reach * leaf.first_reach;
    const auto gapSq = [](float from, float extent) {
      const float outside = std::max(std::max(-from, from - extent), 0.0f);
      return outside * outside;
    };
    for (int row = row0; row <= row1; ++row) {
      const float top = static_cast<float>(row) * high;
      const float blend_dy = gapSq(by - top, high - 1.0f), first_dy = gapSq(fy - top, high - 1.0f);
      for (int column = column0; column <= column1; ++column) {
        const float left = static_cast<float>(column * kBlockWidth);
        if (!(gapSq(bx - left, kBlockWidth - 1.0f) + blend_dy <= blend_sq)) continue;
        const bool first = gapSq(fx - left, kBlockWidth - 1.0f) + first_dy <= first_sq;
        const int block = row * kBlockColumns + column;
        scratch_.lists[stride_ * static_cast<std::size_t>(block) + scratch_.counts[block]++] =
            place << 1 | static_cast<std::uint32_t>(first);
      }
    }
  }

  const FrameScene& scene_;
  TileScratch& scratch_;
  std::size_t stride_ = 0;
};

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

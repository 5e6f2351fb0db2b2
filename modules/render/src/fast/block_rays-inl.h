// SPDX-License-Identifier: BSD-3-Clause
// Rays of a block of pixels, or of isolated pixels, as lanes. The guard toggles: Highway compiles
// a kernel file once per instruction set.
#if defined(PCL_SLIM_BLOCK_RAYS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_BLOCK_RAYS_INL
#undef PCL_SLIM_BLOCK_RAYS_INL
#else
#define PCL_SLIM_BLOCK_RAYS_INL
#endif

#include "fast/block_passes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes {

/** Bounds a block's rays to their parts inside the frame's half spaces. */
HWY_NOINLINE void
cut(const PassContext& context, Block& block)
{
  const double x = firstLane(block.slope_x), y = firstLane(block.slope_y);
  const Vec from_x = block.slope_x - set(firstLane(block.slope_x));
  const Vec from_y = block.slope_y - set(firstLane(block.slope_y));
  for (const FrameCut& half : context.scene.cuts) {
    const double first =
        half.by_x * x + half.by_y * y + half.rest + half.gain * double{context.tile.depth};
    const Vec inside =
        MulAdd(set(static_cast<float>(half.by_x)), from_x,
               MulAdd(set(static_cast<float>(half.by_y)), from_y, set(static_cast<float>(first))));
    if (half.gain == 0.0) {
      block.pending = And(block.pending, inside >= set(0.0f));
      continue;
    }
    const Vec bound = inside * set(static_cast<float>(-1.0 / half.gain));
    if (half.gain > 0.0)
      block.nearest = Max(block.nearest, bound);
    else
      block.farthest = Min(block.farthest, bound);
  }
  block.pending = And(block.pending, block.nearest < block.farthest);
}

/** The rays of some pixels, counted from the tile's corner. */
HWY_INLINE Block
raysAt(const PassContext& context, const float* dx, const float* dy, const PixelBox& box)
{
  const FrameView& view = context.scene.view;
  const TileBlocks& tile = context.tile;
  Block block;
  block.box = box;
  block.dx = load(dx);
  block.dy = load(dy);
  const Vec pixel = set(view.pixel);
  const Vec from_x = set(static_cast<float>(tile.x0) - view.center_x);
  const Vec from_y = set(view.center_y - static_cast<float>(tile.y0));
  block.slope_x = pixel * (block.dx + from_x);
  block.slope_y = pixel * (from_y - block.dy);
  block.slant = set(1.0f);
  block.direction_x = block.direction_y = set(0.0f);
  const auto near = static_cast<float>(context.scene.rules.near_plane);
  block.near_plane = set(near - tile.depth);
  if (view.perspective) {
    const Vec flat_sq = MulAdd(block.slope_x, block.slope_x, set(1.0f));
    block.slant = Sqrt(MulAdd(block.slope_y, block.slope_y, flat_sq));
    block.direction_x = block.slope_x;
    block.direction_y = block.slope_y;
    block.near_plane = set(-kInfinite);
    if (near > 0.0f) {
      block.near_plane = block.slant * set(-1.0f / near) - set(tile.depth);
    }
  }
  block.nearest = block.near_plane;
  block.farthest = set(kInfinite);
  block.z = set(1.0f);
  block.pending = And(block.dx < set(static_cast<float>(tile.width)),
                      block.dy < set(static_cast<float>(tile.height)));
  if (!context.scene.cuts.empty()) cut(context, block);
  block.first = block.farthest;
  return block;
}

/** The rays of a block whose upper left pixel is at (x, y) of a tile. */
HWY_INLINE Block
blockAt(const PassContext& context, int x, int y)
{
  HWY_ALIGN float dx[16], dy[16];
  for (int i = 0; i < kLanes; ++i) {
    const int column = i % kBlockWidth, row = i / kBlockWidth;
    dx[i] = static_cast<float>(x + column);
    dy[i] = static_cast<float>(y + row);
  }
  return raysAt(context, dx, dy, TileBlocks::boxAt(x, y, kBlockWidth, kBlockHeight));
}

/** Up to a block's number of rays that continue behind their hits. */
HWY_NOINLINE Block
packOf(const PassContext& context, const UncoveredRay* rays, std::size_t count)
{
  HWY_ALIGN float dx[16], dy[16], nearest[16];
  float x0 = rays[0].x, x1 = x0, y0 = rays[0].y, y1 = y0;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const UncoveredRay& ray = rays[std::min(i, count - 1)];
    dx[i] = ray.x;
    dy[i] = ray.y;
    nearest[i] = i < count ? ray.nearest : kInfinite;
    x0 = std::min(x0, ray.x);
    x1 = std::max(x1, ray.x);
    y0 = std::min(y0, ray.y);
    y1 = std::max(y1, ray.y);
  }
  Block block = raysAt(context, dx, dy, {x0, y0, x1 - x0, y1 - y0});
  block.nearest = Max(block.nearest, load(nearest));
  block.pending = And(block.pending, block.nearest < block.farthest);
  return block;
}

/** A ball around q^ of all pending lanes. */
HWY_INLINE Ball
ballAround(const PassContext& context, const Block& block)
{
  const FrameView& view = context.scene.view;
  const TileBlocks& tile = context.tile;
  const Vec z = view.perspective ? block.z : block.first + set(tile.depth);
  const Vec nowhere = set(kInfinite);
  const float near = smallest(IfThenElse(block.pending, z, nowhere));
  const float far = -smallest(IfThenElse(block.pending, Neg(z), nowhere));
  const float middle = 0.5f * (near + far);
  const float pixel = view.pixel * (view.perspective ? far : 1.0f);
  const PixelBox& box = block.box;
  const float x = box.x + 0.5f * box.width + static_cast<float>(tile.x0);
  const float y = box.y + 0.5f * box.height + static_cast<float>(tile.y0);
  const float sx = (x - view.center_x) * view.pixel, sy = (view.center_y - y) * view.pixel;
  const float aside = 0.5f * std::sqrt(box.width * box.width + box.height * box.height) * pixel;
  if (!view.perspective) return {sx, sy, middle, 1.01f * (aside + 0.5f * (far - near))};
  const float slant = std::sqrt(1.0f + sx * sx + sy * sy);
  return {sx * middle, sy * middle, middle, 1.01f * (aside + 0.5f * (far - near) * slant)};
}

/** Notes the rays of some lanes, which continue behind their q^. */
HWY_NOINLINE void
noteUncovered(const PassContext& context, Mask uncovered, const BlockSums& sums, const Block& block)
{
  const TileBlocks& tile = context.tile;
  HWY_ALIGN std::uint32_t surfel[16] = {};
  HWY_ALIGN float step[16], wanted[16], x[16], y[16], nearest[16];
  store(sums.surfel, surfel);
  store(IfThenElseZero(uncovered, set(1.0f)), wanted);
  for (int i = 0; i < kLanes; ++i) {
    step[i] = wanted[i] > 0.0f
                  ? static_cast<float>(kPeelStep) * context.scene.surface.radius[surfel[i]]
                  : 0.0f;
  }
  const Vec forward = load(step) / block.slant;
  Vec behind = block.first + forward;
  if (context.scene.view.perspective) {
    behind = set(-1.0f) / (block.z + forward) - set(tile.depth);
  }
  store(behind, nearest);
  store(block.dx, x);
  store(block.dy, y);
  for (int i = 0; i < kLanes; ++i) {
    if (wanted[i] > 0.0f) context.tile.uncovered().push_back({x[i], y[i], nearest[i]});
  }
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes
HWY_AFTER_NAMESPACE();
#endif

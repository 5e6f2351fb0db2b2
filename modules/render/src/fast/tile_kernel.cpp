// SPDX-License-Identifier: BSD-3-Clause
// Draws one tile, block by block of pixels, a ray a lane.
#include "fast/tile_kernel.h"

// Processors without AVX2 are old enough to take the plain code; every set costs half a minute to compile.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SSE4)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fast/tile_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "fast/blend_pass-inl.h"
#include "fast/block_output-inl.h"
#include "fast/block_passes-inl.h"
#include "fast/tile_blocks-inl.h"
#include "tiles/clear_pixels.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {
namespace lanes {

constexpr int kMaxLayers = 8;        ///< how often a ray may pass through uncovered flaps
constexpr float kLayerStep = 0.05f;  ///< of a leaf's radius, as the reference steps

/** Bounds a block's rays to what the frame's half spaces leave of them. */
HWY_NOINLINE void
cut(const PassContext& context, Block& block)
{
  const double x = firstLane(block.slope_x), y = firstLane(block.slope_y);
  const Vec from_x = Sub(block.slope_x, set(firstLane(block.slope_x)));
  const Vec from_y = Sub(block.slope_y, set(firstLane(block.slope_y)));
  for (const FrameCut& half : context.scene.cuts) {
    const double first =
        half.by_x * x + half.by_y * y + half.rest + half.gain * double{context.tile.depth};
    const Vec inside =
        MulAdd(set(static_cast<float>(half.by_x)), from_x,
               MulAdd(set(static_cast<float>(half.by_y)), from_y, set(static_cast<float>(first))));
    if (half.gain == 0.0) {
      block.pending = And(block.pending, Ge(inside, set(0.0f)));
      continue;
    }
    const Vec bound = Mul(inside, set(static_cast<float>(-1.0 / half.gain)));
    if (half.gain > 0.0)
      block.nearest = Max(block.nearest, bound);
    else
      block.farthest = Min(block.farthest, bound);
  }
  block.pending = And(block.pending, Lt(block.nearest, block.farthest));
}

/** The rays of a block whose upper left pixel stands at (x, y) of a tile. */
Block
blockAt(const PassContext& context, int x, int y)
{
  const FrameView& view = context.scene.view;
  const TileBlocks& tile = context.tile;
  HWY_ALIGN float dx[16], dy[16];
  for (int i = 0; i < kLanes; ++i) {
    const int row = i / kBlockWidth;
    dx[i] = static_cast<float>(x + i % kBlockWidth);
    dy[i] = static_cast<float>(y + row);
  }
  Block block;
  block.dx = load(dx);
  block.dy = load(dy);
  const Vec pixel = set(view.pixel);
  const Vec from_x = set(static_cast<float>(tile.x0) - view.center_x);
  const Vec from_y = set(view.center_y - static_cast<float>(tile.y0));
  block.slope_x = Mul(pixel, Add(block.dx, from_x));
  block.slope_y = Mul(pixel, Sub(from_y, block.dy));
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
      block.near_plane = Sub(Mul(block.slant, set(-1.0f / near)), set(tile.depth));
    }
  }
  block.nearest = block.near_plane;
  block.farthest = set(kInfinite);
  block.z = set(1.0f);
  block.pending = And(Lt(block.dx, set(static_cast<float>(tile.width))),
                      Lt(block.dy, set(static_cast<float>(tile.height))));
  if (!context.scene.cuts.empty()) cut(context, block);
  block.first = block.farthest;
  return block;
}

/** Lanes as a leaf too near for a record is drawn in double. */
NearLanes
nearLanes(const PassContext& context, const Block& block)
{
  NearLanes lanes;
  store(Add(block.dx, set(static_cast<float>(context.tile.x0))), lanes.x);
  store(Add(block.dy, set(static_cast<float>(context.tile.y0))), lanes.y);
  store(block.nearest, lanes.nearest);
  store(block.first, lanes.first);
  store(IfThenElseZero(block.pending, set(1.0f)), lanes.live);
  lanes.tile_depth = context.tile.depth;
  lanes.count = kLanes;
  return lanes;
}

HWY_NOINLINE void
firstOfNear(const PassContext& context, const FrameLeaf& leaf, Block& block)
{
  NearLanes lanes = nearLanes(context, block);
  firstOfNearLeaf(context.scene, leaf.surfel, lanes);
  block.first = load(lanes.first);
}

HWY_NOINLINE void
blendNear(const PassContext& context, const FrameLeaf& leaf, const Block& block, BlockSums& sums)
{
  NearLanes lanes = nearLanes(context, block);
  blendNearLeaf(context.scene, leaf.surfel, lanes);
  const Vec weight = load(lanes.weight);
  const Mask counts = Gt(weight, set(0.0f));
  const auto add = [&](Vec& sum, const float* column)
                       HWY_ATTR { sum = Add(sum, IfThenElseZero(counts, load(column))); };
  add(sums.weight, lanes.weight);
  add(sums.shift, lanes.shift);
  add(sums.coverage, lanes.coverage);
  add(sums.outside, lanes.outside);
  add(sums.facing, lanes.facing);
  for (int a = 0; a < 3; ++a) {
    add(sums.gradient[a], lanes.gradient[a]);
    add(sums.lean[a], lanes.lean[a]);
  }
  for (int k = 0; k < 6; ++k) add(sums.hessian[k], lanes.hessian[k]);
  sums.leaves = Add(sums.leaves, IfThenElseZero(counts, set(1.0f)));
  const Mask better = Gt(weight, sums.best);
  sums.best = Max(sums.best, IfThenElseZero(counts, weight));
  sums.surfel = IfThenElse(better, setUint(leaf.surfel), sums.surfel);
}

/** Whether any lane may still meet, or has met, something at this depth or beyond. */
HWY_INLINE bool
reaches(const Block& block, float nearest)
{
  return !AllFalse(And(block.pending, Ge(block.first, set(nearest))));
}

/** Pass 1: the first intersection of each ray with a leaf inside its shrunk ball. */
void
findFirst(const PassContext& context, int x, int y, Block& block)
{
  const bool skip = context.scene.rules.skip;
  const std::size_t count = context.tile.listFirst(x, y);
  std::size_t n = 0;
  for (; n < count; ++n) {
    const TileLeaf& at = context.tile.listed(n);
    if (skip && !reaches(block, at.nearest)) break;
    switch (at.leaf->degree) {
      case kNearLeaf: firstOfNear(context, *at.leaf, block); break;
      case 2: firstOfQuadratic(context, at, block); break;
      case 3: firstOfHigher<3>(context, at, block); break;
      default: firstOfHigher<4>(context, at, block); break;
    }
  }
  context.statistics.rays_first += n * kLanes;
  context.statistics.occluded_entries += count - n;
}

/** A ball around q^ of all pending lanes. */
Ball
ballAround(const PassContext& context, const Block& block)
{
  const FrameView& view = context.scene.view;
  const Vec z = view.perspective ? block.z : Add(block.first, set(context.tile.depth));
  const Vec nowhere = set(kInfinite);
  const float near = smallest(IfThenElse(block.pending, z, nowhere));
  const float far = -smallest(IfThenElse(block.pending, Neg(z), nowhere));
  const float middle = 0.5f * (near + far);
  const float wide = kBlockWidth - 1.0f, high = static_cast<float>(kBlockHeight - 1);
  const float pixel = view.pixel * (view.perspective ? far : 1.0f);
  // Lane 0 is the upper left one.
  const float sx = firstLane(block.slope_x) + 0.5f * wide * view.pixel;
  const float sy = firstLane(block.slope_y) - 0.5f * high * view.pixel;
  const float aside = 0.5f * std::sqrt(wide * wide + high * high) * pixel;
  if (!view.perspective) return {sx, sy, middle, 1.01f * (aside + 0.5f * (far - near))};
  const float slant = std::sqrt(1.0f + sx * sx + sy * sy);
  return {sx * middle, sy * middle, middle, 1.01f * (aside + 0.5f * (far - near) * slant)};
}

/** Pass 2: sums over the leaves whose ball holds q^. */
template <bool WithLean>
void
gather(const PassContext& context, const Ball& around, const Block& block, BlockSums& sums)
{
  const std::size_t count = context.tile.listBlend(around);
  sums.clear();
  for (std::size_t n = 0; n < count; ++n) {
    const TileLeaf& at = context.tile.listed(n);
    switch (at.leaf->degree) {
      case kNearLeaf: blendNear(context, *at.leaf, block, sums); break;
      case 2: blendLeaf<2, WithLean>(context, at, block, sums); break;
      case 3: blendLeaf<3, WithLean>(context, at, block, sums); break;
      default: blendLeaf<4, WithLean>(context, at, block, sums); break;
    }
  }
  context.statistics.rays_blend += count * kLanes;
}

/** Lanes whose blend belongs to no surface: neither covered, nor in a gap between leaves all
 * around. */
HWY_NOINLINE Mask
unsupported(const PassContext& context, Block block, Mask doubtful)
{
  constexpr float kMinLeaves = 3.0f, kMaxLean = 0.25f;  // as isSupported()
  block.pending = doubtful;
  BlockSums sums;
  gather<true>(context, ballAround(context, block), block, sums);
  const Vec* l = sums.lean;
  const Vec allowed = Mul(set(kMaxLean), sums.weight);
  const Mask surrounded = And(Ge(sums.leaves, set(kMinLeaves)),
                              Lt(dot3(l[0], l[1], l[2], l[0], l[1], l[2]), Mul(allowed, allowed)));
  return AndNot(surrounded, And(doubtful, Gt(sums.weight, set(0.0f))));
}

/** Sends uncovered lanes back to pass 1, to look behind their q^. */
HWY_NOINLINE void
lookBehind(const PassContext& context, Mask uncovered, const BlockSums& sums, Block& block)
{
  HWY_ALIGN std::uint32_t surfel[16] = {};
  HWY_ALIGN float step[16], bits[16];
  store(sums.surfel, surfel);
  store(IfThenElseZero(uncovered, set(1.0f)), bits);
  for (int i = 0; i < kLanes; ++i) {
    step[i] = bits[i] > 0.0f ? kLayerStep * context.scene.surface.radius[surfel[i]] : 0.0f;
  }
  const Vec forward = Div(load(step), block.slant);
  Vec nearest = Add(block.first, forward);
  if (context.scene.view.perspective) {
    const Vec z = Add(block.z, forward);
    nearest = Sub(Div(set(-1.0f), z), set(context.tile.depth));
  }
  block.nearest = IfThenElse(uncovered, nearest, block.nearest);
  block.first = block.farthest;
  block.pending = uncovered;
}

/** Keeps the sums of some lanes. */
void
keep(Mask settled, const BlockSums& sums, const Block& block, BlockSums& kept, Vec& kept_first)
{
  const auto take = [&](Vec& target, Vec value)
                        HWY_ATTR { target = IfThenElse(settled, value, target); };
  take(kept.weight, sums.weight);
  take(kept.shift, sums.shift);
  take(kept.coverage, sums.coverage);
  take(kept.facing, sums.facing);
  for (int a = 0; a < 3; ++a) take(kept.gradient[a], sums.gradient[a]);
  for (int k = 0; k < 6; ++k) take(kept.hessian[k], sums.hessian[k]);
  take(kept_first, block.first);
  kept.surfel = IfThenElse(settled, sums.surfel, kept.surfel);
}

/** z of q^, and lanes that have one alone. */
HWY_INLINE void
prepareBlend(const PassContext& context, Block& block)
{
  const Mask met = And(block.pending, Lt(block.first, block.farthest));
  block.pending = met;
  block.first = IfThenElseZero(met, block.first);
  if (context.scene.view.perspective) {
    block.z = Div(set(-1.0f), Add(block.first, set(context.tile.depth)));
  }
}

/** Draws the block whose upper left pixel stands at (x, y) of its tile. */
void
drawBlock(const PassContext& context, const BlockOutput& output)
{
  Block block = blockAt(context, output.x, output.y);
  const auto min_coverage = static_cast<float>(context.scene.rules.min_coverage);
  BlockSums kept, sums;
  kept.clear();
  Vec kept_first = set(0.0f);
  for (int layer = 0; layer < kMaxLayers; ++layer) {
    findFirst(context, output.x, output.y, block);
    prepareBlend(context, block);
    if (AllFalse(block.pending)) break;
    const Ball around = ballAround(context, block);
    gather<false>(context, around, block, sums);
    const Mask met = Gt(sums.weight, set(0.0f));
    const Mask outside = Gt(sums.outside, Mul(set(0.5f), sums.weight));
    Mask uncovered = AndNot(outside, And(met, Lt(sums.coverage, set(min_coverage))));
    if (!AllFalse(uncovered)) uncovered = unsupported(context, block, uncovered);
    uncovered = Or(uncovered, outside);
    const bool last = AllFalse(uncovered);
    if (last && layer == 0) return output.write(block, sums, block.first);
    keep(AndNot(uncovered, met), sums, block, kept, kept_first);
    if (last) break;
    lookBehind(context, uncovered, sums, block);
  }
  output.write(block, kept, kept_first);
}

void
drawPatch(const PassContext& context, int px, int py, GBuffer& buffer)
{
  const TileBlocks& tile = context.tile;
  for (int y = py; y < std::min(py + kPatchSize, tile.height); y += kBlockHeight) {
    for (int x = px; x < std::min(px + kPatchSize, tile.width); x += kBlockWidth) {
      drawBlock(context, {context.scene, tile, x, y, buffer, context.statistics});
    }
  }
}

/** Marks the pixels of a row of patches from x0 to before x1 as met by nothing. */
void
clearPatches(const TileBlocks& tile, int x0, int x1, int py, GBuffer& buffer)
{
  x1 = std::min(x1, tile.width);
  for (int y = py; y < std::min(py + kPatchSize, tile.height) && x0 < x1; ++y) {
    clearPixels(buffer, buffer.index(tile.x0 + x0, tile.y0 + y), static_cast<std::size_t>(x1 - x0));
  }
}

}  // namespace lanes

void
drawTile(const FrameScene& scene, std::size_t t, TileScratch& scratch, GBuffer& buffer,
         RenderStatistics& statistics)
{
  TileBlocks tile(scene, t, scratch);
  const lanes::PassContext context(scene, tile, statistics);
  for (int py = 0; py < tile.height; py += kPatchSize) {
    int empty = 0;  // patches from here on are to be cleared
    for (int px = 0; px < tile.width; px += kPatchSize) {
      if (!tile.beginPatch(px, py)) continue;
      lanes::clearPatches(tile, empty, px, py, buffer);
      lanes::drawPatch(context, px, py, buffer);
      empty = px + kPatchSize;
    }
    lanes::clearPatches(tile, empty, tile.width, py, buffer);
  }
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(drawTile);

void
drawTile(const FrameScene& scene, std::size_t t, TileScratch& scratch, GBuffer& buffer,
         RenderStatistics& statistics)
{
  HWY_DYNAMIC_DISPATCH(drawTile)(scene, t, scratch, buffer, statistics);
}

}  // namespace pcl_slim::detail::kernels
#endif

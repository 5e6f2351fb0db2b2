// SPDX-License-Identifier: BSD-3-Clause
// Draws one tile, block by block of pixels, a ray a lane.
#include "fast/tile_kernel.h"

// These would do no better than the next lower instruction set, and each costs a minute to compile.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SSE4 | HWY_AVX3)

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fast/tile_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "fast/blend_pass-inl.h"
#include "fast/block_output-inl.h"
#include "fast/block_passes-inl.h"
#include "fast/tile_blocks-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kMaxLayers = 8;        ///< how often a ray may pass through uncovered flaps
constexpr float kLayerStep = 0.05f;  ///< of a leaf's radius, as the reference steps

/** The rays of a block whose upper left pixel stands at (x, y) of a tile. */
Block
blockAt(const PassContext& context, int x, int y)
{
  const Tag d;
  const FrameView& view = context.scene.view;
  const TileBlocks& tile = context.tile;
  HWY_ALIGN float dx[16], dy[16];
  for (int i = 0; i < static_cast<int>(hn::Lanes(d)); ++i) {
    dx[i] = static_cast<float>(x + i % kBlockWidth);
    dy[i] = static_cast<float>(y + i / kBlockWidth);
  }
  Block block;
  block.dx = hn::Load(d, dx);
  block.dy = hn::Load(d, dy);
  const Vec pixel = set(view.pixel);
  const Vec from_x = set(static_cast<float>(tile.x0) - view.center_x);
  const Vec from_y = set(view.center_y - static_cast<float>(tile.y0));
  block.slope_x = hn::Mul(pixel, hn::Add(block.dx, from_x));
  block.slope_y = hn::Mul(pixel, hn::Sub(from_y, block.dy));
  block.slant = set(1.0f);
  block.direction_x = block.direction_y = hn::Zero(d);
  const auto near = static_cast<float>(context.scene.rules.near_plane);
  block.near_plane = set(near - tile.depth);
  if (view.perspective) {
    const Vec flat_sq = hn::MulAdd(block.slope_x, block.slope_x, set(1.0f));
    block.slant = hn::Sqrt(hn::MulAdd(block.slope_y, block.slope_y, flat_sq));
    block.direction_x = block.slope_x;
    block.direction_y = block.slope_y;
    block.near_plane = set(-kInfinite);
    if (near > 0.0f) {
      block.near_plane = hn::Sub(hn::Mul(block.slant, set(-1.0f / near)), set(tile.depth));
    }
  }
  block.nearest = block.near_plane;
  block.first = set(kInfinite);
  block.z = set(1.0f);
  block.pending = hn::And(hn::Lt(block.dx, set(static_cast<float>(tile.width))),
                          hn::Lt(block.dy, set(static_cast<float>(tile.height))));
  return block;
}

/** Lanes as a leaf too near for a record is drawn in double. */
NearLanes
nearLanes(const PassContext& context, const Block& block)
{
  const Tag d;
  NearLanes lanes;
  hn::Store(hn::Add(block.dx, set(static_cast<float>(context.tile.x0))), d, lanes.x);
  hn::Store(hn::Add(block.dy, set(static_cast<float>(context.tile.y0))), d, lanes.y);
  hn::Store(block.nearest, d, lanes.nearest);
  hn::Store(block.first, d, lanes.first);
  hn::Store(hn::IfThenElseZero(block.pending, set(1.0f)), d, lanes.live);
  lanes.tile_depth = context.tile.depth;
  lanes.count = hn::Lanes(d);
  return lanes;
}

HWY_NOINLINE void
firstOfNear(const PassContext& context, const FrameLeaf& leaf, Block& block)
{
  NearLanes lanes = nearLanes(context, block);
  firstOfNearLeaf(context.scene, leaf.surfel, lanes);
  block.first = hn::Load(Tag(), lanes.first);
}

HWY_NOINLINE void
blendNear(const PassContext& context, const FrameLeaf& leaf, const Block& block, BlockSums& sums)
{
  const Tag d;
  NearLanes lanes = nearLanes(context, block);
  blendNearLeaf(context.scene, leaf.surfel, lanes);
  const Vec weight = hn::Load(d, lanes.weight);
  const Mask counts = hn::Gt(weight, hn::Zero(d));
  const auto add = [&](Vec& sum, const float* column) HWY_ATTR {
    sum = hn::Add(sum, hn::IfThenElseZero(counts, hn::Load(d, column)));
  };
  add(sums.weight, lanes.weight);
  add(sums.shift, lanes.shift);
  add(sums.coverage, lanes.coverage);
  add(sums.facing, lanes.facing);
  for (int a = 0; a < 3; ++a) {
    add(sums.gradient[a], lanes.gradient[a]);
    add(sums.lean[a], lanes.lean[a]);
  }
  for (int k = 0; k < 6; ++k) add(sums.hessian[k], lanes.hessian[k]);
  sums.leaves = hn::Add(sums.leaves, hn::IfThenElseZero(counts, set(1.0f)));
  const Mask better = hn::Gt(weight, sums.best);
  sums.best = hn::Max(sums.best, hn::IfThenElseZero(counts, weight));
  sums.surfel = hn::IfThenElse(hn::RebindMask(UintTag(), better), hn::Set(UintTag(), leaf.surfel),
                               sums.surfel);
}

/** Whether any lane may still meet, or has met, something at this depth or beyond. */
HWY_INLINE bool
reaches(const Block& block, float nearest)
{
  return !hn::AllFalse(Tag(), hn::And(block.pending, hn::Ge(block.first, set(nearest))));
}

/** Pass 1: the first intersection of each ray with a leaf inside its shrunk ball. */
void
findFirst(const PassContext& context, int x, int y, Block& block)
{
  const bool skip = context.scene.rules.skip;
  std::uint32_t looked = 0;
  context.tile.forEachFirst(x, y, [&](const TileLeaf& at) HWY_ATTR {
    if (skip && !reaches(block, at.nearest)) return false;
    ++looked;
    switch (at.leaf->degree) {
      case kNearLeaf: firstOfNear(context, *at.leaf, block); break;
      case 2: firstOfQuadratic(context, at, block); break;
      case 3: firstOfHigher<3>(context, at, block); break;
      default: firstOfHigher<4>(context, at, block); break;
    }
    return true;
  });
  context.statistics.rays_first += looked * hn::Lanes(Tag());
}

/** A ball around q^ of all pending lanes. */
Ball
ballAround(const PassContext& context, const Block& block)
{
  const Tag d;
  const FrameView& view = context.scene.view;
  const Vec z = view.perspective ? block.z : hn::Add(block.first, set(context.tile.depth));
  const auto smallest = [&](Vec v) HWY_ATTR {
    return hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(block.pending, v, set(kInfinite))));
  };
  const float near = smallest(z), far = -smallest(hn::Neg(z)), middle = 0.5f * (near + far);
  const float wide = kBlockWidth - 1.0f, high = static_cast<float>(blockHeight() - 1);
  const float pixel = view.pixel * (view.perspective ? far : 1.0f);
  // Lane 0 is the upper left one.
  const float sx = hn::GetLane(block.slope_x) + 0.5f * wide * view.pixel;
  const float sy = hn::GetLane(block.slope_y) - 0.5f * high * view.pixel;
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
  std::uint32_t looked = 0;
  sums.clear();
  context.tile.forEachBlend(around, [&](const TileLeaf& at) HWY_ATTR {
    ++looked;
    switch (at.leaf->degree) {
      case kNearLeaf: blendNear(context, *at.leaf, block, sums); break;
      case 2: blendLeaf<2, WithLean>(context, at, block, sums); break;
      case 3: blendLeaf<3, WithLean>(context, at, block, sums); break;
      default: blendLeaf<4, WithLean>(context, at, block, sums); break;
    }
    return true;
  });
  context.statistics.rays_blend += looked * hn::Lanes(Tag());
}

/** Lanes whose blend belongs to no surface: neither covered, nor in a gap between leaves all
 * around. */
HWY_NOINLINE Mask
unsupported(const PassContext& context, const Ball& around, const Block& block, Mask doubtful)
{
  constexpr float kMinLeaves = 3.0f, kMaxLean = 0.25f;  // as isSupported()
  const Tag d;
  BlockSums sums;
  gather<true>(context, around, block, sums);
  const Vec* l = sums.lean;
  const Vec allowed = hn::Mul(set(kMaxLean), sums.weight);
  const Mask surrounded =
      hn::And(hn::Ge(sums.leaves, set(kMinLeaves)),
              hn::Lt(dot3(l[0], l[1], l[2], l[0], l[1], l[2]), hn::Mul(allowed, allowed)));
  return hn::AndNot(surrounded, hn::And(doubtful, hn::Gt(sums.weight, hn::Zero(d))));
}

/** Sends uncovered lanes back to pass 1, to look behind their q^. */
HWY_NOINLINE void
lookBehind(const PassContext& context, Mask uncovered, const BlockSums& sums, Block& block)
{
  const Tag d;
  HWY_ALIGN std::uint32_t surfel[16] = {};
  HWY_ALIGN float step[16], bits[16];
  hn::Store(sums.surfel, UintTag(), surfel);
  hn::Store(hn::IfThenElseZero(uncovered, set(1.0f)), d, bits);
  for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
    step[i] = bits[i] > 0.0f ? kLayerStep * context.scene.surface.radius[surfel[i]] : 0.0f;
  }
  const Vec forward = hn::Div(hn::Load(d, step), block.slant);
  Vec nearest = hn::Add(block.first, forward);
  if (context.scene.view.perspective) {
    const Vec z = hn::Add(block.z, forward);
    nearest = hn::Sub(hn::Div(set(-1.0f), z), set(context.tile.depth));
  }
  block.nearest = hn::IfThenElse(uncovered, nearest, block.nearest);
  block.first = set(kInfinite);
  block.pending = uncovered;
}

/** Keeps the sums of some lanes. */
void
keep(Mask settled, const BlockSums& sums, const Block& block, BlockSums& kept, Vec& kept_first)
{
  const auto take = [&](Vec& target, Vec value)
                        HWY_ATTR { target = hn::IfThenElse(settled, value, target); };
  take(kept.weight, sums.weight);
  take(kept.shift, sums.shift);
  take(kept.coverage, sums.coverage);
  take(kept.facing, sums.facing);
  for (int a = 0; a < 3; ++a) take(kept.gradient[a], sums.gradient[a]);
  for (int k = 0; k < 6; ++k) take(kept.hessian[k], sums.hessian[k]);
  take(kept_first, block.first);
  kept.surfel = hn::IfThenElse(hn::RebindMask(UintTag(), settled), sums.surfel, kept.surfel);
}

/** z of q^, and lanes that have one alone. */
HWY_INLINE void
prepareBlend(const PassContext& context, Block& block)
{
  const Mask met = hn::And(block.pending, hn::Lt(block.first, set(kInfinite)));
  block.pending = met;
  block.first = hn::IfThenElseZero(met, block.first);
  if (context.scene.view.perspective) {
    block.z = hn::Div(set(-1.0f), hn::Add(block.first, set(context.tile.depth)));
  }
}

/** Draws the block whose upper left pixel stands at (x, y) of its tile. */
void
drawBlock(const PassContext& context, const BlockOutput& output)
{
  const Tag d;
  Block block = blockAt(context, output.x, output.y);
  const auto min_coverage = static_cast<float>(context.scene.rules.min_coverage);
  BlockSums kept, sums;
  kept.clear();
  Vec kept_first = hn::Zero(d);
  for (int layer = 0; layer < kMaxLayers; ++layer) {
    findFirst(context, output.x, output.y, block);
    prepareBlend(context, block);
    if (hn::AllFalse(d, block.pending)) break;
    const Ball around = ballAround(context, block);
    gather<false>(context, around, block, sums);
    const Mask met = hn::Gt(sums.weight, hn::Zero(d));
    Mask uncovered = hn::And(met, hn::Lt(sums.coverage, set(min_coverage)));
    if (!hn::AllFalse(d, uncovered)) uncovered = unsupported(context, around, block, uncovered);
    const bool last = hn::AllFalse(d, uncovered);
    if (last && layer == 0) return output.write(block, sums, block.first);
    keep(hn::AndNot(uncovered, met), sums, block, kept, kept_first);
    if (last) break;
    lookBehind(context, uncovered, sums, block);
  }
  output.write(block, kept, kept_first);
}

void
drawTile(const FrameScene& scene, std::size_t t, TileScratch& scratch, GBuffer& buffer,
         RenderStatistics& statistics)
{
  TileBlocks tile(scene, t, scratch);
  const PassContext context(scene, tile, statistics);
  for (int py = 0; py < tile.height; py += kPatchSize) {
    for (int px = 0; px < tile.width; px += kPatchSize) {
      const bool any = tile.beginPatch(px, py);
      for (int y = py; y < std::min(py + kPatchSize, tile.height); y += blockHeight()) {
        for (int x = px; x < std::min(px + kPatchSize, tile.width); x += kBlockWidth) {
          const BlockOutput output{scene, tile, x, y, buffer, statistics};
          if (any)
            drawBlock(context, output);
          else
            output.writeNothing();
        }
      }
    }
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

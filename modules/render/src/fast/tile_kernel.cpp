// SPDX-License-Identifier: BSD-3-Clause
// Draws one tile, block by block of pixels, a ray a lane.
#include "fast/fast_rasterizer.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fast/tile_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "fast/block_output-inl.h"
#include "fast/block_passes-inl.h"
#include "fast/tile_blocks-inl.h"
#include "tiles/tiles.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {
namespace lanes {

/** Bounds a block's rays to their parts inside the frame's half spaces. */
HWY_NOINLINE void cut(const PassContext& context, Block& block) {
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
HWY_INLINE Block raysAt(const PassContext& context, const float* dx, const float* dy,
                        const PixelBox& box) {
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
HWY_INLINE Block blockAt(const PassContext& context, int x, int y) {
  HWY_ALIGN float dx[16], dy[16];
  for (int i = 0; i < kLanes; ++i) {
    const int column = i % kBlockWidth, row = i / kBlockWidth;
    dx[i] = static_cast<float>(x + column);
    dy[i] = static_cast<float>(y + row);
  }
  return raysAt(context, dx, dy, TileBlocks::boxAt(x, y, kBlockWidth, kBlockHeight));
}

/** Up to a block's number of rays that continue behind their hits. */
HWY_NOINLINE Block packOf(const PassContext& context, const UncoveredRay* rays, std::size_t count) {
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
HWY_INLINE Ball ballAround(const PassContext& context, const Block& block) {
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
HWY_NOINLINE void noteUncovered(const PassContext& context, Mask uncovered, const BlockSums& sums,
                                const Block& block) {
  const TileBlocks& tile = context.tile;
  HWY_ALIGN std::uint32_t surfel[16] = {};
  HWY_ALIGN float step[16], wanted[16], x[16], y[16], nearest[16];
  store(sums.surfel, surfel);
  store(IfThenElseZero(uncovered, set(1.0f)), wanted);
  const Mask above = sums.clearance > set(0.0f);
  store(IfThenElse(above, set(kBehind), set(kPeelStep)), step);
  for (int i = 0; i < kLanes; ++i) {
    step[i] = wanted[i] > 0.0f ? step[i] * context.scene.surface.radius[surfel[i]] : 0.0f;
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

/** Lanes as a leaf too near for a record is drawn in double. */
NearLanes nearLanes(const PassContext& context, const Block& block) {
  NearLanes lanes;
  store(block.dx + set(static_cast<float>(context.tile.x0)), lanes.x);
  store(block.dy + set(static_cast<float>(context.tile.y0)), lanes.y);
  store(block.nearest, lanes.nearest);
  store(block.first, lanes.first);
  store(IfThenElseZero(block.pending, set(1.0f)), lanes.live);
  lanes.tile_depth = context.tile.depth;
  lanes.count = kLanes;
  return lanes;
}

HWY_NOINLINE void firstOfNear(const PassContext& context, const FrameLeaf& leaf, Block& block) {
  NearLanes lanes = nearLanes(context, block);
  firstOfNearLeaf(context.scene, leaf.surfel, lanes);
  block.first = load(lanes.first);
}

HWY_NOINLINE void blendNear(const PassContext& context, const FrameLeaf& leaf, const Block& block,
                            BlockSums& sums) {
  NearLanes lanes = nearLanes(context, block);
  blendNearLeaf(context.scene, leaf.surfel, lanes);
  const Vec weight = load(lanes.weight);
  const Mask counts = weight > set(0.0f);
  const auto add = [&](Vec& sum, const float* column)
                       HWY_ATTR { sum += IfThenElseZero(counts, load(column)); };
  add(sums.weight, lanes.weight);
  add(sums.shift, lanes.shift);
  add(sums.coverage, lanes.coverage);
  add(sums.outside, lanes.outside);
  sums.clearance += load(lanes.clearance);
  add(sums.facing, lanes.facing);
  for (int a = 0; a < 3; ++a) {
    add(sums.gradient[a], lanes.gradient[a]);
    add(sums.offset_sum[a], lanes.offset_sum[a]);
  }
  for (int k = 0; k < 6; ++k) add(sums.hessian[k], lanes.hessian[k]);
  sums.leaves += IfThenElseZero(counts, set(1.0f));
  const Mask better = weight > sums.best;
  sums.best = Max(sums.best, IfThenElseZero(counts, weight));
  sums.surfel = IfThenElse(better, setUint(leaf.surfel), sums.surfel);
}

/** Whether any lane may still meet, or has met, something at this depth or beyond. */
HWY_INLINE bool reaches(const Block& block, float nearest) {
  return !AllFalse(And(block.pending, block.first >= set(nearest)));
}

/** Pass 1: the first intersection of each ray with a leaf inside its shrunk ball. */
void findFirst(const PassContext& context, Block& block) {
  const bool skip = context.scene.rules.skip;
  const std::size_t count = context.tile.listFirst(block.box);
  std::size_t n = 0;
  context.tile.kept().beginBlock();
  for (; n < count; ++n) {
    const TileLeaf& at = context.tile.listed(n);
    const std::uint32_t place = context.tile.placeOf(n);
    if (skip && !reaches(block, at.nearest)) break;
    switch (at.leaf->degree) {
      case kNearLeaf: firstOfNear(context, *at.leaf, block); break;
      case 2: firstOfQuadratic(context, at, block); break;
      case 3: firstOfHigher<3>(context, at, place, block); break;
      default: firstOfHigher<4>(context, at, place, block); break;
    }
  }
  context.statistics.rays_first += n * kLanes;
  context.statistics.occluded_entries += count - n;
}

/** Pass 2: sums over the leaves whose ball contains q^. */
template <bool WithOffset>
void gather(const PassContext& context, const Ball& around, const Block& block, BlockSums& sums) {
  const std::size_t count = context.tile.listBlend(around);
  sums.clear();
  for (std::size_t n = 0; n < count; ++n) {
    const TileLeaf& at = context.tile.listed(n);
    const std::uint32_t place = context.tile.placeOf(n);
    switch (at.leaf->degree) {
      case kNearLeaf: blendNear(context, *at.leaf, block, sums); break;
      case 2: blendLeaf<2, WithOffset>(context, at, place, block, sums); break;
      case 3: blendLeaf<3, WithOffset>(context, at, place, block, sums); break;
      default: blendLeaf<4, WithOffset>(context, at, place, block, sums); break;
    }
  }
  context.statistics.rays_blend += count * kLanes;
}

/** Lanes whose blend belongs to no surface: neither covered, nor in a gap between leaves all
 * around. */
HWY_NOINLINE Mask unsupported(const PassContext& context, Block block, Mask doubtful) {
  block.pending = doubtful;
  BlockSums sums;
  gather<true>(context, ballAround(context, block), block, sums);
  const Vec* l = sums.offset_sum;
  const Vec allowed = set(kMaxMeanOffset) * sums.weight;
  const Mask surrounded = And(sums.leaves >= set(kMinLeaves),
                              dot3(l[0], l[1], l[2], l[0], l[1], l[2]) < allowed * allowed);
  return AndNot(surrounded, And(doubtful, sums.weight > set(0.0f)));
}

/** z of q^, and lanes that have one alone. */
HWY_INLINE void prepareBlend(const PassContext& context, Block& block) {
  const Mask met = And(block.pending, block.first < block.farthest);
  block.pending = met;
  block.first = IfThenElseZero(met, block.first);
  if (context.scene.view.perspective) {
    block.z = set(-1.0f) / (block.first + set(context.tile.depth));
  }
}

/** Lanes whose blend is not on the surface. */
HWY_INLINE Mask uncoveredLanes(const PassContext& context, const Block& block,
                               const BlockSums& sums) {
  const auto min_coverage = static_cast<float>(context.scene.rules.min_coverage);
  const Mask met = sums.weight > set(0.0f);
  const Mask outside =
      Or(sums.outside > set(0.5f) * sums.weight, And(met, sums.clearance > set(0.0f)));
  Mask uncovered = AndNot(outside, And(met, sums.coverage < set(min_coverage)));
  if (!AllFalse(uncovered)) uncovered = unsupported(context, block, uncovered);
  return Or(uncovered, outside);
}

/** Both passes over some rays; those whose hit is not on the surface are noted, and have no
 * weight. \return false: no ray meets anything */
HWY_NOINLINE bool drawLayer(const PassContext& context, Block& block, BlockSums& sums) {
  {
    const StageTimer timer(context.tile.ticks(), FrameStage::kFirst);
    findFirst(context, block);
  }
  prepareBlend(context, block);
  if (AllFalse(block.pending)) return false;
  const StageTimer timer(context.tile.ticks(), FrameStage::kBlend);
  gather<false>(context, ballAround(context, block), block, sums);
  const Mask uncovered = uncoveredLanes(context, block, sums);
  if (AllFalse(uncovered)) return true;
  noteUncovered(context, uncovered, sums, block);
  sums.weight = IfThenElseZero(Not(uncovered), sums.weight);
  return true;
}

/** Draws what rays meet first, and notes those that continue behind it. */
void drawBlock(const PassContext& context, int x, int y, GBuffer& buffer) {
  const BlockOutput<BlockRows> output{
      context.scene, {context.tile, x, y}, buffer, context.statistics};
  Block block = blockAt(context, x, y);
  BlockSums sums;
  const bool met = drawLayer(context, block, sums);
  const StageTimer timer(context.tile.ticks(), FrameStage::kOutput);
  if (!met) return output.writeNothing();
  output.write(block, sums);
}

/** Draws the pixels of a patch whose rays continue behind an uncovered hit. They are few
 * and isolated, so that they are packed into blocks of their own. */
void drawBehind(const PassContext& context, GBuffer& buffer) {
  std::vector<UncoveredRay>& uncovered = context.tile.uncovered();
  std::vector<UncoveredRay>& left = context.tile.packed();
  for (int layer = 1; layer < kMaxLayers && !uncovered.empty(); ++layer) {
    left.swap(uncovered);
    uncovered.clear();
    for (std::size_t begin = 0; begin < left.size(); begin += kLanes) {
      const UncoveredRay* const rays = left.data() + begin;
      const std::size_t count = std::min<std::size_t>(kLanes, left.size() - begin);
      Block block = packOf(context, rays, count);
      BlockSums sums;
      if (!drawLayer(context, block, sums)) continue;
      const StageTimer timer(context.tile.ticks(), FrameStage::kOutput);
      BlockOutput<PackedPixels>{
          context.scene, {context.tile, rays, count, sums}, buffer, context.statistics}
          .write(block, sums);
    }
  }
  uncovered.clear();
}

void drawPatch(const PassContext& context, int px, int py, GBuffer& buffer) {
  const TileBlocks& tile = context.tile;
  for (int y = py; y < std::min(py + kPatchSize, tile.height); y += kBlockHeight) {
    for (int x = px; x < std::min(px + kPatchSize, tile.width); x += kBlockWidth) {
      drawBlock(context, x, y, buffer);
    }
  }
  drawBehind(context, buffer);
}

/** Marks the pixels of a row of patches from x0 to before x1 as met by nothing. */
void clearPatches(const TileBlocks& tile, int x0, int x1, int py, GBuffer& buffer) {
  const StageTimer timer(tile.ticks(), FrameStage::kOutput);
  x1 = std::min(x1, tile.width);
  for (int y = py; y < std::min(py + kPatchSize, tile.height) && x0 < x1; ++y) {
    clearPixels(buffer, buffer.index(tile.x0 + x0, tile.y0 + y), static_cast<std::size_t>(x1 - x0));
  }
}

}  // namespace lanes

void drawTile(const FrameScene& scene, std::size_t t, TileScratch& scratch, GBuffer& buffer,
              RenderStatistics& statistics) {
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

void drawTile(const FrameScene& scene, std::size_t t, TileScratch& scratch, GBuffer& buffer,
              RenderStatistics& statistics) {
  HWY_DYNAMIC_DISPATCH(drawTile)(scene, t, scratch, buffer, statistics);
}

}  // namespace pcl_slim::detail::kernels
#endif

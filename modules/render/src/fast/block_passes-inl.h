// SPDX-License-Identifier: BSD-3-Clause
// What both passes over a block of pixels share, and pass 1: the front-most q^, a ray a lane. The
// guard toggles: Highway compiles a kernel file once per instruction set.
#if defined(PCL_SLIM_BLOCK_PASSES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_BLOCK_PASSES_INL
#undef PCL_SLIM_BLOCK_PASSES_INL
#else
#define PCL_SLIM_BLOCK_PASSES_INL
#endif

#include <limits>

#include "fast/lanes/leaf_rays-inl.h"
#include "fast/lanes/root_lanes-inl.h"
#include "fast/near_leaf.h"
#include "fast/tile_blocks-inl.h"
#include "pcl_slim/render/detail/frame_constants.h"
#include "pcl_slim/surface/detail/trim_outside-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

/** Sums of a block's blend (eqs. 6, 7, 8 left), before division by the weight; camera's axes. */
struct BlockSums {
  Vec weight, shift, coverage, facing, best;
  Vec outside;  ///< of w outsideShare(): of the trim maps
  Vec gradient[3], hessian[6], lean[3], leaves;
  UintVec surfel;

  void clear()
  {
    const Vec zero = set(0.0f);
    weight = shift = coverage = facing = best = outside = leaves = zero;
    for (auto& g : gradient) g = zero;
    for (auto& h : hessian) h = zero;
    for (auto& l : lean) l = zero;
    surfel = setUint(GBuffer::kNothing);
  }
};

/** Rays of a block and what they have met. Depths are D less the tile's. */
struct Block {
  PixelBox box;                  ///< contains its pixels
  Vec dx, dy;                    ///< pixel from the tile's corner
  Vec slope_x, slope_y;          ///< rays (x, y, 1) or, parallel, where they start
  Vec direction_x, direction_y;  ///< rays (x, y, 1); 0 if parallel
  Vec slant;                     ///< length of a ray's step to the next unit of z
  Vec near_plane;                ///< depth
  Vec nearest;                   ///< least depth at which pass 1 accepts a root ...
  Vec farthest;                  ///< ... and the greatest
  Vec first;                     ///< of q^; farthest where nothing was met
  Vec z;                         ///< of q^; 1 if parallel
  Mask pending;
};

/** What both passes need of a frame and a tile. */
struct PassContext {
  const FrameScene& scene;
  TileBlocks& tile;
  WeightKernel kernel;
  float first_sq, blend_sq;  ///< squared shares of radii
  bool front_only, with_hessian, with_near_plane;
  RenderStatistics& statistics;

  PassContext(const FrameScene& s, TileBlocks& t, RenderStatistics& counts)
      : scene(s),
        tile(t),
        kernel(s.surface.info.blend_kernel),
        first_sq(s.shares.first * s.shares.first),
        blend_sq(s.shares.blend * s.shares.blend),
        front_only(s.rules.front_only),
        with_hessian((s.columns & (kHessianColumn | kCurvatureColumn)) != 0),
        with_near_plane(s.rules.near_plane > 0.0),
        statistics(counts)
  {
  }
};

HWY_INLINE LeafRays
raysOf(const TileLeaf& at, const Block& block)
{
  const FrameLeaf& leaf = *at.leaf;
  return {leaf, MulAdd(set(leaf.per_pixel), block.dx, set(at.x)),
          NegMulAdd(set(leaf.per_pixel), block.dy, set(at.y))};
}

HWY_INLINE Vec
sigmaOf(const TileLeaf& at, Vec depth)
{
  return MulAdd(set(at.leaf->beta), depth, set(at.sigma));
}

/** A coordinate, in radii, along an axis of the leaf's plane of the points at sigma. */
HWY_INLINE Vec
inPlane(const LeafRays& rays, Vec sigma, Vec inverse_m, const float* axis, float along)
{
  const Vec p = MulAdd(set(axis[0]), rays.x, MulAdd(set(axis[1]), rays.y, set(along) * sigma));
  return p * inverse_m;
}

/** The share outside, by an open leaf's trim map, of the points at sigma. */
HWY_NOINLINE Vec
outsideOf(const LeafRays& rays, Vec sigma, Vec inverse_m)
{
  const FrameLeaf& leaf = rays.leaf;
  const Vec scale = set(leaf.trim_scale) * inverse_m;
  const Vec u = inPlane(rays, sigma, scale, leaf.u, leaf.uc);
  const Vec v = inPlane(rays, sigma, scale, leaf.v, leaf.vc);
  return byParts(
      [&](auto pu, auto pv) HWY_ATTR { return outsideShares(Part(), leaf.trim, pu, pv); }, u, v);
}

/** Those of some lanes in which the leaf's own trim map has data at sigma. */
HWY_INLINE Mask
haveData(const LeafRays& rays, Vec sigma, Mask some)
{
  if (rays.leaf.trim.closed() || AllFalse(some)) return some;
  const Vec inverse_m = set(1.0f) / rays.scaleAt(sigma);
  return And(some, outsideOf(rays, sigma, inverse_m) <= set(0.5f));
}

/** Moves q^ to a nearer root where the leaf has data. \return lanes of nearer roots without data */
HWY_INLINE Mask
moveForward(const TileLeaf& at, const LeafRays& rays, Mask found, Vec sigma, Block& block)
{
  const Vec depth = (sigma - set(at.sigma)) * set(at.leaf->inverse_beta);
  const Mask before = And(found, And(depth < block.first, depth >= block.nearest));
  const Mask moved = haveData(rays, sigma, before);
  block.first = IfThenElse(moved, depth, block.first);
  return AndNot(moved, before);
}

/** Pass 1 of a quadratic leaf: roots in closed form, then whether they are in the ball. */
HWY_INLINE void
firstOfQuadratic(const PassContext& context, const TileLeaf& at, Block& block)
{
  const LeafRays rays = raysOf(at, block);
  const RayPolynomials<2> f(at.leaf->form(), rays.x, rays.y);
  const QuadraticRoots roots(f, context.front_only);
  const Mask live = And(block.pending, roots.real);
  const auto take = [&](Vec sigma) HWY_ATTR {
    moveForward(at, rays, And(live, rays.inBall(sigma, context.first_sq)), sigma, block);
  };
  take(roots.falling);
  if (!context.front_only) take(roots.rising);
}

/** Pass 1 of a cubic or quartic leaf in lanes where it may have several roots between low and high. */
template <int D>
HWY_NOINLINE void
firstOfMany(const PassContext& context, const TileLeaf& at, const LeafRays& rays,
            RayPolynomials<D> f, Vec low, Vec high, Mask open, Block& block)
{
  constexpr float kBeyond =
      1e-3f;  // step past a root without data, from which the search continues
  Vec step = low;
  while (!AllFalse(open)) {
    f.shift(step);
    const FoundRoots roots = firstRootAlong<D>(f, high - low, context.front_only, open,
                                               context.statistics.rays_bracketed);
    open = moveForward(at, rays, roots.found, low + roots.at, block);
    step = roots.at + set(kBeyond);
    low += step;
  }
}

/** Pass 1 of a cubic or quartic leaf. */
template <int D>
HWY_INLINE void
firstOfHigher(const PassContext& context, const TileLeaf& at, Block& block)
{
  const LeafRays rays = raysOf(at, block);
  const RayPolynomials<D> f(at.leaf->form(), rays.x, rays.y);
  Vec low, high;
  Mask open = And(block.pending, rays.chord(context.first_sq, low, high));
  low = Max(low, sigmaOf(at, block.nearest));
  high = Min(high, sigmaOf(at, block.first));
  open = And(open, low < high);
  if (AllFalse(open)) return;
  const Stretch<D> stretch(f, low, high - low);
  const Mask one = And(open, stretch.one(context.front_only));
  if (!AllFalse(one)) {
    moveForward(at, rays, one, MulAdd(high - low, stretch.root(one), low), block);
  }
  open = And(open, stretch.many());
  if (!AllFalse(open)) firstOfMany<D>(context, at, rays, f, low, high, open, block);
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes
HWY_AFTER_NAMESPACE();
#endif

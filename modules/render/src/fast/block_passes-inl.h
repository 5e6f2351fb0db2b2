// SPDX-License-Identifier: BSD-3-Clause
// Both passes over one block of pixels, a ray a lane. The guard toggles: Highway compiles a kernel
// file once per instruction set.
#if defined(PCL_SLIM_BLOCK_PASSES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_BLOCK_PASSES_INL
#undef PCL_SLIM_BLOCK_PASSES_INL
#else
#define PCL_SLIM_BLOCK_PASSES_INL
#endif

#include <limits>

#include "fast/leaf_rays-inl.h"
#include "fast/near_leaf.h"
#include "fast/tile_blocks-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using UintTag = hn::RebindToUnsigned<Tag>;
using UintVec = hn::Vec<UintTag>;

constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr float kMaxShift = 0.25f;   ///< distance of q^ from a leaf's own surface, in its radii
constexpr float kSettled = 1e-4f;    ///< of r: the Newton step after one so short is below rounding
constexpr float kSameSheet = 5e-4f;  ///< of r: q^ gains nothing by moving forward less than this

/** Sums of a block's blend (eqs. 6, 7, 8 left), before division by the weight; camera's axes. */
struct BlockSums {
  Vec weight, shift, coverage, facing, best;
  Vec gradient[3], hessian[6], lean[3], leaves;
  UintVec surfel;

  void clear()
  {
    const Vec zero = hn::Zero(Tag());
    weight = shift = coverage = facing = best = leaves = zero;
    for (auto& g : gradient) g = zero;
    for (auto& h : hessian) h = zero;
    for (auto& l : lean) l = zero;
    surfel = hn::Set(UintTag(), GBuffer::kNothing);
  }
};

/** Rays of a block and what they have met. Depths are D less the tile's. */
struct Block {
  Vec dx, dy;            ///< pixel from the tile's corner
  Vec slope_x, slope_y;  ///< rays (x, y, 1) or, parallel, where they start
  Vec slant;             ///< length of a ray's step to the next unit of z
  Vec near_plane;        ///< depth
  Vec nearest;           ///< pass 1 looks no nearer than this
  Vec first;             ///< of q^; infinity where nothing was met
  Vec z;                 ///< of q^; 1 if parallel
  Mask pending;
};

/** What both passes need of a frame and a tile. */
struct PassContext {
  const FrameScene& scene;
  const TileBlocks& tile;
  WeightKernel kernel;
  float first_sq, blend_sq;  ///< squared shares of radii
  float inverse_cover_sq;
  bool front_only, with_hessian, with_near_plane;
  RenderStatistics& statistics;

  PassContext(const FrameScene& s, const TileBlocks& t, RenderStatistics& counts)
      : scene(s),
        tile(t),
        kernel(s.surface.info.blend_kernel),
        first_sq(s.shares.first * s.shares.first),
        blend_sq(s.shares.blend * s.shares.blend),
        inverse_cover_sq(static_cast<float>(1.0 / (s.rules.cover_radius * s.rules.cover_radius))),
        front_only(s.rules.front_only),
        with_hessian((s.columns & (kHessianColumn | kCurvatureColumn)) != 0),
        with_near_plane(s.rules.near_plane > 0.0),
        statistics(counts)
  {
  }
};

HWY_INLINE Vec
blendWeight(WeightKernel kernel, Vec s_sq)
{
  switch (kernel) {
    case WeightKernel::kPower2: return kernelWeight<WeightKernel::kPower2>(s_sq);
    case WeightKernel::kPower4: return kernelWeight<WeightKernel::kPower4>(s_sq);
    case WeightKernel::kPower7: return kernelWeight<WeightKernel::kPower7>(s_sq);
    default: return kernelWeight<WeightKernel::kGaussian>(s_sq);
  }
}

HWY_INLINE LeafRays
raysOf(const TileLeaf& at, const Block& block)
{
  const FrameLeaf& leaf = *at.leaf;
  return {leaf, hn::MulAdd(set(leaf.per_pixel), block.dx, set(at.x)),
          hn::NegMulAdd(set(leaf.per_pixel), block.dy, set(at.y))};
}

HWY_INLINE Vec
sigmaOf(const TileLeaf& at, Vec depth)
{
  return hn::MulAdd(set(at.leaf->beta), depth, set(at.sigma));
}

/** Moves q^ of lanes whose root lies before it. */
HWY_INLINE void
moveForward(const TileLeaf& at, Mask found, Vec sigma, Block& block)
{
  const Vec depth = hn::Mul(hn::Sub(sigma, set(at.sigma)), set(at.leaf->inverse_beta));
  found = hn::And(found, hn::And(hn::Lt(depth, block.first), hn::Ge(depth, block.nearest)));
  block.first = hn::IfThenElse(found, depth, block.first);
}

/** Pass 1 of a quadratic leaf: roots in closed form, then whether they lie in the ball. */
HWY_INLINE void
firstOfQuadratic(const PassContext& context, const TileLeaf& at, Block& block)
{
  const LeafRays rays = raysOf(at, block);
  const RayPolynomials<2> f(at.leaf->form(), rays.x, rays.y);
  const QuadraticRoots roots(f, context.front_only);
  const Mask live = hn::And(block.pending, roots.real);
  const auto take = [&](Vec sigma) HWY_ATTR {
    moveForward(at, hn::And(live, rays.inBall(sigma, context.first_sq)), sigma, block);
  };
  take(roots.falling);
  if (!context.front_only) take(roots.rising);
}

/** Pass 1 of a leaf whose F falls all along the rays in its ball: Newton alone leads to the root.
 * \return lanes that Newton did not settle. */
template <int D>
HWY_INLINE Mask
firstByNewton(const PassContext& context, const TileLeaf& at, const LeafRays& rays,
              const RayPolynomials<D>& f, Block& block)
{
  const Tag d;
  const Vec reached = sigmaOf(at, block.first);
  const Mask have = hn::Lt(reached, set(1.5f));  // also false where nothing was met
  Vec sigma = hn::IfThenElseZero(have, hn::Max(reached, set(-1.5f)));
  Vec value = f.value(sigma);
  // F < 0 at q^: q^ lies behind this leaf's surface.
  Mask active = hn::And(block.pending, hn::Or(hn::Not(have), hn::Lt(value, set(-kSameSheet))));
  if (hn::AllFalse(d, active)) return active;
  Mask open = active;
  for (int step = 0; step < 4; ++step) {
    const Vec slope = hn::Min(f.slope(sigma), set(-0.01f));
    const Vec change = hn::Div(value, slope);
    sigma = hn::Clamp(hn::Sub(sigma, change), set(-1.5f), set(1.5f));
    open = hn::And(active, hn::Ge(hn::Abs(change), set(10.0f * kSettled)));
    if (hn::AllFalse(d, open)) break;
    value = f.value(sigma);
  }
  const Mask inside = rays.inBall(sigma, context.first_sq);
  moveForward(at, hn::And(hn::AndNot(open, active), inside), sigma, block);
  return open;
}

/** Pass 1 of a cubic or quartic leaf. */
template <int D>
HWY_INLINE void
firstOfHigher(const PassContext& context, const TileLeaf& at, Block& block)
{
  const Tag d;
  const LeafRays rays = raysOf(at, block);
  const RayPolynomials<D> f(at.leaf->form(), rays.x, rays.y);
  Mask open = block.pending;
  if (at.leaf->monotone != 0) {
    open = firstByNewton<D>(context, at, rays, f, block);
    if (hn::AllFalse(d, open)) return;
  }
  Vec low, high, sigma = hn::Zero(d);
  open = hn::And(open, rays.chord(context.first_sq, low, high));
  low = hn::Max(low, sigmaOf(at, block.nearest));
  high = hn::Min(high, sigmaOf(at, block.first));
  open = hn::And(open, hn::Lt(low, high));
  if (hn::AllFalse(d, open)) return;
  const auto found = isolate<D>(f, low, high, context.front_only, open, sigma);
  moveForward(at, found.one, sigma, block);
  if (hn::AllFalse(d, found.unclear)) return;
  const Mask solved = solveOneByOne<D>(f, low, high, low, context.front_only, found.unclear, sigma,
                                       context.statistics.rays_bracketed);
  moveForward(at, solved, sigma, block);
}

/** A leaf's roots next to q^ and what the guards say of them. */
struct NearRoots {
  Vec sigma;  ///< of the root
  Vec slope;  ///< sign of dF / d sigma there
  Mask found;
};

HWY_INLINE NearRoots
nextRoot(const PassContext& context, const RayPolynomials<2>& f, Vec hat, Vec, Mask live)
{
  const QuadraticRoots roots(f, context.front_only);
  live = hn::And(live, roots.real);
  if (context.front_only) return {roots.falling, set(-1.0f), live};
  const Vec falls = hn::Abs(hn::Sub(roots.falling, hat));
  const Vec rises = hn::Abs(hn::Sub(roots.rising, hat));
  const Mask first = hn::Or(hn::Le(falls, rises), hn::Not(hn::Eq(rises, rises)));
  return {hn::IfThenElse(first, roots.falling, roots.rising),
          hn::IfThenElse(first, set(-1.0f), set(1.0f)), live};
}

/** Lanes of taylor (F about q^) for which Newton's steps from q^ are sure to lead to the nearest
 * root: with e = 2 |F / F'|, |F''| e < |F'| / 2 for |t| <= e (obviousRoot of polynomial_roots.h). */
template <int D>
HWY_INLINE Mask
isObvious(const RayPolynomials<D>& taylor)
{
  const Vec* a = taylor.a;
  const Vec reach = hn::Mul(set(2.0f), hn::Abs(a[0])), steep = hn::Abs(a[1]);
  const Vec steep_sq = hn::Mul(steep, steep);
  // Times |F'|^2 throughout: no division. |F''| / 2 <= |a2| + 3 |a3| e + 6 |a4| e^2.
  Vec bend = hn::Mul(hn::Abs(a[2]), steep);
  bend = hn::MulAdd(hn::Mul(set(3.0f), hn::Abs(a[3])), reach, bend);
  if constexpr (D == 4) {
    bend = hn::MulAdd(hn::Mul(set(6.0f), hn::Abs(a[4])), hn::Mul(reach, set(1.0f)), bend);
  }
  // e < 1 makes e^2 <= e and lets the last term stand with e alone.
  const Vec bound = hn::Mul(hn::Mul(set(4.0f), bend), reach);
  return hn::And(hn::Lt(reach, steep), hn::Lt(bound, hn::Mul(steep_sq, steep)));
}

template <int D>
HWY_INLINE NearRoots
nextRoot(const PassContext& context, const LeafRays& rays, const RayPolynomials<D>& f,
         const RayPolynomials<D>& taylor, Vec hat, Vec near_sigma, Mask live)
{
  const Tag d;
  const Vec zero = hn::Zero(d);
  NearRoots near{hat, taylor.a[1], live};
  Mask sure = hn::And(live, isObvious<D>(taylor));
  if (context.front_only) sure = hn::And(sure, hn::Lt(taylor.a[1], zero));
  if (!hn::AllFalse(d, sure)) {
    Vec t = hn::Neg(hn::Div(taylor.a[0], taylor.a[1]));
    for (int step = 0; step < 5; ++step) {
      const Vec change = hn::Div(taylor.value(t), taylor.slope(t));
      t = hn::Sub(t, change);
      const Mask settled = hn::Lt(hn::Abs(change), set(kSettled));
      if (hn::AllTrue(d, hn::Or(settled, hn::Not(sure)))) break;
    }
    near.sigma = hn::Add(hat, t);
  }
  const Mask rest = hn::AndNot(sure, live);
  if (hn::AllFalse(d, rest)) return near;
  Vec low, high, sigma = hat;
  const Mask meets = hn::And(rest, rays.chord(1.0f, low, high));
  low = hn::Max(low, near_sigma);
  const auto found = isolate<D>(f, low, high, context.front_only, meets, sigma);
  Mask solved = found.one;
  if (!hn::AllFalse(d, found.unclear)) {
    solved = hn::Or(solved, solveOneByOne<D>(f, low, high, hat, context.front_only, found.unclear,
                                             sigma, context.statistics.rays_bracketed));
  }
  near.sigma = hn::IfThenElse(solved, sigma, near.sigma);
  near.slope = hn::IfThenElse(solved, f.slope(sigma), near.slope);
  near.found = hn::Or(sure, solved);
  return near;
}

/** grad h, and the second derivatives where asked, at (u, v). */
template <int D>
struct HeightSlopes {
  Vec hu, hv;

  HWY_INLINE HeightSlopes(const float* c, Vec u, Vec v)
  {
    const auto k = [&](int i) HWY_ATTR { return set(c[i]); };
    const auto times = [&](float f, int i) HWY_ATTR { return set(f * c[i]); };
    if constexpr (D == 2) {
      hu = hn::MulAdd(times(2, 3), u, hn::MulAdd(k(4), v, k(1)));
      hv = hn::MulAdd(times(2, 5), v, hn::MulAdd(k(4), u, k(2)));
    } else if constexpr (D == 3) {
      hu = hn::MulAdd(u, hn::MulAdd(times(3, 6), u, hn::MulAdd(times(2, 7), v, times(2, 3))),
                      hn::MulAdd(v, hn::MulAdd(k(8), v, k(4)), k(1)));
      hv = hn::MulAdd(v, hn::MulAdd(times(3, 9), v, hn::MulAdd(times(2, 8), u, times(2, 5))),
                      hn::MulAdd(u, hn::MulAdd(k(7), u, k(4)), k(2)));
    } else {
      const Vec u2 = hn::MulAdd(times(4, 10), u, hn::MulAdd(times(3, 11), v, times(3, 6)));
      const Vec u1 = hn::MulAdd(v, hn::MulAdd(times(2, 12), v, times(2, 7)), times(2, 3));
      const Vec u0 = hn::MulAdd(v, hn::MulAdd(v, hn::MulAdd(k(13), v, k(8)), k(4)), k(1));
      hu = hn::MulAdd(u, hn::MulAdd(u, u2, u1), u0);
      const Vec v2 = hn::MulAdd(times(4, 14), v, hn::MulAdd(times(3, 13), u, times(3, 9)));
      const Vec v1 = hn::MulAdd(u, hn::MulAdd(times(2, 12), u, times(2, 8)), times(2, 5));
      const Vec v0 = hn::MulAdd(u, hn::MulAdd(u, hn::MulAdd(k(11), u, k(7)), k(4)), k(2));
      hv = hn::MulAdd(v, hn::MulAdd(v, v2, v1), v0);
    }
  }
};

template <int D>
struct HeightBends {
  Vec huu, huv, hvv;

  HWY_INLINE HeightBends(const float* c, Vec u, Vec v)
  {
    const auto times = [&](float f, int i) HWY_ATTR { return set(f * c[i]); };
    huu = times(2, 3);
    huv = times(1, 4);
    hvv = times(2, 5);
    if constexpr (D >= 3) {
      huu = hn::MulAdd(times(6, 6), u, hn::MulAdd(times(2, 7), v, huu));
      huv = hn::MulAdd(times(2, 7), u, hn::MulAdd(times(2, 8), v, huv));
      hvv = hn::MulAdd(times(2, 8), u, hn::MulAdd(times(6, 9), v, hvv));
    }
    if constexpr (D >= 4) {
      const Vec uu = hn::Mul(u, u), uv = hn::Mul(u, v), vv = hn::Mul(v, v);
      huu = hn::MulAdd(times(12, 10), uu,
                       hn::MulAdd(times(6, 11), uv, hn::MulAdd(times(2, 12), vv, huu)));
      huv = hn::MulAdd(times(3, 11), uu,
                       hn::MulAdd(times(4, 12), uv, hn::MulAdd(times(3, 13), vv, huv)));
      hvv = hn::MulAdd(times(2, 12), uu,
                       hn::MulAdd(times(6, 13), uv, hn::MulAdd(times(12, 14), vv, hvv)));
    }
  }
};

/** A leaf at the point where its own surface crosses each ray. */
struct Crossing {
  Vec sigma, inverse_m;
  Vec weight;  ///< 0 in lanes that do not count
  Vec side;    ///< -1 where a ray comes from behind
};

template <int D>
HWY_INLINE void
addDerivatives(const PassContext& context, const LeafRays& rays, const Crossing& at,
               BlockSums& sums)
{
  const FrameLeaf& leaf = rays.leaf;
  const auto inFrame = [&](const float* axis, float along) HWY_ATTR {
    const Vec p = hn::MulAdd(set(axis[0]), rays.x,
                             hn::MulAdd(set(axis[1]), rays.y, hn::Mul(set(along), at.sigma)));
    return hn::Mul(p, at.inverse_m);
  };
  const Vec u = inFrame(leaf.u, leaf.uc), v = inFrame(leaf.v, leaf.vc);
  const float* c = leaf.height();
  const HeightSlopes<D> h(c, u, v);
  const Vec signed_weight = context.front_only ? at.weight : hn::Mul(at.weight, at.side);
  for (int a = 0; a < 3; ++a) {
    const Vec g =
        hn::NegMulAdd(h.hu, set(leaf.u[a]), hn::NegMulAdd(h.hv, set(leaf.v[a]), set(leaf.w[a])));
    sums.gradient[a] = hn::MulAdd(signed_weight, g, sums.gradient[a]);
  }
  if (!context.with_hessian) return;
  const HeightBends<D> b(c, u, v);
  const Vec scale = hn::Mul(signed_weight, set(-leaf.inverse_radius));
  const Vec huu = hn::Mul(scale, b.huu), huv = hn::Mul(scale, b.huv), hvv = hn::Mul(scale, b.hvv);
  for (int i = 0; i < 3; ++i) {
    // Row i of huu u u^T + huv (u v^T + v u^T) + hvv v v^T.
    const Vec by_u = hn::MulAdd(huu, set(leaf.u[i]), hn::Mul(huv, set(leaf.v[i])));
    const Vec by_v = hn::MulAdd(huv, set(leaf.u[i]), hn::Mul(hvv, set(leaf.v[i])));
    for (int j = i; j < 3; ++j) {
      Vec& sum = sums.hessian[kSymmetricEntry[i][j]];
      sum = hn::MulAdd(by_u, set(leaf.u[j]), hn::MulAdd(by_v, set(leaf.v[j]), sum));
    }
  }
}

/** Which way a blend's leaves lie from it: kept only where its coverage leaves a doubt. */
HWY_INLINE void
addLean(const LeafRays& rays, const Crossing& at, BlockSums& sums)
{
  const Tag d;
  const FrameLeaf& leaf = rays.leaf;
  const Vec share = hn::Mul(at.weight, at.inverse_m);
  const Vec px = hn::MulAdd(set(leaf.xc), at.sigma, rays.x);
  const Vec py = hn::MulAdd(set(leaf.yc), at.sigma, rays.y);
  sums.lean[0] = hn::MulAdd(share, px, sums.lean[0]);
  sums.lean[1] = hn::MulAdd(share, py, sums.lean[1]);
  sums.lean[2] = hn::MulAdd(share, at.sigma, sums.lean[2]);
  const Mask counts = hn::Gt(at.weight, hn::Zero(d));
  sums.leaves = hn::Add(sums.leaves, hn::IfThenElseZero(counts, set(1.0f)));
}

/** Pass 2 of one leaf. */
template <int D, bool WithLean>
HWY_INLINE void
blendLeaf(const PassContext& context, const TileLeaf& place, const Block& block, BlockSums& sums)
{
  const Tag d;
  const FrameLeaf& leaf = *place.leaf;
  const LeafRays rays = raysOf(place, block);
  const Vec hat = sigmaOf(place, block.first);
  const Vec hat_inverse = hn::Mul(block.z, set(leaf.inverse_depth));
  const Vec hat_inverse_sq = hn::Mul(hat_inverse, hat_inverse);
  const Vec hat_sq = hn::Mul(rays.distanceSq(hat), hat_inverse_sq);
  Mask live = hn::And(block.pending, hn::Lt(hat_sq, set(context.blend_sq)));
  if (hn::AllFalse(d, live)) return;
  const RayPolynomials<D> f(leaf.form(), rays.x, rays.y);
  const Vec near_sigma =
      context.with_near_plane ? sigmaOf(place, block.near_plane) : set(-kInfinite);
  NearRoots near;
  if constexpr (D == 2) {
    live = hn::And(live, hn::Lt(hn::Mul(hn::Abs(f.value(hat)), hat_inverse_sq), set(kMaxShift)));
    near = nextRoot(context, f, hat, near_sigma, live);
  } else {
    RayPolynomials<D> taylor = f;
    taylor.shift(hat);
    Vec power = hn::Mul(hat_inverse_sq, hat_inverse);
    if constexpr (D == 4) power = hn::Mul(power, hat_inverse);
    live = hn::And(live, hn::Lt(hn::Mul(hn::Abs(taylor.a[0]), power), set(kMaxShift)));
    if (hn::AllFalse(d, live)) return;
    near = nextRoot<D>(context, rays, f, taylor, hat, near_sigma, live);
  }
  Crossing at;
  at.sigma = hn::IfThenElse(near.found, near.sigma, hat);
  at.inverse_m = hn::Div(set(1.0f), rays.scaleAt(at.sigma));
  const Vec root_sq = hn::Mul(rays.distanceSq(at.sigma), hn::Mul(at.inverse_m, at.inverse_m));
  const Vec s_sq = hn::Max(hat_sq, root_sq);
  Mask counts = hn::And(near.found, hn::Lt(s_sq, set(context.blend_sq)));
  if (context.with_near_plane) counts = hn::And(counts, hn::Ge(at.sigma, near_sigma));
  if (hn::AllFalse(d, counts)) return;
  at.weight = hn::IfThenElseZero(
      counts, hn::Mul(set(leaf.variance_weight), blendWeight(context.kernel, s_sq)));
  at.side = hn::IfThenElse(hn::Gt(near.slope, hn::Zero(d)), set(-1.0f), set(1.0f));
  sums.weight = hn::Add(sums.weight, at.weight);
  // s - s^ = (sigma - sigma^) / (m m^).
  const Vec moved = hn::Mul(hn::Sub(at.sigma, hat), hn::Mul(at.inverse_m, hat_inverse));
  sums.shift = hn::MulAdd(hn::Mul(at.weight, set(leaf.radius)), moved, sums.shift);
  const Vec cover = blendWeight(context.kernel, hn::Mul(root_sq, set(context.inverse_cover_sq)));
  sums.coverage = hn::Add(sums.coverage, hn::IfThenElseZero(counts, cover));
  if (!context.front_only) {
    sums.facing = hn::Add(sums.facing, hn::IfThenElseZero(counts, at.side));
  }
  const Mask better = hn::Gt(at.weight, sums.best);
  sums.best = hn::Max(sums.best, at.weight);
  sums.surfel = hn::IfThenElse(hn::RebindMask(UintTag(), better), hn::Set(UintTag(), leaf.surfel),
                               sums.surfel);
  addDerivatives<D>(context, rays, at, sums);
  if constexpr (WithLean) addLean(rays, at, sums);
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

// SPDX-License-Identifier: BSD-3-Clause
// Pass 2 over one block of pixels: the leaves about q^ are blended, a ray a lane. The guard toggles:
// Highway compiles a kernel file once per instruction set.
#if defined(PCL_SLIM_BLEND_PASS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_BLEND_PASS_INL
#undef PCL_SLIM_BLEND_PASS_INL
#else
#define PCL_SLIM_BLEND_PASS_INL
#endif

#include "fast/block_passes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

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

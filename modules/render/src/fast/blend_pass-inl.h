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
  Vec slope;  ///< dF / d sigma there; its sign alone of cubics and quartics
  Mask found;
};

HWY_INLINE NearRoots
nextRoot(const PassContext& context, const RayPolynomials<2>& f, Vec hat, Vec, Mask live)
{
  const QuadraticRoots roots(f, context.front_only);
  live = hn::And(live, roots.real);
  if (context.front_only) return {roots.falling, roots.slope, live};
  const Vec falls = hn::Abs(hn::Sub(roots.falling, hat));
  const Vec rises = hn::Abs(hn::Sub(roots.rising, hat));
  const Mask first = hn::Or(hn::Le(falls, rises), hn::Not(hn::Eq(rises, rises)));
  return {hn::IfThenElse(first, roots.falling, roots.rising),
          hn::IfThenElse(first, roots.slope, hn::Neg(roots.slope)), live};
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
  // e < 1 makes e^2 <= e and lets the last term stand with e alone.
  if constexpr (D == 4) bend = hn::MulAdd(hn::Mul(set(6.0f), hn::Abs(a[4])), reach, bend);
  const Vec bound = hn::Mul(hn::Mul(set(4.0f), bend), reach);
  return hn::And(hn::Lt(reach, steep), hn::Lt(bound, hn::Mul(steep_sq, steep)));
}

/** The same root by isolation, for some lanes. */
template <int D>
HWY_NOINLINE void
isolateNear(const PassContext& context, const LeafRays& rays, Vec hat, Vec near_sigma, Mask rest,
            NearRoots& near)
{
  const Tag d;
  const RayPolynomials<D> f(rays.leaf.form(), rays.x, rays.y);
  Vec low, high, sigma = hat;
  const Mask meets = hn::And(rest, rays.chord(1.0f, low, high));
  low = hn::Max(low, near_sigma);
  const auto found = isolate<D>(f, low, high, context.front_only, meets, sigma);
  Mask solved = found.one;
  if (!hn::AllFalse(d, found.unclear)) {
    solved = hn::Or(solved, solveUnclear<D>(f, low, high, hat, context.front_only, found.unclear,
                                            sigma, context.statistics.rays_bracketed));
  }
  near.sigma = hn::IfThenElse(solved, sigma, near.sigma);
  near.slope = hn::IfThenElse(solved, f.slope(sigma), near.slope);
  near.found = hn::Or(near.found, solved);
}

/** The root nearest to q^, taylor being F about q^: a step of Halley's and one of Newton's where
 * they are sure to lead to it and settle. */
template <int D>
HWY_INLINE NearRoots
nextRoot(const PassContext& context, const LeafRays& rays, const RayPolynomials<D>& taylor, Vec hat,
         Vec near_sigma, Mask live)
{
  constexpr float kShort = 4e-3f;  // the step after one so short is below 1e-5
  const Tag d;
  const Vec* a = taylor.a;
  const Vec under = hn::NegMulAdd(a[0], a[2], hn::Mul(a[1], a[1]));
  const Vec t = hn::Neg(hn::Div(hn::Mul(a[0], a[1]), under));
  const Vec change = hn::Div(taylor.value(t), taylor.slope(t));
  NearRoots near{hn::Add(hat, hn::Sub(t, change)), a[1], live};
  near.found = hn::And(live, hn::Lt(hn::Abs(change), set(kShort)));
  if ((rays.leaf.monotone & kBlendMonotone) == 0) {
    near.found = hn::And(near.found, isObvious<D>(taylor));
    if (context.front_only) near.found = hn::And(near.found, hn::Lt(a[1], hn::Zero(d)));
  }
  const Mask rest = hn::AndNot(near.found, live);
  if (!hn::AllFalse(d, rest)) isolateNear<D>(context, rays, hat, near_sigma, rest, near);
  return near;
}

/** A leaf at the point where its own surface crosses each ray. */
struct Crossing {
  Vec sigma, inverse_m;
  Vec slope;   ///< dF / d sigma, of quadratics
  Vec weight;  ///< 0 in lanes that do not count
  Vec side;    ///< -1 where a ray comes from behind
};

/** Second derivatives of a cubic or quartic leaf at (u, v). */
template <int D>
HWY_INLINE void
addHessian(const FrameLeaf& leaf, const float* bends, Vec weight, Vec u, Vec v, BlockSums& sums)
{
  constexpr int kSize = numCoefficients(D - 2);
  const Vec scale = hn::Mul(weight, set(-leaf.inverse_radius));
  const Vec huu = hn::Mul(scale, planeForm<D - 2>(bends, u, v));
  const Vec huv = hn::Mul(scale, planeForm<D - 2>(bends + kSize, u, v));
  const Vec hvv = hn::Mul(scale, planeForm<D - 2>(bends + 2 * kSize, u, v));
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

/** Derivatives of a quadratic f at a crossing: those in x and y are dF / dX and dF / dY over m, that
 * along the ray (x, y, 1) is dF / d sigma, as f = 0 and d sigma / dz is m^2 / r. */
HWY_INLINE void
addQuadraticDerivatives(const PassContext& context, const LeafRays& rays, const Block& block,
                        const Crossing& at, Vec weight, BlockSums& sums)
{
  const float* f = rays.leaf.form();
  const auto k = [&](int i) HWY_ATTR { return set(f[i]); };
  const Vec twice_x = hn::Add(rays.x, rays.x), twice_y = hn::Add(rays.y, rays.y);
  const Vec fx =
      hn::MulAdd(k(3), twice_x, hn::MulAdd(k(4), rays.y, hn::MulAdd(k(7), at.sigma, k(1))));
  const Vec fy =
      hn::MulAdd(k(5), twice_y, hn::MulAdd(k(4), rays.x, hn::MulAdd(k(8), at.sigma, k(2))));
  const Vec gx = hn::Mul(fx, at.inverse_m), gy = hn::Mul(fy, at.inverse_m);
  const Vec gz =
      hn::NegMulAdd(block.direction_x, gx, hn::NegMulAdd(block.direction_y, gy, at.slope));
  sums.gradient[0] = hn::MulAdd(weight, gx, sums.gradient[0]);
  sums.gradient[1] = hn::MulAdd(weight, gy, sums.gradient[1]);
  sums.gradient[2] = hn::MulAdd(weight, gz, sums.gradient[2]);
  if (!context.with_hessian) return;
  const float* hessian = rays.leaf.form() + FrameLeaf::formSize(2);
  for (int i = 0; i < 6; ++i) {
    sums.hessian[i] = hn::MulAdd(weight, set(hessian[i]), sums.hessian[i]);
  }
}

template <int D>
HWY_INLINE void
addDerivatives(const PassContext& context, const LeafRays& rays, const Block& block,
               const Crossing& at, BlockSums& sums)
{
  const FrameLeaf& leaf = rays.leaf;
  const Vec weight = context.front_only ? at.weight : hn::Mul(at.weight, at.side);
  if constexpr (D == 2) {
    addQuadraticDerivatives(context, rays, block, at, weight, sums);
  } else {
    const auto inFrame = [&](const float* axis, float along) HWY_ATTR {
      const Vec p = hn::MulAdd(set(axis[0]), rays.x,
                               hn::MulAdd(set(axis[1]), rays.y, hn::Mul(set(along), at.sigma)));
      return hn::Mul(p, at.inverse_m);
    };
    constexpr int kSize = numCoefficients(D - 1);
    const Vec u = inFrame(leaf.u, leaf.uc), v = inFrame(leaf.v, leaf.vc);
    const float* slopes = leaf.form() + FrameLeaf::formSize(D);
    const Vec hu = planeForm<D - 1>(slopes, u, v), hv = planeForm<D - 1>(slopes + kSize, u, v);
    for (int a = 0; a < 3; ++a) {
      const Vec g =
          hn::NegMulAdd(hu, set(leaf.u[a]), hn::NegMulAdd(hv, set(leaf.v[a]), set(leaf.w[a])));
      sums.gradient[a] = hn::MulAdd(weight, g, sums.gradient[a]);
    }
    if (context.with_hessian) addHessian<D>(leaf, slopes + 2 * kSize, weight, u, v, sums);
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

/** q^ in a leaf's coordinates. */
struct Hats {
  Vec sigma, inverse_m, inverse_m_sq;
  Vec distance_sq;  ///< from the centre, in radii

  HWY_INLINE Hats(const TileLeaf& place, const LeafRays& rays, const Block& block)
  {
    sigma = sigmaOf(place, block.first);
    inverse_m = hn::Mul(block.z, set(place.leaf->inverse_depth));
    inverse_m_sq = hn::Mul(inverse_m, inverse_m);
    distance_sq = hn::Mul(rays.distanceSq(sigma), inverse_m_sq);
  }
};

/** Where a leaf's own surface crosses each ray next to q^, if it passes q^ by less than kMaxShift. */
template <int D>
HWY_INLINE NearRoots
crossingOf(const PassContext& context, const LeafRays& rays, const Hats& hats, Vec near_sigma,
           Mask live)
{
  RayPolynomials<D> f(rays.leaf.form(), rays.x, rays.y);
  if constexpr (D == 2) {
    const Vec away = hn::Mul(hn::Abs(f.value(hats.sigma)), hats.inverse_m_sq);
    return nextRoot(context, f, hats.sigma, near_sigma,
                    hn::And(live, hn::Lt(away, set(kMaxShift))));
  } else {
    f.shift(hats.sigma);
    Vec power = hn::Mul(hats.inverse_m_sq, hats.inverse_m);
    if constexpr (D == 4) power = hn::Mul(hats.inverse_m_sq, hats.inverse_m_sq);
    live = hn::And(live, hn::Lt(hn::Mul(hn::Abs(f.a[0]), power), set(kMaxShift)));
    return nextRoot<D>(context, rays, f, hats.sigma, near_sigma, live);
  }
}

/** Pass 2 of one leaf. */
template <int D, bool WithLean>
HWY_INLINE void
blendLeaf(const PassContext& context, const TileLeaf& place, const Block& block, BlockSums& sums)
{
  const Tag d;
  const FrameLeaf& leaf = *place.leaf;
  const LeafRays rays = raysOf(place, block);
  const Hats hats(place, rays, block);
  const Mask live = hn::And(block.pending, hn::Lt(hats.distance_sq, set(context.blend_sq)));
  if (hn::AllFalse(d, live)) return;
  const Vec near_sigma =
      context.with_near_plane ? sigmaOf(place, block.near_plane) : set(-kInfinite);
  const NearRoots near = crossingOf<D>(context, rays, hats, near_sigma, live);
  Crossing at;
  at.sigma = hn::IfThenElse(near.found, near.sigma, hats.sigma);
  at.slope = near.slope;
  at.inverse_m = hn::Div(set(1.0f), rays.scaleAt(at.sigma));
  const Vec root_sq = hn::Mul(rays.distanceSq(at.sigma), hn::Mul(at.inverse_m, at.inverse_m));
  const Vec s_sq = hn::Max(hats.distance_sq, root_sq);
  Mask counts = hn::And(near.found, hn::Lt(s_sq, set(context.blend_sq)));
  if (context.with_near_plane) counts = hn::And(counts, hn::Ge(at.sigma, near_sigma));
  at.weight = hn::IfThenElseZero(
      counts, hn::Mul(set(leaf.variance_weight), blendWeight(context.kernel, s_sq)));
  sums.weight = hn::Add(sums.weight, at.weight);
  // s - s^ = (sigma - sigma^) / (m m^).
  const Vec moved = hn::Mul(hn::Sub(at.sigma, hats.sigma), hn::Mul(at.inverse_m, hats.inverse_m));
  sums.shift = hn::MulAdd(hn::Mul(at.weight, set(leaf.radius)), moved, sums.shift);
  const Vec cover = blendWeight(context.kernel, hn::Mul(root_sq, set(context.inverse_cover_sq)));
  sums.coverage = hn::Add(sums.coverage, hn::IfThenElseZero(counts, cover));
  at.side = set(1.0f);
  if (!context.front_only) {
    at.side = hn::IfThenElse(hn::Gt(near.slope, hn::Zero(d)), set(-1.0f), set(1.0f));
    sums.facing = hn::Add(sums.facing, hn::IfThenElseZero(counts, at.side));
  }
  const Mask better = hn::Gt(at.weight, sums.best);
  sums.best = hn::Max(sums.best, at.weight);
  sums.surfel = hn::IfThenElse(hn::RebindMask(UintTag(), better), hn::Set(UintTag(), leaf.surfel),
                               sums.surfel);
  addDerivatives<D>(context, rays, block, at, sums);
  if constexpr (WithLean) addLean(rays, at, sums);
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

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
namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes {

/** A leaf's roots next to q^, and the lanes that have one. */
struct NearRoots {
  Vec sigma;  ///< of the root
  Vec slope;  ///< dF / d sigma there; its sign alone of cubics and quartics
  Mask found;
};

HWY_INLINE NearRoots
nextRoot(const PassContext& context, const RayPolynomials<2>& f, Vec hat, Vec, Mask live)
{
  const QuadraticRoots roots(f, context.front_only);
  live = And(live, roots.real);
  if (context.front_only) return {roots.falling, roots.slope, live};
  const Vec falls = Abs(roots.falling - hat);
  const Vec rises = Abs(roots.rising - hat);
  const Mask first = Or(falls <= rises, Not(rises == rises));
  return {IfThenElse(first, roots.falling, roots.rising),
          IfThenElse(first, roots.slope, Neg(roots.slope)), live};
}

/** Lanes in which F, about q^, falls (or rises) all over the interval about q^ that reaches to a root
 * at t: no other root is as near. */
template <int D>
HWY_INLINE Mask
isNearest(const RayPolynomials<D>& taylor, Vec t)
{
  const Vec* a = taylor.a;
  const Vec reach = Abs(t);
  Vec bend = set(3.0f) * Abs(a[3]);
  if constexpr (D == 4) bend = MulAdd(set(4.0f) * Abs(a[4]), reach, bend);
  bend = MulAdd(bend, reach, set(2.0f) * Abs(a[2]));
  return bend * reach < set(0.95f) * Abs(a[1]);
}

/** Finds the root nearest to q^ in the lanes of rest, where near has none or a root may be nearer than
 * near.sigma. \param[in] taylor F about q^ */
template <int D>
HWY_NOINLINE void
isolateNear(const PassContext& context, const LeafRays& rays, RayPolynomials<D> taylor, Vec hat,
            Vec near_sigma, Mask rest, NearRoots& near)
{
  constexpr float kNearer = 0.999f;  // of the way to a known root
  Vec low, high;
  rest = And(rest, rays.chord(1.0f, low, high));
  low = Max(low, near_sigma);
  const Vec known = set(kNearer) * Abs(near.sigma - hat);
  const Vec most = IfThenElse(near.found, known, set(kInfinite));
  std::uint64_t& solved = context.statistics.rays_bracketed;
  const FoundRoots behind =
      firstRootAlong<D>(taylor, Min(most, high - hat), context.front_only, rest, solved);
  // -F(-t) falls where F does.
  RayPolynomials<D> back = taylor;
  for (int i = 0; i <= D; i += 2) back.a[i] = Neg(back.a[i]);
  const Vec down = Min(hat - low, IfThenElse(behind.found, behind.at, most));
  const FoundRoots before = firstRootAlong<D>(back, down, context.front_only, rest, solved);
  const Vec t = IfThenElse(before.found, Neg(before.at), behind.at);
  const Mask nearer = Or(before.found, behind.found);
  near.sigma = IfThenElse(nearer, hat + t, near.sigma);
  near.slope = IfThenElse(nearer, taylor.slope(t), near.slope);
  near.found = Or(near.found, nearer);
}

/** The root nearest to q^, by one step of Halley's and one of Newton's where these surely converge to it,
 * else by isolation. \param[in] taylor F about q^ */
template <int D>
HWY_INLINE NearRoots
nextRoot(const PassContext& context, const LeafRays& rays, const RayPolynomials<D>& taylor, Vec hat,
         Vec near_sigma, Mask live)
{
  constexpr float kShort = 4e-3f;  // the step after one so short is below 1e-5
  const Vec* a = taylor.a;
  const Vec under = NegMulAdd(a[0], a[2], a[1] * a[1]);
  const Vec start = Neg(a[0] * a[1] / under);
  const Vec slope = taylor.slope(start), change = taylor.value(start) / slope;
  const Vec t = start - change;
  NearRoots near{hat + t, slope, live};
  near.found = And(live, Abs(change) < set(kShort));
  if (context.front_only) near.found = And(near.found, slope < set(0.0f));
  const Mask rest = AndNot(And(near.found, isNearest<D>(taylor, t)), live);
  if (!AllFalse(rest)) isolateNear<D>(context, rays, taylor, hat, near_sigma, rest, near);
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
  const Vec scale = weight * set(-leaf.inverse_radius);
  const Vec huu = scale * planeForm<D - 2>(bends, u, v);
  const Vec huv = scale * planeForm<D - 2>(bends + kSize, u, v);
  const Vec hvv = scale * planeForm<D - 2>(bends + 2 * kSize, u, v);
  for (int i = 0; i < 3; ++i) {
    // Row i of huu u u^T + huv (u v^T + v u^T) + hvv v v^T.
    const Vec by_u = MulAdd(huu, set(leaf.u[i]), huv * set(leaf.v[i]));
    const Vec by_v = MulAdd(huv, set(leaf.u[i]), hvv * set(leaf.v[i]));
    for (int j = i; j < 3; ++j) {
      Vec& sum = sums.hessian[kSymmetricEntry[i][j]];
      sum = MulAdd(by_u, set(leaf.u[j]), MulAdd(by_v, set(leaf.v[j]), sum));
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
  const Vec twice_x = rays.x + rays.x, twice_y = rays.y + rays.y;
  const Vec fx = MulAdd(k(3), twice_x, MulAdd(k(4), rays.y, MulAdd(k(7), at.sigma, k(1))));
  const Vec fy = MulAdd(k(5), twice_y, MulAdd(k(4), rays.x, MulAdd(k(8), at.sigma, k(2))));
  const Vec gx = fx * at.inverse_m, gy = fy * at.inverse_m;
  const Vec gz = NegMulAdd(block.direction_x, gx, NegMulAdd(block.direction_y, gy, at.slope));
  sums.gradient[0] = MulAdd(weight, gx, sums.gradient[0]);
  sums.gradient[1] = MulAdd(weight, gy, sums.gradient[1]);
  sums.gradient[2] = MulAdd(weight, gz, sums.gradient[2]);
  if (!context.with_hessian) return;
  const float* hessian = rays.leaf.form() + FrameLeaf::formSize(2);
  for (int i = 0; i < 6; ++i) {
    sums.hessian[i] = MulAdd(weight, set(hessian[i]), sums.hessian[i]);
  }
}

template <int D>
HWY_INLINE void
addDerivatives(const PassContext& context, const LeafRays& rays, const Block& block,
               const Crossing& at, BlockSums& sums)
{
  const FrameLeaf& leaf = rays.leaf;
  const Vec weight = context.front_only ? at.weight : at.weight * at.side;
  if constexpr (D == 2) {
    addQuadraticDerivatives(context, rays, block, at, weight, sums);
  } else {
    constexpr int kSize = numCoefficients(D - 1);
    const Vec u = inPlane(rays, at.sigma, at.inverse_m, leaf.u, leaf.uc);
    const Vec v = inPlane(rays, at.sigma, at.inverse_m, leaf.v, leaf.vc);
    const float* slopes = leaf.form() + FrameLeaf::formSize(D);
    const Vec hu = planeForm<D - 1>(slopes, u, v), hv = planeForm<D - 1>(slopes + kSize, u, v);
    for (int a = 0; a < 3; ++a) {
      const Vec g = NegMulAdd(hu, set(leaf.u[a]), NegMulAdd(hv, set(leaf.v[a]), set(leaf.w[a])));
      sums.gradient[a] = MulAdd(weight, g, sums.gradient[a]);
    }
    if (context.with_hessian) addHessian<D>(leaf, slopes + 2 * kSize, weight, u, v, sums);
  }
}

/** Adds where a leaf's crossing is from its centre: needed only where coverage is below its threshold. */
HWY_INLINE void
addLean(const LeafRays& rays, const Crossing& at, BlockSums& sums)
{
  const FrameLeaf& leaf = rays.leaf;
  const Vec share = at.weight * at.inverse_m;
  const Vec px = MulAdd(set(leaf.xc), at.sigma, rays.x);
  const Vec py = MulAdd(set(leaf.yc), at.sigma, rays.y);
  sums.lean[0] = MulAdd(share, px, sums.lean[0]);
  sums.lean[1] = MulAdd(share, py, sums.lean[1]);
  sums.lean[2] = MulAdd(share, at.sigma, sums.lean[2]);
  const Mask counts = at.weight > set(0.0f);
  sums.leaves += IfThenElseZero(counts, set(1.0f));
}

/** q^ in a leaf's coordinates. */
struct Hats {
  Vec sigma, inverse_m, inverse_m_sq;
  Vec distance_sq;  ///< from the centre, in radii

  HWY_INLINE Hats(const TileLeaf& place, const LeafRays& rays, const Block& block)
  {
    sigma = sigmaOf(place, block.first);
    inverse_m = block.z * set(place.leaf->inverse_depth);
    inverse_m_sq = inverse_m * inverse_m;
    distance_sq = rays.distanceSq(sigma) * inverse_m_sq;
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
    const Vec away = Abs(f.value(hats.sigma)) * hats.inverse_m_sq;
    return nextRoot(context, f, hats.sigma, near_sigma, And(live, away < set(kMaxShift)));
  } else {
    f.shift(hats.sigma);
    Vec power = hats.inverse_m_sq * hats.inverse_m;
    if constexpr (D == 4) power = hats.inverse_m_sq * hats.inverse_m_sq;
    live = And(live, Abs(f.a[0]) * power < set(kMaxShift));
    return nextRoot<D>(context, rays, f, hats.sigma, near_sigma, live);
  }
}

/** Pass 2 of one leaf. */
template <int D, bool WithLean>
HWY_INLINE void
blendLeaf(const PassContext& context, const TileLeaf& place, const Block& block, BlockSums& sums)
{
  const FrameLeaf& leaf = *place.leaf;
  const LeafRays rays = raysOf(place, block);
  const Hats hats(place, rays, block);
  const Mask live = And(block.pending, hats.distance_sq < set(context.blend_sq));
  if (AllFalse(live)) return;
  const Vec near_sigma =
      context.with_near_plane ? sigmaOf(place, block.near_plane) : set(-kInfinite);
  const NearRoots near = crossingOf<D>(context, rays, hats, near_sigma, live);
  // A root outside the ball may be NaN (along a flat leaf) or infinite (m = 0), which a weight of 0 would not
  // keep out of the sums: q^ takes its place.
  const Vec m = rays.scaleAt(near.sigma), from_center_sq = rays.distanceSq(near.sigma);
  Mask counts = And(near.found, from_center_sq < set(context.blend_sq) * (m * m));
  if (context.with_near_plane) counts = And(counts, near.sigma >= near_sigma);
  Crossing at;
  at.sigma = IfThenElse(counts, near.sigma, hats.sigma);
  at.slope = IfThenElseZero(counts, near.slope);
  at.inverse_m = set(1.0f) / IfThenElse(counts, m, set(1.0f));
  const Vec root_sq = from_center_sq * (at.inverse_m * at.inverse_m);
  const Vec s_sq = Max(hats.distance_sq, root_sq);
  at.weight = IfThenElseZero(counts, set(leaf.variance_weight) * blendWeight(context.kernel, s_sq));
  sums.weight += at.weight;
  // s - s^ = (sigma - sigma^) / (m m^).
  const Vec moved = (at.sigma - hats.sigma) * (at.inverse_m * hats.inverse_m);
  sums.shift = MulAdd(at.weight * set(leaf.radius), moved, sums.shift);
  const Vec cover = blendWeight(context.kernel, root_sq * set(leaf.inverse_cover_sq));
  sums.coverage += IfThenElseZero(counts, cover);
  at.side = set(1.0f);
  if (!context.front_only) {
    at.side = IfThenElse(near.slope > set(0.0f), set(-1.0f), set(1.0f));
    sums.facing += IfThenElseZero(counts, at.side);
  }
  const Mask better = at.weight > sums.best;
  sums.best = Max(sums.best, at.weight);
  sums.surfel = IfThenElse(better, setUint(leaf.surfel), sums.surfel);
  if (!leaf.trim.closed()) {
    sums.outside = MulAdd(at.weight, outsideOf(rays, at.sigma, at.inverse_m), sums.outside);
  }
  addDerivatives<D>(context, rays, block, at, sums);
  if constexpr (WithLean) addLean(rays, at, sums);
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes
HWY_AFTER_NAMESPACE();
#endif

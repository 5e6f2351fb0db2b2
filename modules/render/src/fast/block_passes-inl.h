// SPDX-License-Identifier: BSD-3-Clause
// What both passes over a block of pixels share; pass 1: the front-most q^, a ray a lane; and pass
// 2: the leaves about q^ are blended. The guard toggles: Highway compiles a kernel file once per
// instruction set.
#if defined(PCL_SLIM_BLOCK_PASSES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_BLOCK_PASSES_INL
#undef PCL_SLIM_BLOCK_PASSES_INL
#else
#define PCL_SLIM_BLOCK_PASSES_INL
#endif

#include <limits>

#include "fast/fast_rasterizer.h"
#include "fast/leaf_rays-inl.h"
#include "fast/tile_blocks-inl.h"
#include "pcl_slim/render/detail/frame_constants.h"
#include "pcl_slim/surface/detail/trim_outside-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

/** Sums of a block's blend (eqs. 6, 7, 8 left), before division by the weight; camera's axes. */
struct BlockSums {
  Vec weight, shift, coverage, facing, best;
  Vec clearance;  ///< of w r heightBehind()
  Vec outside;    ///< of w outsideShare(): of the trim maps
  Vec gradient[3], hessian[6], offset_sum[3], leaves;
  UintVec surfel;

  void clear() {
    const Vec zero = set(0.0f);
    weight = shift = coverage = facing = best = outside = clearance = leaves = zero;
    for (auto& g : gradient) g = zero;
    for (auto& h : hessian) h = zero;
    for (auto& l : offset_sum) l = zero;
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
        statistics(counts) {}
};

HWY_INLINE LeafRays raysOf(const TileLeaf& at, const Block& block) {
  const FrameLeaf& leaf = *at.leaf;
  return {leaf, MulAdd(set(leaf.per_pixel), block.dx, set(at.x)),
          NegMulAdd(set(leaf.per_pixel), block.dy, set(at.y))};
}

HWY_INLINE Vec sigmaOf(const TileLeaf& at, Vec depth) {
  return MulAdd(set(at.leaf->beta), depth, set(at.sigma));
}

/** A coordinate, in radii, along an axis of the leaf's plane of the points at sigma. */
HWY_INLINE Vec inPlane(const LeafRays& rays, Vec sigma, Vec inverse_m, const float* axis,
                       float along) {
  const Vec p = MulAdd(set(axis[0]), rays.x, MulAdd(set(axis[1]), rays.y, set(along) * sigma));
  return p * inverse_m;
}

/** The share outside, by an open leaf's trim map, of the points at sigma. */
HWY_NOINLINE Vec outsideOf(const LeafRays& rays, Vec sigma, Vec inverse_m) {
  const FrameLeaf& leaf = rays.leaf;
  const Vec scale = set(leaf.trim_scale) * inverse_m;
  const Vec u = inPlane(rays, sigma, scale, leaf.u, leaf.uc);
  const Vec v = inPlane(rays, sigma, scale, leaf.v, leaf.vc);
  return byParts(
      [&](auto pu, auto pv) HWY_ATTR { return outsideShares(Part(), leaf.trim, pu, pv); }, u, v);
}

/** Those of some lanes in which the leaf's own trim map has data at sigma. */
HWY_INLINE Mask haveData(const LeafRays& rays, Vec sigma, Mask some) {
  if (rays.leaf.trim.closed() || AllFalse(some)) return some;
  const Vec inverse_m = set(1.0f) / rays.scaleAt(sigma);
  return And(some, outsideOf(rays, sigma, inverse_m) <= set(0.5f));
}

/** Moves q^ to a nearer root where the leaf has data. \return lanes of nearer roots without data */
HWY_INLINE Mask moveForward(const TileLeaf& at, const LeafRays& rays, Mask found, Vec sigma,
                            Block& block) {
  const Vec depth = (sigma - set(at.sigma)) * set(at.leaf->inverse_beta);
  const Mask before = And(found, And(depth < block.first, depth >= block.nearest));
  const Mask moved = haveData(rays, sigma, before);
  block.first = IfThenElse(moved, depth, block.first);
  return AndNot(moved, before);
}

/** Pass 1 of a quadratic leaf: roots in closed form, then whether they are in the ball. */
HWY_INLINE void firstOfQuadratic(const PassContext& context, const TileLeaf& at, Block& block) {
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

/** Pass 1 of a cubic or quartic leaf in lanes where it may have several roots between low and high.
 */
template <int D>
HWY_NOINLINE void firstOfMany(const PassContext& context, const TileLeaf& at, const LeafRays& rays,
                              RayPolynomials<D> f, Vec low, Vec high, Mask open, Block& block) {
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
HWY_INLINE void firstOfHigher(const PassContext& context, const TileLeaf& at, std::uint32_t place,
                              Block& block) {
  const LeafRays rays = raysOf(at, block);
  Vec low, high;
  Mask open = And(block.pending, rays.chord(context.first_sq, low, high));
  low = Max(low, sigmaOf(at, block.nearest));
  high = Min(high, sigmaOf(at, block.first));
  open = And(open, low < high);
  if (AllFalse(open)) return;
  const RayPolynomials<D> f(at.leaf->form(), rays.x, rays.y);
  if (float* kept = context.tile.kept().keep(place)) f.keep(kept);
  if (at.leaf->turn == LeafTurn::kFalls) {
    const Vec zero = set(0.0f), last = f.value(high);
    open = AndNot(last > zero, open);
    if (AllFalse(open)) return;
    const Vec first = f.value(low);
    open = And(open, first > zero);
    if (AllFalse(open)) return;
    const Vec span = IfThenElse(open, first - last, set(1.0f));
    const Vec start = MulAdd(high - low, first / span, low);
    const Vec root = rootInBracket<D>(f, low, high, start, set(1.0f), open);
    moveForward(at, rays, open, root, block);
    return;
  }
  const Stretch<D> stretch(f, low, high - low);
  const Mask one = And(open, stretch.one(context.front_only));
  if (!AllFalse(one)) {
    moveForward(at, rays, one, MulAdd(high - low, stretch.root(one), low), block);
  }
  open = And(open, stretch.many());
  if (!AllFalse(open)) firstOfMany<D>(context, at, rays, f, low, high, open, block);
}

/** A leaf's roots next to q^, and the lanes that have one. */
struct NearRoots {
  Vec sigma;  ///< of the root
  Vec slope;  ///< dF / d sigma there; its sign alone of cubics and quartics
  Mask found;
};

HWY_INLINE NearRoots nextRoot(const PassContext& context, const RayPolynomials<2>& f, Vec hat, Vec,
                              Mask live) {
  const QuadraticRoots roots(f, context.front_only);
  live = And(live, roots.real);
  if (context.front_only) return {roots.falling, roots.slope, live};
  const Vec falls = Abs(roots.falling - hat);
  const Vec rises = Abs(roots.rising - hat);
  const Mask first = Or(falls <= rises, Not(rises == rises));
  return {IfThenElse(first, roots.falling, roots.rising),
          IfThenElse(first, roots.slope, Neg(roots.slope)), live};
}

/** Lanes in which F, about q^, falls (or rises) all over the interval about q^ that reaches to a
 * root at t: no other root is as near. */
template <int D>
HWY_INLINE Mask isNearest(const RayPolynomials<D>& taylor, Vec t) {
  const Vec* a = taylor.a;
  const Vec reach = Abs(t);
  Vec bend = set(3.0f) * Abs(a[3]);
  if constexpr (D == 4) bend = MulAdd(set(4.0f) * Abs(a[4]), reach, bend);
  bend = MulAdd(bend, reach, set(2.0f) * Abs(a[2]));
  return bend * reach < set(0.95f) * Abs(a[1]);
}

/** Finds the root nearest to q^ in the lanes of rest, where near has none or a root may be nearer
 * than near.sigma. \param[in] taylor F about q^ */
template <int D>
HWY_NOINLINE void isolateNear(const PassContext& context, const LeafRays& rays,
                              RayPolynomials<D> taylor, Vec hat, Vec near_sigma, Mask rest,
                              NearRoots& near) {
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

/** The root nearest to q^, by one step of Halley's and one of Newton's where these surely converge
 * to it, else by isolation. \param[in] taylor F about q^ */
template <int D>
HWY_INLINE NearRoots nextRoot(const PassContext& context, const LeafRays& rays,
                              const RayPolynomials<D>& taylor, Vec hat, Vec near_sigma, Mask live) {
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
HWY_INLINE void addHessian(const FrameLeaf& leaf, const float* bends, Vec weight, Vec u, Vec v,
                           BlockSums& sums) {
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

/** Derivatives of a quadratic f at a crossing: those in x and y are dF / dX and dF / dY over m,
 * that along the ray (x, y, 1) is dF / d sigma, as f = 0 and d sigma / dz is m^2 / r. */
HWY_INLINE void addQuadraticDerivatives(const PassContext& context, const LeafRays& rays,
                                        const Block& block, const Crossing& at, Vec weight,
                                        BlockSums& sums) {
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
HWY_INLINE void addDerivatives(const PassContext& context, const LeafRays& rays, const Block& block,
                               const Crossing& at, BlockSums& sums) {
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

/** Adds where a leaf's crossing is from its centre: needed only where coverage is below its
 * threshold. */
HWY_INLINE void addOffset(const LeafRays& rays, const Crossing& at, BlockSums& sums) {
  const FrameLeaf& leaf = rays.leaf;
  const Vec share = at.weight * at.inverse_m;
  const Vec px = MulAdd(set(leaf.xc), at.sigma, rays.x);
  const Vec py = MulAdd(set(leaf.yc), at.sigma, rays.y);
  sums.offset_sum[0] = MulAdd(share, px, sums.offset_sum[0]);
  sums.offset_sum[1] = MulAdd(share, py, sums.offset_sum[1]);
  sums.offset_sum[2] = MulAdd(share, at.sigma, sums.offset_sum[2]);
  const Mask counts = at.weight > set(0.0f);
  sums.leaves += IfThenElseZero(counts, set(1.0f));
}

/** q^ in a leaf's coordinates. */
struct Hats {
  Vec sigma, inverse_m, inverse_m_sq;
  Vec distance_sq;  ///< from the centre, in radii

  HWY_INLINE Hats(const TileLeaf& place, const LeafRays& rays, const Block& block) {
    sigma = sigmaOf(place, block.first);
    inverse_m = block.z * set(place.leaf->inverse_depth);
    inverse_m_sq = inverse_m * inverse_m;
    distance_sq = rays.distanceSq(sigma) * inverse_m_sq;
  }
};

/** f of a leaf on each ray, in radii. */
struct Heights {
  Vec at_hat;
  Vec behind;  ///< about kBehind behind q^, to the second order
};

/** F along each ray, which pass 1 may have kept; of quadratics storing it takes as long as computing
 * it again. */
template <int D>
HWY_INLINE RayPolynomials<D> polynomialsOf(const PassContext& context, std::uint32_t place,
                                           const LeafRays& rays) {
  if constexpr (D > 2) {
    const float* const kept = context.tile.kept().find(place);
    if (kept) return RayPolynomials<D>(rays.leaf.form(), kept);
  }
  return RayPolynomials<D>(rays.leaf.form(), rays.x, rays.y);
}

/** Where a leaf's own surface crosses each ray next to q^, in the lanes of live; of these, those stay
 * in which it passes q^ by less than kMaxShift. */
template <int D>
HWY_INLINE NearRoots crossingOf(const PassContext& context, const LeafRays& rays, const Hats& hats,
                                Vec near_sigma, std::uint32_t n, Mask& live, Heights& heights) {
  RayPolynomials<D> f = polynomialsOf<D>(context, n, rays);
  const Vec step = set(static_cast<float>(kBehind));
  if constexpr (D == 2) {
    heights.at_hat = f.value(hats.sigma) * hats.inverse_m_sq;
    const Vec rise = MulAdd(f.a[2], step, f.slope(hats.sigma)) * hats.inverse_m_sq;
    heights.behind = MulAdd(rise, step, heights.at_hat);
    live = And(live, Abs(heights.at_hat) < set(kMaxShift));
    return nextRoot(context, f, hats.sigma, near_sigma, live);
  } else {
    f.shift(hats.sigma);
    Vec power = hats.inverse_m_sq * hats.inverse_m;
    if constexpr (D == 4) power = hats.inverse_m_sq * hats.inverse_m_sq;
    heights.at_hat = f.a[0] * power;
    heights.behind = MulAdd(MulAdd(f.a[2], step, f.a[1]) * power, step, heights.at_hat);
    live = And(live, Abs(heights.at_hat) < set(kMaxShift));
    return nextRoot<D>(context, rays, f, hats.sigma, near_sigma, live);
  }
}

/** Adds the heights of a leaf that rays miss next to q^, see heightBehind(). */
HWY_NOINLINE void addMissed(const PassContext& context, const FrameLeaf& leaf, const Hats& hats,
                            Vec behind, Mask missed, BlockSums& sums) {
  const Vec weight = blendWeight(context.kernel, hats.distance_sq);
  const Vec height = set(leaf.variance_weight * leaf.radius) * weight * behind;
  sums.clearance += IfThenElseZero(missed, height);
}

/** Pass 2 of one leaf. */
template <int D, bool WithOffset>
HWY_INLINE void blendLeaf(const PassContext& context, const TileLeaf& place, std::uint32_t n,
                          const Block& block, BlockSums& sums) {
  const FrameLeaf& leaf = *place.leaf;
  const LeafRays rays = raysOf(place, block);
  const Hats hats(place, rays, block);
  Mask live = And(block.pending, hats.distance_sq < set(context.blend_sq));
  if (AllFalse(live)) return;
  const Vec near_sigma =
      context.with_near_plane ? sigmaOf(place, block.near_plane) : set(-kInfinite);
  Heights heights;
  const NearRoots near = crossingOf<D>(context, rays, hats, near_sigma, n, live, heights);
  // A root outside the ball may be NaN (along a flat leaf) or infinite (m = 0), which a weight of 0
  // would not keep out of the sums: q^ takes its place.
  const Vec m = rays.scaleAt(near.sigma), from_center_sq = rays.distanceSq(near.sigma);
  const Vec m_sq = m * m;
  Mask counts = And(near.found, from_center_sq < set(context.blend_sq) * m_sq);
  Mask missed = AndNot(And(near.found, from_center_sq < m_sq), live);
  missed = And(missed, heights.at_hat > set(0.0f));
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
  const Vec reach = at.weight * set(leaf.radius);
  sums.shift = MulAdd(reach, moved, sums.shift);
  const Vec cover = blendWeight(context.kernel, root_sq * set(leaf.inverse_cover_sq));
  sums.coverage += IfThenElseZero(counts, cover);
  at.side = set(1.0f);
  if (!context.front_only) {
    at.side = IfThenElse(near.slope > set(0.0f), set(-1.0f), set(1.0f));
    sums.facing += IfThenElseZero(counts, at.side);
  }
  const Vec behind = context.front_only ? heights.behind : heights.behind * at.side;
  sums.clearance += IfThenElseZero(counts, reach * Min(behind, set(0.0f)));
  if (!AllFalse(missed)) addMissed(context, leaf, hats, heights.behind, missed, sums);
  const Mask better = at.weight > sums.best;
  sums.best = Max(sums.best, at.weight);
  sums.surfel = IfThenElse(better, setUint(leaf.surfel), sums.surfel);
  if (!leaf.trim.closed()) {
    sums.outside = MulAdd(at.weight, outsideOf(rays, at.sigma, at.inverse_m), sums.outside);
  }
  addDerivatives<D>(context, rays, block, at, sums);
  if constexpr (WithOffset) addOffset(rays, at, sums);
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes
HWY_AFTER_NAMESPACE();
#endif

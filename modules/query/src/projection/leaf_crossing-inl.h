// SPDX-License-Identifier: BSD-3-Clause
// Where the rays of sixteen points meet one leaf, and how much it counts there (paper, equation 6;
// theory.md, "Guards", Projection). The guard toggles: Highway compiles a kernel file once per
// instruction set.
#if defined(PCL_SLIM_LEAF_CROSSING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_LEAF_CROSSING_INL
#undef PCL_SLIM_LEAF_CROSSING_INL
#else
#define PCL_SLIM_LEAF_CROSSING_INL
#endif

#include "projection/leaf_frame-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

constexpr int kNewtonSteps = 3;
constexpr float kConverged = 3e-4f;  ///< of r: the step after one so short is below rounding
constexpr float kLeastSlope = 0.1f;  ///< of f along a unit ray: a grazing ray has no usable root
constexpr float kNoStep = 1e9f;      ///< used as the slope of a grazing ray

/** Lanes whose point has no normal, or one near the leaf's. */
HWY_INLINE Mask sameSide(const BlockPoints& points, const BlockLeaf& leaf, std::size_t i) {
  const Tag d;
  if (points.nx == nullptr) return Zero(d) == Zero(d);
  const Vec cosine = dot3(Load(d, points.nx + i), Load(d, points.ny + i), Load(d, points.nz + i),
                          set(leaf.w[0]), set(leaf.w[1]), set(leaf.w[2]));
  return cosine > set(points.min_dot);
}

/** The sign, +1 or -1, that turns b to the side of a sum so far, from sum . b; +1 where the sum is
 * 0. */
HWY_INLINE Vec alignment(Vec sum_dot_b) {
  return IfThenElse(sum_dot_b < Zero(Tag()), set(-1.0f), set(1.0f));
}

/** The leaf's weight at squared distances from its centre, in the lanes of mask. */
HWY_INLINE Vec weightOf(const BlockLeaf& leaf, const BlendRules& rules, Mask mask, Vec s_sq) {
  return IfThenElseZero(mask, set(leaf.variance_weight) * kernelWeight(rules.kernel, s_sq));
}

/** Lanes whose points, at squared distances from the centre, are in the leaf's ball on its side. */
HWY_INLINE Mask reached(const BlockPoints& points, const BlockLeaf& leaf, std::size_t i, Vec p_sq) {
  return And(p_sq < set(1.0f), sameSide(points, leaf, i));
}

/** Where rays p + t d meet the zero set of a leaf. */
struct Crossing {
  Vec t;
  Local q;        ///< p + t d
  Slopes<Vec> h;  ///< of the polynomial there
  Vec along_ray;  ///< grad f . d at the last step
};

/** Newton's steps from t = 0 on F(t) = f(p + t d): points are within noise of the leaf. */
template <int D>
HWY_INLINE Crossing crossingOf(const LeafCoefficients<D>& c, const Local& p,
                               const LeafHeights& heights, std::size_t i, const Local& ray,
                               Mask near) {
  const Tag d;
  Vec t = Zero(d), u = p.u, v = p.v, w = p.w, slope;
  Slopes<Vec> h = {Load(d, heights.height[0] + i), Load(d, heights.height[1] + i),
                   Load(d, heights.height[2] + i)};
  for (int step = 0; step < kNewtonSteps; ++step) {
    if (step > 0) h = slopesOf<D>(c, u, v);
    slope = NegMulAdd(h.u, ray.u, NegMulAdd(h.v, ray.v, ray.w));
    const Mask usable = Abs(slope) > set(kLeastSlope);
    const Vec change = (w - h.h) / IfThenElse(usable, slope, set(kNoStep));
    t -= change;
    u = MulAdd(t, ray.u, p.u);
    v = MulAdd(t, ray.v, p.v);
    w = MulAdd(t, ray.w, p.w);
    if (AllTrue(d, Or(Not(near), Abs(change) < set(kConverged)))) break;
  }
  return {t, {u, v, w}, slopesOf<D>(c, u, v), slope};
}

/** A leaf on the rays of some points. */
struct LeafHit {
  Mask near;  ///< lanes that it counts for
  Vec weight;
  Crossing root;
};

/** Meets the rays through points i, i + 1, ... with a leaf. */
template <int D>
HWY_INLINE LeafHit hitOf(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                         const LeafFrame& frame, const LeafCoefficients<D>& c,
                         const LeafHeights& heights, const BlockSums& sums, std::size_t i) {
  const Tag d;
  LeafHit hit;
  const Local p = {Load(d, heights.place[0] + i), Load(d, heights.place[1] + i),
                   Load(d, heights.place[2] + i)};
  const Vec p_sq = p.lengthSq();
  hit.near = reached(points, leaf, i, p_sq);
  if (AllFalse(d, hit.near)) return hit;
  const Local ray = frame.turn(Load(d, sums.direction[0] + i), Load(d, sums.direction[1] + i),
                               Load(d, sums.direction[2] + i));
  hit.root = crossingOf(c, p, heights, i, ray, hit.near);
  const Vec q_sq = hit.root.q.lengthSq();
  const Mask usable = Abs(hit.root.along_ray) > set(kLeastSlope);
  hit.near = And(hit.near, And(q_sq < set(1.0f), usable));
  Vec s_sq = q_sq;
  if (rules.guarded) {
    hit.near = And(hit.near, Abs(hit.root.t) <= set(leaf.max_offset));
    if (rules.oriented) hit.near = And(hit.near, hit.root.along_ray > Zero(d));
    s_sq = Max(p_sq, q_sq);
  }
  hit.weight = weightOf(leaf, rules, hit.near, s_sq);
  return hit;
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

// SPDX-License-Identifier: BSD-3-Clause
// Sixteen points of one block against one leaf: the blends of the paper's equations (6) to (8).
// Pass 1 gives each point its ray, along the blended normals; pass 2 meets the ray with the leaf
// and blends offset (6), gradient (7), Hessian (8, left) and third derivatives. theory.md,
// "Guards", Projection, explains which roots count and how much.
#include "projection/projection.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "projection/projection_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/surface/detail/kernel_math-inl.h"
#include "pcl_slim/surface/detail/trim_outside-inl.h"
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

HWY_INLINE void keep(const Vec (&values)[3], float (&columns)[3][16], std::size_t i) {
  for (int a = 0; a < 3; ++a) Store(values[a], Tag(), columns[a] + i);
}

template <int D>
void addDirectionsOf(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                     BlockSums& sums, LeafHeights& heights) {
  const Tag d;
  const LeafFrame frame(leaf);
  const LeafCoefficients<D> c(leaf.c);
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    const Local p = frame.place(points, i);
    keep({p.u, p.v, p.w}, heights.place, i);
    const Vec s_sq = p.lengthSq();
    Mask near = reached(points, leaf, i, s_sq);
    if (AllFalse(d, near)) continue;
    const Slopes<Vec> h = slopesOf<D>(c, p.u, p.v);
    keep({h.h, h.u, h.v}, heights.height, i);
    if (rules.guarded) {
      near = And(near, Abs(p.w - h.h) <= set(leaf.max_residual));
    }
    Vec g = weightOf(leaf, rules, near, s_sq);
    const Local n = gradientOf(h);
    Vec sum[3], normal[3];
    for (int a = 0; a < 3; ++a) {
      sum[a] = Load(d, sums.direction[a] + i);
      normal[a] = frame.back(a, n);
    }
    if (!rules.oriented) {
      g *= alignment(dot3(sum[0], sum[1], sum[2], normal[0], normal[1], normal[2]));
      addTo(sums.weight + i, near, g);
    }
    for (int a = 0; a < 3; ++a) addTo(sums.direction[a] + i, near, g * normal[a]);
  }
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

/** Adds a leaf's offset, gradient, Hessian and third derivatives (eqs. 6 to 8) with the weight g.
 */
template <int D>
HWY_INLINE void addBlend(const BlockLeaf& leaf, const LeafFrame& frame,
                         const LeafCoefficients<D>& c, const BlendRules& rules,
                         const Crossing& root, Mask near, Vec g, std::size_t i, BlockSums& sums) {
  addTo(sums.weight + i, near, g);
  addTo(sums.offset + i, near, g * (root.t * set(leaf.radius)));
  if (!leaf.trim.closed()) {
    addTo(sums.outside + i, near, g * outsideShares(Tag(), leaf.trim, root.q.u, root.q.v));
  }
  // Signed so that every gradient points along the ray.
  const Vec signed_g = rules.oriented ? g : g * alignment(root.along_ray);
  const Local n = gradientOf(root.h);
  for (int a = 0; a < 3; ++a) {
    addTo(sums.gradient[a] + i, near, signed_g * frame.back(a, n));
  }
  if (!rules.with_hessian) return;
  const Vec inverse = set(1.0f / leaf.radius);
  const Vec scale = IfThenElseZero(near, Neg(signed_g * inverse));
  addHessian(frame, c, root.q, near, scale, i, sums);
  if (!rules.with_third) return;
  addThird(frame, thirdDerivatives<D>(c, root.q.u, root.q.v), near, scale * inverse, i, sums);
}

template <int D>
void addIntersectionsOf(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                        const LeafHeights& heights, BlockSums& sums) {
  const Tag d;
  const LeafFrame frame(leaf);
  const LeafCoefficients<D> c(leaf.c);
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    const Local p = {Load(d, heights.place[0] + i), Load(d, heights.place[1] + i),
                     Load(d, heights.place[2] + i)};
    const Vec p_sq = p.lengthSq();
    Mask near = reached(points, leaf, i, p_sq);
    if (AllFalse(d, near)) continue;
    const Local ray = frame.turn(Load(d, sums.direction[0] + i), Load(d, sums.direction[1] + i),
                                 Load(d, sums.direction[2] + i));
    const Crossing root = crossingOf(c, p, heights, i, ray, near);
    const Vec q_sq = root.q.lengthSq();
    const Mask usable = Abs(root.along_ray) > set(kLeastSlope);
    near = And(near, And(q_sq < set(1.0f), usable));
    Vec s_sq = q_sq;
    if (rules.guarded) {
      near = And(near, Abs(root.t) <= set(leaf.max_offset));
      if (rules.oriented) near = And(near, root.along_ray > Zero(d));
      s_sq = Max(p_sq, q_sq);
    }
    if (AllFalse(d, near)) continue;
    const Vec g = weightOf(leaf, rules, near, s_sq);
    addBlend(leaf, frame, c, rules, root, near, g, i, sums);
  }
}

void addDirections(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                   BlockSums& sums, LeafHeights& heights) {
  forDegree(leaf.degree, [&](auto degree) HWY_ATTR {
    addDirectionsOf<degree()>(points, leaf, rules, sums, heights);
  });
}

void finishDirections(BlockSums& sums) {
  const Tag d;
  const Vec zero = Zero(d);
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    Vec n[3];
    for (int a = 0; a < 3; ++a) n[a] = Load(d, sums.direction[a] + i);
    const Vec length_sq = dot3(n[0], n[1], n[2], n[0], n[1], n[2]);
    const Mask usable = length_sq > set(1e-30f);
    // The side of most leaves, by weight.
    const Vec inverse =
        alignment(Load(d, sums.weight + i)) / Sqrt(IfThenElse(usable, length_sq, set(1.0f)));
    for (int a = 0; a < 3; ++a) {
      Store(IfThenElseZero(usable, n[a] * inverse), d, sums.direction[a] + i);
      Store(zero, d, sums.gradient[a] + i);
    }
    Store(zero, d, sums.weight + i);
    Store(zero, d, sums.offset + i);
    Store(zero, d, sums.outside + i);
    for (auto& column : sums.hessian) Store(zero, d, column + i);
    for (auto& column : sums.third) Store(zero, d, column + i);
  }
}

void addIntersections(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                      const LeafHeights& heights, BlockSums& sums) {
  forDegree(leaf.degree, [&](auto degree) HWY_ATTR {
    addIntersectionsOf<degree()>(points, leaf, rules, heights, sums);
  });
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(addDirections);
void addDirections(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                   BlockSums& sums, LeafHeights& heights) {
  HWY_DYNAMIC_DISPATCH(addDirections)(points, leaf, rules, sums, heights);
}

HWY_EXPORT(finishDirections);
void finishDirections(BlockSums& sums) {
  HWY_DYNAMIC_DISPATCH(finishDirections)(sums);
}

HWY_EXPORT(addIntersections);
void addIntersections(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                      const LeafHeights& heights, BlockSums& sums) {
  HWY_DYNAMIC_DISPATCH(addIntersections)(points, leaf, rules, heights, sums);
}

}  // namespace pcl_slim::detail::kernels
#endif

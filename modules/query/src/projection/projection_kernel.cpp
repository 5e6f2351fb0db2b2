// SPDX-License-Identifier: BSD-3-Clause
// Sixteen points of one block against one leaf: the blends of the paper's equations (6) to (8).
// Pass 1 gives each point its ray, along the blended normals; pass 2 meets the ray with the leaf
// and blends offset (6), gradient (7), Hessian (8, left) and third derivatives. theory.md, "Guards",
// Projection, explains which roots count and how much.
#include "pcl_slim/query/detail/projection_kernel.h"

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
constexpr float kNoStep = 1e9f;      ///< stands for the slope of a grazing ray

/** Lanes whose point has no normal, or one near the leaf's. */
HWY_INLINE Mask
sameSide(const BlockPoints& points, const BlockLeaf& leaf, std::size_t i)
{
  const Tag d;
  if (points.nx == nullptr) return hn::Eq(hn::Zero(d), hn::Zero(d));
  const Vec cosine =
      dot3(hn::Load(d, points.nx + i), hn::Load(d, points.ny + i), hn::Load(d, points.nz + i),
           set(leaf.w[0]), set(leaf.w[1]), set(leaf.w[2]));
  return hn::Gt(cosine, set(points.min_dot));
}

/** The sign, +1 or -1, that turns b to the side of a sum so far, from sum . b; +1 where the sum is 0. */
HWY_INLINE Vec
alignment(Vec sum_dot_b)
{
  return hn::IfThenElse(hn::Lt(sum_dot_b, hn::Zero(Tag())), set(-1.0f), set(1.0f));
}

/** The leaf's weight at squared distances from its centre, in the lanes of mask. */
HWY_INLINE Vec
weightOf(const BlockLeaf& leaf, const BlendRules& rules, Mask mask, Vec s_sq)
{
  return hn::IfThenElseZero(mask,
                            hn::Mul(set(leaf.variance_weight), kernelWeight(rules.kernel, s_sq)));
}

/** Lanes whose points, at squared distances from the centre, lie in the leaf's ball on its side. */
HWY_INLINE Mask
reached(const BlockPoints& points, const BlockLeaf& leaf, std::size_t i, Vec p_sq)
{
  return hn::And(hn::Lt(p_sq, set(1.0f)), sameSide(points, leaf, i));
}

HWY_INLINE void
keep(const Vec (&values)[3], float (&columns)[3][16], std::size_t i)
{
  for (int a = 0; a < 3; ++a) hn::Store(values[a], Tag(), columns[a] + i);
}

template <int D>
void
addDirectionsOf(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                BlockSums& sums, LeafHeights& heights)
{
  const Tag d;
  const LeafFrame frame(leaf);
  const HeightJets<D> jets(leaf.c);
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    const Local p = frame.place(points, i);
    keep({p.u, p.v, p.w}, heights.place, i);
    const Vec s_sq = p.lengthSq();
    Mask near = reached(points, leaf, i, s_sq);
    if (hn::AllFalse(d, near)) continue;
    Vec h, hu, hv;
    jets.gradient(p.u, p.v, h, hu, hv);
    keep({h, hu, hv}, heights.height, i);
    if (rules.guarded) {
      near = hn::And(near, hn::Le(hn::Abs(hn::Sub(p.w, h)), set(leaf.max_residual)));
    }
    Vec g = weightOf(leaf, rules, near, s_sq);
    const Local n = gradientOf(hu, hv);
    Vec sum[3], normal[3];
    for (int a = 0; a < 3; ++a) {
      sum[a] = hn::Load(d, sums.direction[a] + i);
      normal[a] = frame.back(a, n);
    }
    if (!rules.oriented) {
      g = hn::Mul(g, alignment(dot3(sum[0], sum[1], sum[2], normal[0], normal[1], normal[2])));
      addTo(sums.weight + i, near, g);
    }
    for (int a = 0; a < 3; ++a) addTo(sums.direction[a] + i, near, hn::Mul(g, normal[a]));
  }
}

/** Where rays p + t d meet the zero set of a leaf. */
struct Crossing {
  Vec t;
  Local q;        ///< p + t d
  Vec hu, hv;     ///< slopes of the polynomial there
  Vec along_ray;  ///< grad f . d at the last step
};

/** Newton's steps from t = 0 on F(t) = f(p + t d): points lie within noise of the leaf. */
template <int D>
HWY_INLINE Crossing
crossingOf(const HeightJets<D>& jets, const Local& p, const LeafHeights& heights, std::size_t i,
           const Local& ray, Mask near)
{
  const Tag d;
  Vec t = hn::Zero(d), u = p.u, v = p.v, w = p.w, slope;
  Vec h = hn::Load(d, heights.height[0] + i), hu = hn::Load(d, heights.height[1] + i),
      hv = hn::Load(d, heights.height[2] + i);
  for (int step = 0; step < kNewtonSteps; ++step) {
    if (step > 0) jets.gradient(u, v, h, hu, hv);
    slope = hn::NegMulAdd(hu, ray.u, hn::NegMulAdd(hv, ray.v, ray.w));
    const Mask usable = hn::Gt(hn::Abs(slope), set(kLeastSlope));
    const Vec change = hn::Div(hn::Sub(w, h), hn::IfThenElse(usable, slope, set(kNoStep)));
    t = hn::Sub(t, change);
    u = hn::MulAdd(t, ray.u, p.u);
    v = hn::MulAdd(t, ray.v, p.v);
    w = hn::MulAdd(t, ray.w, p.w);
    if (hn::AllTrue(d, hn::Or(hn::Not(near), hn::Lt(hn::Abs(change), set(kConverged))))) break;
  }
  jets.gradient(u, v, h, hu, hv);
  return {t, {u, v, w}, hu, hv, slope};
}

/** Adds a leaf's offset, gradient, Hessian and third derivatives (eqs. 6 to 8) with the weight g. */
template <int D>
HWY_INLINE void
addBlend(const BlockLeaf& leaf, const LeafFrame& frame, const HeightJets<D>& jets,
         const BlendRules& rules, const Crossing& root, Mask near, Vec g, std::size_t i,
         BlockSums& sums)
{
  addTo(sums.weight + i, near, g);
  addTo(sums.offset + i, near, hn::Mul(g, hn::Mul(root.t, set(leaf.radius))));
  if (!leaf.trim.closed()) {
    addTo(sums.outside + i, near, hn::Mul(g, outsideShares(Tag(), leaf.trim, root.q.u, root.q.v)));
  }
  // Signed so that every gradient points along the ray.
  const Vec signed_g = rules.oriented ? g : hn::Mul(g, alignment(root.along_ray));
  const Local n = gradientOf(root.hu, root.hv);
  for (int a = 0; a < 3; ++a) {
    addTo(sums.gradient[a] + i, near, hn::Mul(signed_g, frame.back(a, n)));
  }
  if (!rules.with_hessian) return;
  const Vec inverse = set(1.0f / leaf.radius);
  const Vec scale = hn::IfThenElseZero(near, hn::Neg(hn::Mul(signed_g, inverse)));
  addHessian(frame, jets, root.q, near, scale, i, sums);
  if (!rules.with_third) return;
  addThird(frame, jets.third(root.q.u, root.q.v), near, hn::Mul(scale, inverse), i, sums);
}

template <int D>
void
addIntersectionsOf(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                   const LeafHeights& heights, BlockSums& sums)
{
  const Tag d;
  const LeafFrame frame(leaf);
  const HeightJets<D> jets(leaf.c);
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    const Local p = {hn::Load(d, heights.place[0] + i), hn::Load(d, heights.place[1] + i),
                     hn::Load(d, heights.place[2] + i)};
    const Vec p_sq = p.lengthSq();
    Mask near = reached(points, leaf, i, p_sq);
    if (hn::AllFalse(d, near)) continue;
    const Local ray =
        frame.turn(hn::Load(d, sums.direction[0] + i), hn::Load(d, sums.direction[1] + i),
                   hn::Load(d, sums.direction[2] + i));
    const Crossing root = crossingOf(jets, p, heights, i, ray, near);
    const Vec q_sq = root.q.lengthSq();
    const Mask usable = hn::Gt(hn::Abs(root.along_ray), set(kLeastSlope));
    near = hn::And(near, hn::And(hn::Lt(q_sq, set(1.0f)), usable));
    Vec s_sq = q_sq;
    if (rules.guarded) {
      near = hn::And(near, hn::Le(hn::Abs(root.t), set(leaf.max_offset)));
      if (rules.oriented) near = hn::And(near, hn::Gt(root.along_ray, hn::Zero(d)));
      s_sq = hn::Max(p_sq, q_sq);
    }
    if (hn::AllFalse(d, near)) continue;
    const Vec g = weightOf(leaf, rules, near, s_sq);
    addBlend(leaf, frame, jets, rules, root, near, g, i, sums);
  }
}

void
addDirections(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
              BlockSums& sums, LeafHeights& heights)
{
  forDegree(leaf.degree, [&](auto degree) HWY_ATTR {
    addDirectionsOf<degree()>(points, leaf, rules, sums, heights);
  });
}

void
finishDirections(BlockSums& sums)
{
  const Tag d;
  const Vec zero = hn::Zero(d);
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    Vec n[3];
    for (int a = 0; a < 3; ++a) n[a] = hn::Load(d, sums.direction[a] + i);
    const Vec length_sq = dot3(n[0], n[1], n[2], n[0], n[1], n[2]);
    const Mask usable = hn::Gt(length_sq, set(1e-30f));
    // The side of most leaves, by weight.
    const Vec inverse = hn::Div(alignment(hn::Load(d, sums.weight + i)),
                                hn::Sqrt(hn::IfThenElse(usable, length_sq, set(1.0f))));
    for (int a = 0; a < 3; ++a) {
      hn::Store(hn::IfThenElseZero(usable, hn::Mul(n[a], inverse)), d, sums.direction[a] + i);
      hn::Store(zero, d, sums.gradient[a] + i);
    }
    hn::Store(zero, d, sums.weight + i);
    hn::Store(zero, d, sums.offset + i);
    hn::Store(zero, d, sums.outside + i);
    for (auto& column : sums.hessian) hn::Store(zero, d, column + i);
    for (auto& column : sums.third) hn::Store(zero, d, column + i);
  }
}

void
addIntersections(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                 const LeafHeights& heights, BlockSums& sums)
{
  forDegree(leaf.degree, [&](auto degree) HWY_ATTR {
    addIntersectionsOf<degree()>(points, leaf, rules, heights, sums);
  });
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(addDirections);
void
addDirections(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
              BlockSums& sums, LeafHeights& heights)
{
  HWY_DYNAMIC_DISPATCH(addDirections)(points, leaf, rules, sums, heights);
}

HWY_EXPORT(finishDirections);
void
finishDirections(BlockSums& sums)
{
  HWY_DYNAMIC_DISPATCH(finishDirections)(sums);
}

HWY_EXPORT(addIntersections);
void
addIntersections(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                 const LeafHeights& heights, BlockSums& sums)
{
  HWY_DYNAMIC_DISPATCH(addIntersections)(points, leaf, rules, heights, sums);
}

}  // namespace pcl_slim::detail::kernels
#endif

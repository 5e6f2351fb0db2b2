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
#include "projection/leaf_crossing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

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
    const LeafHit hit = hitOf(points, leaf, rules, frame, c, heights, sums, i);
    if (AllFalse(d, hit.near)) continue;
    addBlend(leaf, frame, c, rules, hit.root, hit.near, hit.weight, i, sums);
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

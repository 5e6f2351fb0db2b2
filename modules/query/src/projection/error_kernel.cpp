// SPDX-License-Identifier: BSD-3-Clause
// Sixteen points of one block against one leaf: what noise does to the leaf there, and how far it
// is from what was blended (docs/theory.md, "Standard errors").
#include <algorithm>
#include <cmath>

#include "projection/block_errors.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "projection/error_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/surface/detail/kernel_math-inl.h"
#include "projection/leaf_crossing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

/** A polynomial in s^2 from its highest term down. */
HWY_INLINE Vec roundValue(const std::vector<float>& terms, Vec s_sq) {
  Vec sum = Zero(Tag());
  for (const float term : terms) sum = MulAdd(sum, s_sq, set(term));
  return sum;
}

/** A polynomial of a degree in u and v, by Horner's rule. */
HWY_INLINE Vec openValue(const std::vector<float>& terms, int degree, Vec u, Vec v) {
  Vec sum = Zero(Tag());
  const float* term = terms.data();
  for (int i = degree; i >= 0; --i) {
    Vec row = Zero(Tag());
    for (int j = degree - i; j >= 0; --j) row = MulAdd(row, v, set(*term++));
    sum = MulAdd(sum, u, row);
  }
  return sum;
}

/** The root of a variance of one of the three quantities at (u, v). */
HWY_INLINE Vec deviationAt(const std::vector<float>& terms, int degree, bool round, const Local& q,
                           Vec s_sq) {
  if (terms.empty()) return Zero(Tag());
  const Vec value = round ? roundValue(terms, s_sq) : openValue(terms, degree, q.u, q.v);
  return Sqrt(Max(value, Zero(Tag())));
}

/** Mean curvature of a height over its plane, positive where the surface bends away from w [1/r].
 */
template <int D>
HWY_INLINE Vec meanCurvature(const LeafCoefficients<D>& c, const Crossing& root, Vec per_length) {
  const Slopes<Vec>& h = root.h;
  const SecondDerivatives<Vec> second = secondDerivatives<D>(c, root.q.u, root.q.v);
  const Vec one = set(1.0f);
  const Vec along = MulAdd(MulAdd(h.v, h.v, one), second.uu, MulAdd(h.u, h.u, one) * second.vv);
  const Vec mixed = (h.u * h.v) * (second.uv + second.uv);
  return set(-0.5f) * (along - mixed) * (per_length * per_length * per_length);
}

HWY_INLINE void addError(Vec weight, Mask near, Vec deviation, Vec off, std::size_t quantity,
                         std::size_t i, BlockErrors& block) {
  addTo(block.noise[quantity] + i, near, weight * deviation);
  const Vec weighted = weight * off;
  addTo(block.spread[quantity] + i, near, weighted * weighted);
}

template <int D>
void addErrorsOf(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
                 const LeafHeights& heights, const BlockSums& sums, const BlockBlend& blend,
                 BlockErrors& block) {
  const Tag d;
  const LeafFrame frame(leaf);
  const LeafCoefficients<D> c(leaf.c);
  const LeafErrors& errors = leaf.errors;
  const ErrorPolynomials& variances = *errors.variances;
  const Vec unit = set(errors.deviation);
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    const LeafHit hit = hitOf(points, leaf, rules, frame, c, heights, sums, i);
    if (AllFalse(d, hit.near)) continue;
    const Local& q = hit.root.q;
    const Vec s_sq = MulAdd(q.u, q.u, q.v * q.v);
    const Slopes<Vec>& h = hit.root.h;
    const Vec per_length = set(1.0f) / Sqrt(MulAdd(h.u, h.u, MulAdd(h.v, h.v, set(1.0f))));
    // A height's error moves a sloping surface by less.
    const Vec across = unit * per_length;
    addTo(block.weight + i, hit.near, hit.weight);
    const Vec height = deviationAt(variances.height, 2 * D, errors.round, q, s_sq);
    const Vec offset = hit.root.t * set(leaf.radius) - Load(d, blend.offset + i);
    addError(hit.weight, hit.near, across * height * set(leaf.radius), offset, 0, i, block);

    const Vec turned = rules.oriented ? set(1.0f) : alignment(hit.root.along_ray);
    const Local n = gradientOf(h);
    Vec off_sq = Zero(d);
    for (int a = 0; a < 3; ++a) {
      const Vec off = turned * (per_length * frame.back(a, n)) - Load(d, blend.normal[a] + i);
      off_sq = MulAdd(off, off, off_sq);
    }
    const Vec slope = deviationAt(variances.slope, 2 * D - 2, errors.round, q, s_sq);
    addError(hit.weight, hit.near, across * slope, Sqrt(off_sq), 1, i, block);

    if (!rules.with_hessian) continue;
    const Vec per_radius = set(1.0f / leaf.radius);
    const Vec own = turned * meanCurvature<D>(c, hit.root, per_length) * per_radius;
    const Vec bend = deviationAt(variances.bend, 2 * D - 4, errors.round, q, s_sq);
    addError(hit.weight, hit.near, set(0.5f) * across * bend * per_radius,
             own - Load(d, blend.curvature + i), 2, i, block);
  }
}

void addErrors(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
               const LeafHeights& heights, const BlockSums& sums, const BlockBlend& blend,
               BlockErrors& block) {
  forDegree(leaf.degree, [&](auto degree) HWY_ATTR {
    addErrorsOf<degree()>(points, leaf, rules, heights, sums, blend, block);
  });
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail {

namespace kernels {

HWY_EXPORT(addErrors);
void addErrors(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
               const LeafHeights& heights, const BlockSums& sums, const BlockBlend& blend,
               BlockErrors& block) {
  HWY_DYNAMIC_DISPATCH(addErrors)(points, leaf, rules, heights, sums, blend, block);
}

}  // namespace kernels

StandardErrors standardErrors(const BlockErrors& block, std::size_t i, bool with_curvature) {
  const float weight = block.weight[i];
  if (!(weight > 0)) return {};
  const auto error = [&](std::size_t k) {
    return std::sqrt(block.noise[k][i] * block.noise[k][i] + block.spread[k][i]) / weight;
  };
  return {error(0), error(1), with_curvature ? error(2) : 0.0f};
}

}  // namespace pcl_slim::detail
#endif

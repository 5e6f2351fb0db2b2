// SPDX-License-Identifier: BSD-3-Clause
// What leaves say of sixteen places side by side: distances to one leaf, to first order (f / |grad
// f| and the foot it leads to); its colours; principal curvatures and directions of blended
// gradients and Hessians (equation 8, left).
#include "probe/probe.h"

#include <algorithm>

#include "pcl_slim/leaf/detail/gates.h"
#include "pcl_slim/surface/surfel_color.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "probe/probe_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/leaf/detail/level_set-inl.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"
#include "projection/leaf_frame-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

/** A leaf beneath some places. */
struct SheetFeet {
  Mask near;      ///< lanes that it counts for
  Vec distance;   ///< in radii
  Vec weight;     ///< at the foot; 0 elsewhere
  Vec normal[3];  ///< unit, the block's axes
};

template <int D>
HWY_INLINE SheetFeet feetOf(const BlockPoints& points, const BlockLeaf& leaf,
                            const SheetRules& rules, const LeafFrame& frame,
                            const LeafCoefficients<D>& c, std::size_t i) {
  const Tag d;
  SheetFeet feet;
  const Local p = frame.place(points, i);
  feet.near = p.lengthSq() < set(rules.reach_sq);
  if (AllFalse(d, feet.near)) return feet;
  const Slopes<Vec> h = slopesOf<D>(c, p.u, p.v);
  const Vec slope_sq = MulAdd(h.u, h.u, MulAdd(h.v, h.v, set(1.0f)));
  const Vec inverse = set(1.0f) / Sqrt(slope_sq);
  const Vec f = p.w - h.h;
  feet.distance = f * inverse;
  const Vec t = feet.distance * inverse;
  const Local foot = {MulAdd(t, h.u, p.u), MulAdd(t, h.v, p.v), p.w - t};
  const Vec s_sq = foot.lengthSq();
  feet.near = And(feet.near, s_sq < set(1.0f));
  feet.near = And(feet.near, Abs(feet.distance) <= set(rules.most_distance));
  feet.weight =
      IfThenElseZero(feet.near, set(leaf.variance_weight) * kernelWeight(rules.kernel, s_sq));
  const Local n = {Neg(h.u * inverse), Neg(h.v * inverse), inverse};
  for (int a = 0; a < 3; ++a) feet.normal[a] = frame.back(a, n);
  return feet;
}

template <int D>
void findSheetsOf(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
                  BlockSheets& sheets) {
  const Tag d;
  const LeafFrame frame(leaf);
  const LeafCoefficients<D> c(leaf.c);
  const float soft = rules.softening * leaf.radius + rules.noise;
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    const SheetFeet feet = feetOf(points, leaf, rules, frame, c, i);
    if (AllFalse(d, feet.near)) continue;
    const Vec distance = feet.distance * set(leaf.radius);
    const Vec score = feet.weight / MulAdd(distance, distance, set(soft * soft + 1e-30f));
    const Vec best = Load(d, sheets.score + i);
    const Mask better = And(feet.near, score > best);
    Store(IfThenElse(better, score, best), d, sheets.score + i);
    Store(IfThenElse(better, distance, Load(d, sheets.distance + i)), d, sheets.distance + i);
    for (int a = 0; a < 3; ++a) {
      const Vec old = Load(d, sheets.normal[a] + i);
      Store(IfThenElse(better, feet.normal[a], old), d, sheets.normal[a] + i);
    }
  }
}

template <int D>
void addSheetsOf(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
                 BlockSheets& sheets) {
  const Tag d;
  const LeafFrame frame(leaf);
  const LeafCoefficients<D> c(leaf.c);
  const float most = rules.same_sheet * leaf.radius + rules.noise;
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    const SheetFeet feet = feetOf(points, leaf, rules, frame, c, i);
    Mask near = And(feet.near, Load(d, sheets.score + i) > Zero(d));
    if (AllFalse(d, near)) continue;
    const Vec cosine =
        dot3(feet.normal[0], feet.normal[1], feet.normal[2], Load(d, sheets.normal[0] + i),
             Load(d, sheets.normal[1] + i), Load(d, sheets.normal[2] + i));
    const Vec turn = IfThenElse(cosine < Zero(d), set(-1.0f), set(1.0f));
    if (rules.oriented) near = And(near, cosine > set(rules.min_dot));
    const Vec distance = turn * (feet.distance * set(leaf.radius));
    const Vec off = Abs(distance - Load(d, sheets.distance + i));
    near = And(near, off <= set(most));
    addTo(sheets.weight + i, near, feet.weight);
    addTo(sheets.distance_sum + i, near, feet.weight * distance);
    for (int a = 0; a < 3; ++a) {
      addTo(sheets.normal_sum[a] + i, near, feet.weight * (turn * feet.normal[a]));
    }
  }
}

void findSheets(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
                BlockSheets& sheets) {
  forDegree(leaf.degree,
            [&](auto degree) HWY_ATTR { findSheetsOf<degree()>(points, leaf, rules, sheets); });
}

void addSheets(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
               BlockSheets& sheets) {
  forDegree(leaf.degree,
            [&](auto degree) HWY_ATTR { addSheetsOf<degree()>(points, leaf, rules, sheets); });
}

/** SurfelTexture::weight() from the blend's. */
HWY_INLINE Vec textureWeight(Vec s_sq, Vec blend) {
  constexpr float kReach = SurfelTexture::kReach;
  const Vec inner = Max(set(1.0f) - s_sq * set(1 / (kReach * kReach)), Zero(Tag()));
  const Vec sq = inner * inner, fourth = sq * sq;
  return MulAdd(fourth, fourth, set(SurfelTexture::kOuterWeight) * blend);
}

/** Adds the colours that a leaf's texture has at the near ones of a vector of places. */
void addTextureColors(const SurfelTexture& texture, const Local& p, Mask near, Vec weight,
                      float radius, const float* widths, std::size_t first, BlockColors& colors) {
  const Tag d;
  alignas(64) float u[16], v[16], w[16];
  Store(p.u, d, u);
  Store(p.v, d, v);
  Store(IfThenElseZero(near, weight), d, w);
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
    if (!(w[k] > 0)) continue;
    const auto color = texture.meanAt(u[k], v[k], widths ? widths[first + k] / radius : 0.0f);
    for (std::size_t c = 0; c < 3; ++c) colors.sum[c][first + k] += w[k] * color[c];
  }
}

template <int D, WeightKernel K>
void addColorsOf(const BlockPoints& points, const BlockLeaf& leaf, const float* widths,
                 BlockColors& colors) {
  static_assert(kColorDegree == 2, "the terms below are those of degree 2");
  const Tag d;
  const LeafFrame frame(leaf);
  const LeafCoefficients<D> c(leaf.c);
  const ColorPolynomial color = decodeColor(leaf.color);
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    const Local p = frame.place(points, i);
    const Vec s_sq = p.lengthSq();
    const Mask near = s_sq < set(1.0f);
    if (AllFalse(d, near)) continue;
    const Vec h = slopesOf<D>(c, p.u, p.v).h;
    Mask own = And(near, Abs(p.w - h) <= set(kColorGate));
    if (points.nx) {
      const Vec cosine =
          dot3(Load(d, points.nx + i), Load(d, points.ny + i), Load(d, points.nz + i),
               set(leaf.w[0]), set(leaf.w[1]), set(leaf.w[2]));
      own = And(own, cosine > Zero(d));
    }
    const Vec share = IfThenElse(own, set(1.0f), set(kOtherSheet));
    const Vec blend = kernelWeight<K>(s_sq);
    const Vec weight =
        share * set(leaf.variance_weight) * (leaf.textured ? textureWeight(s_sq, blend) : blend);
    addTo(colors.weight + i, near, weight);
    Mask plain = near;
    if (!leaf.texture.empty()) {
      const Mask inner = s_sq < set(SurfelTexture::kReach * SurfelTexture::kReach);
      addTextureColors(leaf.texture, p, And(near, inner), weight, leaf.radius, widths, i, colors);
      plain = AndNot(inner, near);
      if (AllFalse(d, plain)) continue;
    }
    const Vec uu = p.u * p.u, uv = p.u * p.v, vv = p.v * p.v;
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const auto term = [&](std::size_t k) HWY_ATTR { return set(color[k][channel]); };
      const Vec slope = MulAdd(term(1), p.u, MulAdd(term(2), p.v, term(0)));
      const Vec value = MulAdd(term(3), uu, MulAdd(term(4), uv, MulAdd(term(5), vv, slope)));
      const Vec weighted = weight * Min(Max(value, Zero(d)), set(255.0f));
      addTo(colors.sum[channel] + i, plain, weighted);
    }
  }
}

void addColors(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
               const float* widths, BlockColors& colors) {
  forDegree(leaf.degree, [&](auto degree) HWY_ATTR {
    forKernel(rules.kernel, [&](auto kernel) HWY_ATTR {
      addColorsOf<degree(), kernel()>(points, leaf, widths, colors);
    });
  });
}

HWY_INLINE Triple<Vec> load(const float (&columns)[3][16], std::size_t i) {
  const Tag d;
  return {Load(d, columns[0] + i), Load(d, columns[1] + i), Load(d, columns[2] + i)};
}

HWY_INLINE void store(const Triple<Vec>& a, float (&columns)[3][16], std::size_t i) {
  const Tag d;
  Store(a.x, d, columns[0] + i);
  Store(a.y, d, columns[1] + i);
  Store(a.z, d, columns[2] + i);
}

void findPrincipals(const BlockSums& sums, BlockPrincipals& principals) {
  const Tag d;
  const Vec one = set(1.0f), zero = Zero(d);
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    const Vec weight = Load(d, sums.weight + i);
    const Vec per_weight = one / IfThenElse(weight > zero, weight, one);
    const Triple<Vec> g = load(sums.gradient, i);
    const Vec g_length = Sqrt(dot3(g, g));
    const Vec per_length = one / IfThenElse(g_length > zero, g_length, one);
    const Triple<Vec> n = {g.x * per_length, g.y * per_length, g.z * per_length};
    // The weights of gradient and Hessian cancel.
    const auto entry = [&](std::size_t k) HWY_ATTR { return Load(d, sums.hessian[k] + i); };
    const PrincipalCurvatures<Vec> found(n, per_length, entry);
    Store(g_length * per_weight, d, principals.length + i);
    store(n, principals.normal, i);
    Store(found.k1, d, principals.k1 + i);
    Store(found.k2, d, principals.k2 + i);
    store(found.direction1, principals.direction1, i);
    store(found.direction2, principals.direction2, i);
  }
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

void clearSheets(BlockSheets& sheets) {
  sheets = BlockSheets{};
}

HWY_EXPORT(findSheets);
void findSheets(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
                BlockSheets& sheets) {
  HWY_DYNAMIC_DISPATCH(findSheets)(points, leaf, rules, sheets);
}

HWY_EXPORT(addSheets);
void addSheets(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
               BlockSheets& sheets) {
  HWY_DYNAMIC_DISPATCH(addSheets)(points, leaf, rules, sheets);
}

HWY_EXPORT(addColors);
void addColors(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
               const float* widths, BlockColors& colors) {
  HWY_DYNAMIC_DISPATCH(addColors)(points, leaf, rules, widths, colors);
}

HWY_EXPORT(findPrincipals);
void findPrincipals(const BlockSums& sums, BlockPrincipals& principals) {
  HWY_DYNAMIC_DISPATCH(findPrincipals)(sums, principals);
}

}  // namespace pcl_slim::detail::kernels
#endif

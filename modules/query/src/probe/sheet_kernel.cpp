// SPDX-License-Identifier: BSD-3-Clause
// Distances from sixteen places to one leaf, to first order: f / |grad f| and the foot it leads to.
#include "probe/probe_kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "probe/sheet_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

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
HWY_INLINE SheetFeet
feetOf(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
       const LeafFrame& frame, const HeightJets<D>& jets, std::size_t i)
{
  const Tag d;
  SheetFeet feet;
  const Local p = frame.place(points, i);
  feet.near = p.lengthSq() < set(rules.reach_sq);
  if (AllFalse(d, feet.near)) return feet;
  Vec h, hu, hv;
  jets.gradient(p.u, p.v, h, hu, hv);
  const Vec slope_sq = MulAdd(hu, hu, MulAdd(hv, hv, set(1.0f)));
  const Vec inverse = set(1.0f) / Sqrt(slope_sq);
  const Vec f = p.w - h;
  feet.distance = f * inverse;
  const Vec t = feet.distance * inverse;
  const Local foot = {MulAdd(t, hu, p.u), MulAdd(t, hv, p.v), p.w - t};
  const Vec s_sq = foot.lengthSq();
  feet.near = And(feet.near, s_sq < set(1.0f));
  feet.near = And(feet.near, Abs(feet.distance) <= set(rules.most_distance));
  feet.weight =
      IfThenElseZero(feet.near, set(leaf.variance_weight) * kernelWeight(rules.kernel, s_sq));
  const Local n = {Neg(hu * inverse), Neg(hv * inverse), inverse};
  for (int a = 0; a < 3; ++a) feet.normal[a] = frame.back(a, n);
  return feet;
}

template <int D>
void
findSheetsOf(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
             BlockSheets& sheets)
{
  const Tag d;
  const LeafFrame frame(leaf);
  const HeightJets<D> jets(leaf.c);
  const float soft = rules.softening * leaf.radius + rules.noise;
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    const SheetFeet feet = feetOf(points, leaf, rules, frame, jets, i);
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
void
addSheetsOf(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
            BlockSheets& sheets)
{
  const Tag d;
  const LeafFrame frame(leaf);
  const HeightJets<D> jets(leaf.c);
  const float most = rules.same_sheet * leaf.radius + rules.noise;
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    const SheetFeet feet = feetOf(points, leaf, rules, frame, jets, i);
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

void
findSheets(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
           BlockSheets& sheets)
{
  forDegree(leaf.degree,
            [&](auto degree) HWY_ATTR { findSheetsOf<degree()>(points, leaf, rules, sheets); });
}

void
addSheets(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
          BlockSheets& sheets)
{
  forDegree(leaf.degree,
            [&](auto degree) HWY_ATTR { addSheetsOf<degree()>(points, leaf, rules, sheets); });
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

void
clearSheets(BlockSheets& sheets)
{
  sheets = BlockSheets{};
}

HWY_EXPORT(findSheets);
void
findSheets(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
           BlockSheets& sheets)
{
  HWY_DYNAMIC_DISPATCH(findSheets)(points, leaf, rules, sheets);
}

HWY_EXPORT(addSheets);
void
addSheets(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
          BlockSheets& sheets)
{
  HWY_DYNAMIC_DISPATCH(addSheets)(points, leaf, rules, sheets);
}

}  // namespace pcl_slim::detail::kernels
#endif

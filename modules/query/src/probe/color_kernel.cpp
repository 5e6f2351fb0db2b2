// SPDX-License-Identifier: BSD-3-Clause
// Colours of leaves at sixteen places of the surface.
#include "probe/probe_kernels.h"

#include "pcl_slim/query/detail/color_rules.h"
#include "pcl_slim/surface/surfel_color.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "probe/color_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/surface/detail/kernel_math-inl.h"
#include "projection/leaf_frame-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

template <int D, WeightKernel K>
void
addColorsOf(const BlockPoints& points, const BlockLeaf& leaf, BlockColors& colors)
{
  static_assert(kColorDegree == 2, "the terms below are those of degree 2");
  const Tag d;
  const LeafFrame frame(leaf);
  const HeightJets<D> jets(leaf.c);
  const ColorPolynomial color = decodeColor(leaf.color);
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    const Local p = frame.place(points, i);
    const Vec s_sq = p.lengthSq();
    const Mask near = s_sq < set(1.0f);
    if (AllFalse(d, near)) continue;
    Vec h, hu, hv;
    jets.gradient(p.u, p.v, h, hu, hv);
    Mask own = And(near, Abs(p.w - h) <= set(kColorGate));
    if (points.nx) {
      const Vec cosine =
          dot3(Load(d, points.nx + i), Load(d, points.ny + i), Load(d, points.nz + i),
               set(leaf.w[0]), set(leaf.w[1]), set(leaf.w[2]));
      own = And(own, cosine > Zero(d));
    }
    const Vec share = IfThenElse(own, set(1.0f), set(kOtherSheet));
    const Vec weight = share * set(leaf.variance_weight) * kernelWeight<K>(s_sq);
    const Vec uu = p.u * p.u, uv = p.u * p.v, vv = p.v * p.v;
    addTo(colors.weight + i, near, weight);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto term = [&](std::size_t k) HWY_ATTR { return set(color[k][c]); };
      const Vec slope = MulAdd(term(1), p.u, MulAdd(term(2), p.v, term(0)));
      const Vec value = MulAdd(term(3), uu, MulAdd(term(4), uv, MulAdd(term(5), vv, slope)));
      const Vec weighted = weight * Min(Max(value, Zero(d)), set(255.0f));
      addTo(colors.sum[c] + i, near, weighted);
    }
  }
}

void
addColors(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
          BlockColors& colors)
{
  forDegree(leaf.degree, [&](auto degree) HWY_ATTR {
    forKernel(rules.kernel,
              [&](auto kernel) HWY_ATTR { addColorsOf<degree(), kernel()>(points, leaf, colors); });
  });
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(addColors);
void
addColors(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
          BlockColors& colors)
{
  HWY_DYNAMIC_DISPATCH(addColors)(points, leaf, rules, colors);
}

}  // namespace pcl_slim::detail::kernels
#endif

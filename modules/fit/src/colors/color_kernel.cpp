// SPDX-License-Identifier: BSD-3-Clause
// Weighted sums of points' colours over the plane of a surfel.
#include "colors/color_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "colors/color_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "scan/ball_scan-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/** One channel of a group of points. */
HWY_INLINE Vec
loadChannel(const std::uint8_t* channel)
{
  const Tag d;
  const hn::Rebind<std::uint8_t, Tag> bytes;
  const hn::Rebind<std::int32_t, Tag> integers;
  return ConvertTo(d, PromoteTo(integers, LoadU(bytes, channel)));
}

template <int D, WeightKernel K>
ColorSums
sumColorsOf(const PointStore& store, const BlockList& blocks, const ColorBall& surfel,
            const ColorColumns& colors)
{
  const Tag d;
  const float scale = 1.0f / surfel.ball.radius;
  Vec axes[3][3];
  for (int a = 0; a < 3; ++a) {
    axes[0][a] = set(static_cast<float>(surfel.frame.u[a]) * scale);
    axes[1][a] = set(static_cast<float>(surfel.frame.v[a]) * scale);
    axes[2][a] = set(static_cast<float>(surfel.frame.w[a]) * scale);
  }
  const Height<D> height(surfel.c);
  const auto limit = set(surfel.max_residual), scale_sq = set(scale * scale);
  Vec moments[ColorSums::kMoments], channels[3][kColorTerms], weight_sq = Zero(d);
  for (auto& sum : moments) sum = Zero(d);
  for (auto& channel : channels)
    for (auto& sum : channel) sum = Zero(d);
  BallScan(store, surfel.ball).forEach(blocks, [&](std::size_t i, const Lanes& l) HWY_ATTR {
    const auto u = dot3(l.dx, l.dy, l.dz, axes[0][0], axes[0][1], axes[0][2]);
    const auto v = dot3(l.dx, l.dy, l.dz, axes[1][0], axes[1][1], axes[1][2]);
    const auto w = dot3(l.dx, l.dy, l.dz, axes[2][0], axes[2][1], axes[2][2]);
    const auto near = And(l.kept, Abs(w - height(u, v)) <= limit);
    if (AllFalse(d, near)) return;
    const auto weight = IfThenElseZero(near, kernelWeight<K>(l.d_sq * scale_sq));
    // Padding is far away; its products may be infinite, and count as 0.
    const auto u_near = IfThenElseZero(near, u), v_near = IfThenElseZero(near, v);
    weight_sq = MulAdd(weight, weight, weight_sq);
    addGradedTerms<2 * kColorDegree>(weight, u_near, v_near, moments);
    for (int c = 0; c < 3; ++c) {
      const auto color = loadChannel(colors[static_cast<std::size_t>(c)].data() + i);
      addGradedTerms<kColorDegree>(weight * color, u_near, v_near, channels[c]);
    }
  });
  ColorSums sums;
  sums.weight_sq = sumLanes(weight_sq);
  for (std::size_t k = 0; k < sums.moments.size(); ++k) sums.moments[k] = sumLanes(moments[k]);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < kColorTerms; ++k) sums.channels[c][k] = sumLanes(channels[c][k]);
  }
  return sums;
}

ColorSums
sumColors(const PointStore& store, const BlockList& blocks, const ColorBall& surfel,
          WeightKernel kernel, const ColorColumns& colors)
{
  ColorSums sums;
  forDegree(surfel.degree, [&](auto degree) HWY_ATTR {
    sums = kernel == WeightKernel::kGaussian
               ? sumColorsOf<degree(), WeightKernel::kGaussian>(store, blocks, surfel, colors)
               : sumColorsOf<degree(), WeightKernel::kPower7>(store, blocks, surfel, colors);
  });
  return sums;
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(sumColors);

ColorSums
sumColors(const PointStore& store, const BlockList& blocks, const ColorBall& surfel,
          WeightKernel kernel, const ColorColumns& colors)
{
  return HWY_DYNAMIC_DISPATCH(sumColors)(store, blocks, surfel, kernel, colors);
}

}  // namespace pcl_slim::detail::kernels
#endif

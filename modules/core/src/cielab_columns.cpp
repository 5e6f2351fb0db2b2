// SPDX-License-Identifier: BSD-3-Clause
// CIELAB of many colours, compiled for each instruction set.
#include "cielab_columns.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cielab_columns.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;

/** Cube root of q from 216/24389 on, the tangent line below (CIE 15). */
template <typename V>
V labRoot(Floats d, V q) {
  const auto threshold = Set(d, 216.0f / 24389.0f);
  const hn::RebindToSigned<Floats> di;
  const auto high = Max(q, threshold);
  // 1/cbrt by its exponent, within 4 %; three steps of Newton reach a float's last bits.
  const auto bits = ConvertTo(d, BitCast(di, high));
  const auto third = ConvertTo(di, bits * Set(d, 1.0f / 3.0f));
  auto r = BitCast(d, Set(di, 0x54a2fa8c) - third);
  const auto q_third = high * Set(d, 1.0f / 3.0f);
  for (int step = 0; step < 3; ++step) {
    const auto r2 = r * r;
    r = r * Set(d, 4.0f / 3.0f) - q_third * (r2 * r2);
  }
  const auto root = high * r * r;
  const auto line = q * Set(d, 841.0f / 108.0f) + Set(d, 16.0f / 116.0f);
  return IfThenElse(q > threshold, root, line);
}

void labOfLinear(const float to_xyz[9], float* r, float* g, float* b, std::size_t n) {
  const Floats d;
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const auto red = Load(d, r + i), green = Load(d, g + i), blue = Load(d, b + i);
    const auto rootOf = [&](const float* row) {
      const auto q = Set(d, row[0]) * red + Set(d, row[1]) * green + Set(d, row[2]) * blue;
      return labRoot(d, q);
    };
    const auto fx = rootOf(to_xyz), fy = rootOf(to_xyz + 3), fz = rootOf(to_xyz + 6);
    Store(fy * Set(d, 116.0f) - Set(d, 16.0f), d, r + i);
    Store((fx - fy) * Set(d, 500.0f), d, g + i);
    Store((fy - fz) * Set(d, 200.0f), d, b + i);
  }
}

}  // namespace pcl_slim::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail {

HWY_EXPORT(labOfLinear);

void labOfLinear(const float to_xyz[9], float* r, float* g, float* b, std::size_t n) {
  HWY_DYNAMIC_DISPATCH(labOfLinear)(to_xyz, r, g, b, n);
}

}  // namespace pcl_slim::detail
#endif

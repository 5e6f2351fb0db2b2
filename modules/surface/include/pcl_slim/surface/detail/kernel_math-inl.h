// SPDX-License-Identifier: BSD-3-Clause
// Vector helpers of the kernels. Highway compiles a kernel file once per instruction set, so
// the guard toggles instead of shutting later inclusions out.
#if defined(PCL_SLIM_KERNEL_MATH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_KERNEL_MATH_INL
#undef PCL_SLIM_KERNEL_MATH_INL
#else
#define PCL_SLIM_KERNEL_MATH_INL
#endif

#include "hwy/contrib/math/math-inl.h"
#include "hwy/highway.h"
#include "pcl_slim/core/detail/graded_terms-inl.h"
#include "pcl_slim/core/detail/lane_packing-inl.h"
#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/surface/weight_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, 16>;
using Vec = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

/** Calls body(constant D) for the degree D of a polynomial, 1 to 4. */
template <typename Body>
HWY_INLINE void
forDegree(int degree, const Body& body)
{
  switch (degree) {
    case 1: return body(std::integral_constant<int, 1>());
    case 2: return body(std::integral_constant<int, 2>());
    case 3: return body(std::integral_constant<int, 3>());
    default: return body(std::integral_constant<int, 4>());
  }
}

HWY_INLINE Vec
dot3(Vec ax, Vec ay, Vec az, Vec bx, Vec by, Vec bz)
{
  return hn::MulAdd(ax, bx, hn::MulAdd(ay, by, hn::Mul(az, bz)));
}

HWY_INLINE double
sumLanes(Vec v)
{
  return hn::GetLane(hn::SumOfLanes(Tag(), v));
}

/** G at squared relative distances; 0 from 1 on. */
template <WeightKernel K>
HWY_INLINE Vec
kernelWeight(Vec s_sq)
{
  const Tag d;
  const auto t = hn::Max(hn::Zero(d), hn::Sub(hn::Set(d, 1.0f), s_sq));
  if constexpr (K == WeightKernel::kGaussian) {
    const auto inner = hn::Exp(d, hn::Mul(hn::Set(d, -8.0f), hn::Min(s_sq, hn::Set(d, 1.0f))));
    const auto rest = hn::Sub(hn::Set(d, 1.0f), hn::Sqrt(hn::Min(s_sq, hn::Set(d, 1.0f))));
    const auto rest_sq = hn::Mul(rest, rest);
    const auto outer = hn::Mul(hn::Set(d, 2.16536453f), hn::Mul(rest_sq, rest_sq));  // 16 e^-2
    return hn::IfThenElse(hn::Lt(s_sq, hn::Set(d, 0.25f)), inner, outer);
  } else {
    const auto t2 = hn::Mul(t, t);
    if constexpr (K == WeightKernel::kPower2) return t2;
    const auto t4 = hn::Mul(t2, t2);
    if constexpr (K == WeightKernel::kPower4) return t4;
    return hn::Mul(hn::Mul(t4, t2), t);
  }
}

/** target += g in the lanes of mask; the other lanes' memory, which may belong to another thread,
 * is not written. */
HWY_INLINE void
addMasked(Vec g, Mask mask, float* target)
{
  const Tag d;
#if HWY_TARGET <= HWY_AVX2
  hn::BlendedStore(hn::Add(hn::LoadU(d, target), g), mask, d, target);
#else
  HWY_ALIGN float values[16];
  HWY_ALIGN std::uint8_t bits[8] = {};
  hn::Store(g, d, values);
  hn::StoreMaskBits(d, mask, bits);
  for (std::uint32_t m = bits[0] | static_cast<std::uint32_t>(bits[1]) << 8; m != 0; m &= m - 1) {
    target[__builtin_ctz(m)] += values[__builtin_ctz(m)];
  }
#endif
}

/** The polynomial h(u, v) of degree D, coefficients in registers. */
template <int D>
class Height {
 public:
  template <typename T>
  explicit Height(const T* c)
  {
    for (int k = 0; k < numCoefficients(D); ++k) c_[k] = hn::Set(Tag(), static_cast<float>(c[k]));
  }

  HWY_INLINE Vec operator()(Vec u, Vec v) const
  {
    // Horner in u over polynomials in v, from the highest power of u down.
    Vec h = row(v, std::integral_constant<int, D>());
    unrolled<D>([&](auto step) HWY_ATTR {
      h = hn::MulAdd(h, u, row(v, std::integral_constant<int, D - 1 - step()>()));
    });
    return h;
  }

 private:
  /** Coefficient of u^I v^J in graded order. */
  static constexpr int index(int i, int j) { return (i + j) * (i + j + 1) / 2 + j; }

  /** sum_j c_ij v^j for a fixed power i of u. */
  template <int I>
  HWY_INLINE Vec row(Vec v, std::integral_constant<int, I>) const
  {
    Vec r = c_[index(I, D - I)];
    unrolled<D - I>([&](auto step)
                        HWY_ATTR { r = hn::MulAdd(r, v, c_[index(I, D - I - 1 - step())]); });
    return r;
  }

  Vec c_[numCoefficients(D)];
};

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

// SPDX-License-Identifier: BSD-3-Clause
// Vector helpers of the kernels. Highway compiles a kernel file once per instruction set, so the
// guard toggles instead of shutting later inclusions out. Kernels write Highway's operators, and
// call its functions by their bare names, found through their arguments; hn:: names types, numbers
// of lanes, and functions with template arguments. Masks have no operators.
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
#include "pcl_slim/leaf/detail/numbers-inl.h"
#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/surface/weight_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, 16>;
using Vec = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

/** The same number in every lane. */
HWY_INLINE Vec set(float value) {
  return Set(Tag(), value);
}

/** body(constant D) for the degree D of a polynomial, 1 to 4. */
template <typename Body>
HWY_INLINE decltype(auto) forDegree(int degree, const Body& body) {
  switch (degree) {
    case 1: return body(std::integral_constant<int, 1>());
    case 2: return body(std::integral_constant<int, 2>());
    case 3: return body(std::integral_constant<int, 3>());
    default: return body(std::integral_constant<int, 4>());
  }
}

/** body(constant K) for a kernel K. */
template <typename Body>
HWY_INLINE decltype(auto) forKernel(WeightKernel kernel, const Body& body) {
  switch (kernel) {
    case WeightKernel::kPower2:
      return body(std::integral_constant<WeightKernel, WeightKernel::kPower2>());
    case WeightKernel::kPower4:
      return body(std::integral_constant<WeightKernel, WeightKernel::kPower4>());
    case WeightKernel::kPower7:
      return body(std::integral_constant<WeightKernel, WeightKernel::kPower7>());
    default: return body(std::integral_constant<WeightKernel, WeightKernel::kGaussian>());
  }
}

HWY_INLINE double sumLanes(Vec v) {
  return GetLane(SumOfLanes(Tag(), v));
}

/** Coordinates in a frame, in units of a radius. */
struct ScaledAxes {
  Triple<Vec> u, v, w;

  ScaledAxes(const LocalFrame& frame, double radius)
      : u(over(frame.u, radius)), v(over(frame.v, radius)), w(over(frame.w, radius)) {}
  HWY_INLINE Triple<Vec> turn(const Triple<Vec>& p) const {
    return {dot3(p, u), dot3(p, v), dot3(p, w)};
  }

 private:
  static Triple<Vec> over(const std::array<double, 3>& axis, double radius) {
    const double scale = 1.0 / radius;
    const float values[3] = {static_cast<float>(axis[0] * scale),
                             static_cast<float>(axis[1] * scale),
                             static_cast<float>(axis[2] * scale)};
    return tripleOf<Vec>(values);
  }
};

/** G at squared relative distances; 0 from 1 on. */
template <WeightKernel K, class V>
HWY_INLINE V kernelWeight(V s_sq) {
  const hn::DFromV<V> d;
  const V one = Set(d, 1.0f);
  if constexpr (K == WeightKernel::kGaussian) {
    const V within = Min(s_sq, one);
    const V inner = Exp(d, Set(d, -8.0f) * within);
    const V rest = one - Sqrt(within), rest_sq = rest * rest;
    const V outer = Set(d, 2.16536453f) * (rest_sq * rest_sq);  // 16 e^-2
    return IfThenElse(s_sq < Set(d, 0.25f), inner, outer);
  } else {
    const V t = Max(Zero(d), one - s_sq), t2 = t * t;
    if constexpr (K == WeightKernel::kPower2) return t2;
    const V t4 = t2 * t2;
    if constexpr (K == WeightKernel::kPower4) return t4;
    return t4 * t2 * t;
  }
}

/** The same for a kernel known at run time. */
template <class V>
HWY_INLINE V kernelWeight(WeightKernel kernel, V s_sq) {
  return forKernel(kernel, [&](auto k) HWY_ATTR { return kernelWeight<k()>(s_sq); });
}

/** target += g in the lanes of mask; the other lanes' memory, which may belong to another thread,
 * is not written. */
HWY_INLINE void addMasked(Vec g, Mask mask, float* target) {
  const Tag d;
#if HWY_TARGET <= HWY_AVX2
  BlendedStore(LoadU(d, target) + g, mask, d, target);
#else
  HWY_ALIGN float values[16];
  HWY_ALIGN std::uint8_t bits[8] = {};
  Store(g, d, values);
  StoreMaskBits(d, mask, bits);
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
  explicit Height(const T* c) {
    for (int k = 0; k < numCoefficients(D); ++k) c_[k] = set(static_cast<float>(c[k]));
  }

  HWY_INLINE Vec operator()(Vec u, Vec v) const {
    // Horner in u over polynomials in v, from the highest power of u down.
    Vec h = row(v, std::integral_constant<int, D>());
    unrolled<D>([&](auto step) HWY_ATTR {
      h = MulAdd(h, u, row(v, std::integral_constant<int, D - 1 - step()>()));
    });
    return h;
  }

 private:
  /** Coefficient of u^I v^J in graded order. */
  static constexpr int index(int i, int j) { return (i + j) * (i + j + 1) / 2 + j; }

  /** sum_j c_ij v^j for a fixed power i of u. */
  template <int I>
  HWY_INLINE Vec row(Vec v, std::integral_constant<int, I>) const {
    Vec r = c_[index(I, D - I)];
    unrolled<D - I>([&](auto step)
                        HWY_ATTR { r = MulAdd(r, v, c_[index(I, D - I - 1 - step())]); });
    return r;
  }

  Vec c_[numCoefficients(D)];
};

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

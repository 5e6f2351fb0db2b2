// SPDX-License-Identifier: BSD-3-Clause
// Sums of the monomials of two variables. The guard toggles: Highway compiles a kernel file once
// per instruction set.
#if defined(PCL_SLIM_GRADED_TERMS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_GRADED_TERMS_INL
#undef PCL_SLIM_GRADED_TERMS_INL
#else
#define PCL_SLIM_GRADED_TERMS_INL
#endif

#include <utility>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

template <typename Body, int... I>
HWY_INLINE void unrolledOver(const Body& body, std::integer_sequence<int, I...>) {
  (body(std::integral_constant<int, I>()), ...);
}

/** Calls body(constant 0) ... body(constant N - 1), unrolled at compile time. */
template <int N, typename Body>
HWY_INLINE void unrolled(const Body& body) {
  unrolledOver(body, std::make_integer_sequence<int, N>());
}

/** sums[k] += factor u^i v^j for all monomials up to degree D, in graded order: 1; u, v; u^2, uv,
 * v^2 ... */
template <int D, class V>
HWY_INLINE void addGradedTerms(V factor, V u, V v, V* sums) {
  V terms[D + 1] = {factor};  // of one degree, the highest power of u first
  sums[0] += factor;
  unrolled<D>([&](auto step) HWY_ATTR {
    constexpr int kDegree = step() + 1, kFirst = kDegree * (kDegree + 1) / 2;
    terms[kDegree] = terms[kDegree - 1] * v;
    unrolled<kDegree>([&](auto j) HWY_ATTR { terms[j()] *= u; });
    unrolled<kDegree + 1>([&](auto j) HWY_ATTR { sums[kFirst + j()] += terms[j()]; });
  });
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

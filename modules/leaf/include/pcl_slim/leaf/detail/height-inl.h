// SPDX-License-Identifier: BSD-3-Clause
// A leaf's f = w - h(u, v) at a point, (u, v, w) in the leaf's frame and in radii: h and its
// derivatives, and those of f in other axes (paper, equations 7 and 8). The guard toggles: Highway
// compiles a kernel file once per instruction set.
#if defined(PCL_SLIM_HEIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_HEIGHT_INL
#undef PCL_SLIM_HEIGHT_INL
#else
#define PCL_SLIM_HEIGHT_INL
#endif

#include "pcl_slim/core/symmetric.h"
#include "pcl_slim/leaf/detail/numbers-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

// D is the degree of h, c(k) its coefficient k in graded order: 1; u, v; u^2, uv, v^2 ...

template <class V>
struct Slopes {
  V h, u, v;
};
template <class V>
struct SecondDerivatives {
  V uu, uv, vv;
};
template <class V>
struct ThirdDerivatives {
  V uuu, uuv, uvv, vvv;
};

/** h and its gradient. */
template <int D, class V, class C>
HWY_INLINE Slopes<V> slopesOf(const C& c, V u, V v) {
  V h = MulAdd(c(1), u, MulAdd(c(2), v, c(0))), hu = c(1), hv = c(2);
  if constexpr (D >= 2) {
    h = MulAdd(u, MulAdd(c(3), u, c(4) * v), MulAdd(c(5) * v, v, h));
    hu = MulAdd(c(3) + c(3), u, MulAdd(c(4), v, hu));
    hv = MulAdd(c(5) + c(5), v, MulAdd(c(4), u, hv));
  }
  if constexpr (D >= 3) {
    const V uu = u * u, uv = u * v, vv = v * v, three = number<V>(3);
    h = MulAdd(uu, MulAdd(c(6), u, c(7) * v), MulAdd(vv, MulAdd(c(8), u, c(9) * v), h));
    hu = MulAdd(three * c(6), uu, MulAdd(c(7) + c(7), uv, MulAdd(c(8), vv, hu)));
    hv = MulAdd(c(7), uu, MulAdd(c(8) + c(8), uv, MulAdd(three * c(9), vv, hv)));
  }
  if constexpr (D >= 4) {
    const V uu = u * u, uv = u * v, vv = v * v, three = number<V>(3), four = number<V>(4);
    const V high = MulAdd(c(10), uu, MulAdd(c(11), uv, c(12) * vv));
    h = MulAdd(uu, high, MulAdd(vv, MulAdd(c(13), uv, c(14) * vv), h));
    hu += MulAdd(uu, MulAdd(four * c(10), u, three * c(11) * v),
                 vv * MulAdd(c(12) + c(12), u, c(13) * v));
    hv += MulAdd(uu, MulAdd(c(11), u, (c(12) + c(12)) * v),
                 vv * MulAdd(three * c(13), u, four * c(14) * v));
  }
  return {h, hu, hv};
}

template <int D, class V, class C>
HWY_INLINE SecondDerivatives<V> secondDerivatives(const C& c, V u, V v) {
  const V two = number<V>(2), three = number<V>(3), four = number<V>(4), six = number<V>(6),
          twelve = number<V>(12);
  V huu = number<V>(0), huv = huu, hvv = huu;
  if constexpr (D >= 2) {
    huu = two * c(3);
    huv = c(4);
    hvv = two * c(5);
  }
  if constexpr (D >= 3) {
    huu = MulAdd(six * c(6), u, MulAdd(two * c(7), v, huu));
    huv = MulAdd(two * c(7), u, MulAdd(two * c(8), v, huv));
    hvv = MulAdd(two * c(8), u, MulAdd(six * c(9), v, hvv));
  }
  if constexpr (D >= 4) {
    const V uu = u * u, uv = u * v, vv = v * v;
    huu += MulAdd(twelve * c(10), uu, MulAdd(six * c(11), uv, two * c(12) * vv));
    huv += MulAdd(three * c(11), uu, MulAdd(four * c(12), uv, three * c(13) * vv));
    hvv += MulAdd(two * c(12), uu, MulAdd(six * c(13), uv, twelve * c(14) * vv));
  }
  return {huu, huv, hvv};
}

template <int D, class V, class C>
HWY_INLINE ThirdDerivatives<V> thirdDerivatives(const C& c, V u, V v) {
  const V zero = number<V>(0);
  ThirdDerivatives<V> h{zero, zero, zero, zero};
  if constexpr (D >= 3) {
    const V two = number<V>(2), six = number<V>(6);
    h = {six * c(6), two * c(7), two * c(8), six * c(9)};
  }
  if constexpr (D >= 4) {
    const V four = number<V>(4), six = number<V>(6), many = number<V>(24);
    h.uuu += MulAdd(many * c(10), u, six * c(11) * v);
    h.uuv += MulAdd(six * c(11), u, four * c(12) * v);
    h.uvv += MulAdd(four * c(12), u, six * c(13) * v);
    h.vvv += MulAdd(six * c(13), u, many * c(14) * v);
  }
  return h;
}

// Derivatives of f in the axes that the frame's own, u, v and w, are given in.

/** The gradient w - hu u - hv v. */
template <class V>
HWY_INLINE void gradientIn(const V* u, const V* v, const V* w, const Slopes<V>& h, V* gradient) {
  for (int a = 0; a < 3; ++a) gradient[a] = NegMulAdd(h.u, u[a], NegMulAdd(h.v, v[a], w[a]));
}

/** The Hessian huu u u^T + huv (u v^T + v u^T) + hvv v v^T of h; that of f is its negative. */
template <class V>
HWY_INLINE void hessianIn(const V* u, const V* v, const SecondDerivatives<V>& h, V* hessian) {
  for (int a = 0; a < 3; ++a) {
    const V along_u = MulAdd(h.uu, u[a], h.uv * v[a]), along_v = MulAdd(h.uv, u[a], h.vv * v[a]);
    for (int b = a; b < 3; ++b) {
      hessian[kSymmetricEntry[a][b]] = MulAdd(along_u, u[b], along_v * v[b]);
    }
  }
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

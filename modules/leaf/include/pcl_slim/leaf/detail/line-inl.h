// SPDX-License-Identifier: BSD-3-Clause
// A leaf's f along a line, in the leaf's frame and in radii. The guard toggles: Highway compiles a
// kernel file once per instruction set.
#if defined(PCL_SLIM_LINE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_LINE_INL
#undef PCL_SLIM_LINE_INL
#else
#define PCL_SLIM_LINE_INL
#endif

#include "pcl_slim/leaf/detail/numbers-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

/** f along p + s d as a polynomial of degree D in s: a[0] + a[1] s + ... Its derivative is
 * grad f . d: where it falls, the line enters the surface from the side the normal points to. */
template <int D, class V>
struct LinePolynomial {
  V a[5];
  Triple<V> p, d;

  /** \param[in] c c(k) is coefficient k of h, in graded order */
  template <class C>
  HWY_INLINE LinePolynomial(const C& c, const Triple<V>& point, const Triple<V>& direction)
      : p(point), d(direction) {
    // Heights first: h(u + s du, v + s dv) = a[0] + a[1] s + ...
    a[0] = MulAdd(c(1), p.x, MulAdd(c(2), p.y, c(0)));
    a[1] = MulAdd(c(1), d.x, c(2) * d.y);
    a[2] = a[3] = a[4] = number<V>(0);
    if constexpr (D >= 2) addQuadratic(c);
    if constexpr (D >= 3) addCubic(c);
    if constexpr (D >= 4) addQuartic(c);
    a[0] = p.z - a[0];
    a[1] = d.z - a[1];
    for (int i = 2; i <= D; ++i) a[i] = Neg(a[i]);
  }

  HWY_INLINE V slope(V s) const {
    V sum = number<V>(D) * a[D];
    for (int i = D - 1; i >= 1; --i) sum = MulAdd(sum, s, number<V>(i) * a[i]);
    return sum;
  }
  HWY_INLINE V value(V s) const {
    V sum = a[D];
    for (int i = D - 1; i >= 0; --i) sum = MulAdd(sum, s, a[i]);
    return sum;
  }

  /** Lanes in which Newton's steps from s = 0 are sure to lead to the nearest root, as
   * obviousRoot(). */
  HWY_INLINE auto leadsToRoot() const {
    const V two = number<V>(2), reach = two * Abs(a[0]), steep = Abs(a[1]);
    const V m = reach / steep;
    const V outer = MulAdd(number<V>(12) * m, Abs(a[4]), number<V>(6) * Abs(a[3]));
    const V bend = MulAdd(m, outer, two * Abs(a[2]));
    return And(reach < steep, two * bend * reach < steep * steep);
  }

  /** Lanes in which a polynomial of degree 3 or 4 may have a root from low to high, by the signs
   * of its Bernstein coefficients, as toBernstein(). */
  HWY_INLINE auto mayHaveRoots(V low, V high) const {
    static_assert(D == 3 || D == 4);
    V c[D + 1];
    for (int i = 0; i <= D; ++i) c[i] = a[i];
    for (int i = 0; i < D; ++i) {
      for (int j = D - 1; j >= i; --j) c[j] = MulAdd(low, c[j + 1], c[j]);
    }
    const V span = high - low;
    V power = span;
    for (int i = 1; i <= D; ++i) {
      c[i] *= power;
      power *= span;
    }
    V least = c[0], most = c[0];
    const auto take = [&](V b) HWY_ATTR {
      least = Min(least, b);
      most = Max(most, b);
    };
    if constexpr (D == 3) {
      const V third = number<V>(1.0 / 3.0);
      take(MulAdd(third, c[1], c[0]));
      take(MulAdd(third, c[1] + c[1] + c[2], c[0]));
      take(c[0] + c[1] + (c[2] + c[3]));
    } else {
      const V half = number<V>(0.5), more = number<V>(0.75);
      take(MulAdd(number<V>(0.25), c[1], c[0]));
      take(MulAdd(half, c[1], MulAdd(number<V>(1.0 / 6.0), c[2], c[0])));
      take(MulAdd(more, c[1], c[0]) + MulAdd(half, c[2], times(0.25, c[3])));
      take(c[0] + c[1] + (c[2] + (c[3] + c[4])));
    }
    // A few roundings of room: a root at the very end is to be found as well.
    const V room = number<V>(1e-6);
    return And(least <= room, most >= Neg(room));
  }

 private:
  // A form F of degree k along p + s d is sum_i s^i F_i, where F_i is its polar form with i of
  // its k arguments equal to d, counted with multiplicity.

  static HWY_INLINE V sum(V x, V u, V y, V v) { return MulAdd(x, u, y * v); }
  static HWY_INLINE V times(double factor, V x) { return number<V>(factor) * x; }

  template <class C>
  HWY_INLINE void addQuadratic(const C& c) {
    const V c0 = c(3), c1 = c(4), c2 = c(5);
    const V gu = sum(c0 + c0, p.x, c1, p.y), gv = sum(c1, p.x, c2 + c2, p.y);
    a[0] = MulAdd(number<V>(0.5), sum(gu, p.x, gv, p.y), a[0]);
    a[1] += sum(gu, d.x, gv, d.y);
    a[2] = MulAdd(MulAdd(c0, d.x, c1 * d.y), d.x, c2 * (d.y * d.y));
  }

  template <class C>
  HWY_INLINE void addCubic(const C& c) {
    const V c0 = c(6), c1 = c(7), c2 = c(8), c3 = c(9);
    const auto gradient_u = [&](V x, V y) HWY_ATTR {
      return MulAdd(MulAdd(times(3, c0), x, times(2, c1) * y), x, c2 * (y * y));
    };
    const auto gradient_v = [&](V x, V y) HWY_ATTR {
      return MulAdd(MulAdd(c1, x, times(2, c2) * y), x, times(3, c3) * (y * y));
    };
    const V pu = gradient_u(p.x, p.y), pv = gradient_v(p.x, p.y);
    const V qu = gradient_u(d.x, d.y), qv = gradient_v(d.x, d.y);
    const V third = number<V>(1.0 / 3.0);
    a[0] = MulAdd(third, sum(pu, p.x, pv, p.y), a[0]);
    a[1] += sum(pu, d.x, pv, d.y);
    a[2] += sum(qu, p.x, qv, p.y);
    a[3] = third * sum(qu, d.x, qv, d.y);
  }

  template <class C>
  HWY_INLINE void addQuartic(const C& c) {
    const V c0 = c(10), c1 = c(11), c2 = c(12), c3 = c(13), c4 = c(14);
    const auto gradient_u = [&](V x, V y) HWY_ATTR {
      return MulAdd(x * x, sum(times(4, c0), x, times(3, c1), y),
                    (y * y) * sum(times(2, c2), x, c3, y));
    };
    const auto gradient_v = [&](V x, V y) HWY_ATTR {
      return MulAdd(x * x, sum(c1, x, times(2, c2), y),
                    (y * y) * sum(times(3, c3), x, times(4, c4), y));
    };
    const V pu = gradient_u(p.x, p.y), pv = gradient_v(p.x, p.y);
    const V qu = gradient_u(d.x, d.y), qv = gradient_v(d.x, d.y);
    const V uu = p.x * p.x, uv = p.x * p.y, vv = p.y * p.y;
    const V huu = MulAdd(times(12, c0), uu, sum(times(6, c1), uv, times(2, c2), vv));
    const V huv = MulAdd(times(3, c1), uu, sum(times(4, c2), uv, times(3, c3), vv));
    const V hvv = MulAdd(times(2, c2), uu, sum(times(6, c3), uv, times(12, c4), vv));
    const V bend = MulAdd(huu, d.x * d.x, sum(times(2, huv), d.x * d.y, hvv, d.y * d.y));
    a[0] = MulAdd(number<V>(0.25), sum(pu, p.x, pv, p.y), a[0]);
    a[1] += sum(pu, d.x, pv, d.y);
    a[2] = MulAdd(number<V>(0.5), bend, a[2]);
    a[3] += sum(qu, p.x, qv, p.y);
    a[4] = times(0.25, sum(qu, d.x, qv, d.y));
  }
};

/** Both roots of quadratics, without cancellation. */
template <class V>
struct QuadraticRoots {
  V one, other;
  hn::Mask<hn::DFromV<V>> real;
  hn::Mask<hn::DFromV<V>> one_falls;  ///< the quadratic falls at one and rises at other; elsewhere
                                      ///< the reverse

  HWY_INLINE explicit QuadraticRoots(const LinePolynomial<2, V>& line) {
    const V *a = line.a, zero = number<V>(0);
    const V under = NegMulAdd(number<V>(4) * a[2], a[0], a[1] * a[1]);
    real = under >= zero;
    const V root = Sqrt(Max(under, zero));
    const V q = number<V>(-0.5) * (a[1] + CopySign(root, a[1]));
    one = a[0] / q;
    other = q / a[2];
    one_falls = a[1] < zero;
  }
};

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

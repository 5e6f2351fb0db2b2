// SPDX-License-Identifier: BSD-3-Clause
// What the formulas of a leaf are written in. Their number V is a vector of floats, which is what
// kernels take, or double. The guard toggles: Highway compiles a kernel file once per instruction
// set. A source that is no kernel includes hwy/highway.h first.
#if defined(PCL_SLIM_NUMBERS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_NUMBERS_INL
#undef PCL_SLIM_NUMBERS_INL
#else
#define PCL_SLIM_NUMBERS_INL
#endif

#include <algorithm>
#include <cmath>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// NOLINTBEGIN(readability-identifier-naming): Highway's names, for doubles.
HWY_INLINE double MulAdd(double a, double b, double c) {
  return a * b + c;
}
HWY_INLINE double NegMulAdd(double a, double b, double c) {
  return c - a * b;
}
HWY_INLINE double MulSub(double a, double b, double c) {
  return a * b - c;
}
HWY_INLINE double Neg(double a) {
  return -a;
}
HWY_INLINE double Abs(double a) {
  return std::abs(a);
}
HWY_INLINE double Sqrt(double a) {
  return std::sqrt(a);
}
HWY_INLINE double Max(double a, double b) {
  return std::max(a, b);
}
HWY_INLINE double CopySign(double size, double sign) {
  return std::copysign(size, sign);
}
HWY_INLINE double IfThenElse(bool mask, double a, double b) {
  return mask ? a : b;
}
HWY_INLINE double IfThenElseZero(bool mask, double a) {
  return mask ? a : 0.0;
}
// NOLINTEND(readability-identifier-naming)

/** Names a type of numbers, for number(); others than vectors and double have an overload of
 * numberOf() in their own namespace. */
template <class V>
struct NumberType {};

template <class V>
HWY_INLINE V numberOf(NumberType<V>, double value) {
  return Set(hn::DFromV<V>(), static_cast<float>(value));
}
HWY_INLINE double numberOf(NumberType<double>, double value) {
  return value;
}

/** The same number in every lane. */
template <class V>
HWY_INLINE V number(double value) {
  return numberOf(NumberType<V>(), value);
}

template <class V>
HWY_INLINE V dot3(V ax, V ay, V az, V bx, V by, V bz) {
  return MulAdd(ax, bx, MulAdd(ay, by, az * bz));
}

/** Three coordinates: a point or a direction in each lane. */
template <class V>
struct Triple {
  V x, y, z;
};

template <class V>
HWY_INLINE V dot3(const Triple<V>& a, const Triple<V>& b) {
  return dot3(a.x, a.y, a.z, b.x, b.y, b.z);
}

/** The same point or direction in every lane. */
template <class V, class T>
HWY_INLINE Triple<V> tripleOf(const T* v) {
  return {number<V>(v[0]), number<V>(v[1]), number<V>(v[2])};
}

/** p + s d. */
template <class V>
HWY_INLINE Triple<V> pointAt(const Triple<V>& p, V s, const Triple<V>& d) {
  return {MulAdd(s, d.x, p.x), MulAdd(s, d.y, p.y), MulAdd(s, d.z, p.z)};
}

/** s a + t b. */
template <class V>
HWY_INLINE Triple<V> combined(V s, const Triple<V>& a, V t, const Triple<V>& b) {
  return {MulAdd(s, a.x, t * b.x), MulAdd(s, a.y, t * b.y), MulAdd(s, a.z, t * b.z)};
}

/** Two axes across a unit normal w (Duff et al. 2017), as LocalFrame. */
template <class V>
struct FrameLanes {
  Triple<V> u, v, w;

  HWY_INLINE explicit FrameLanes(const Triple<V>& n) : w(n) {
    const V one = number<V>(1.0), sign = CopySign(one, n.z);
    const V a = Neg(one) / (sign + n.z);
    const V b = n.x * n.y * a, sx = sign * n.x;
    u = {MulAdd(sx * n.x, a, one), sign * b, Neg(sx)};
    v = {b, MulAdd(n.y * n.y, a, sign), Neg(n.y)};
  }

  /** Coordinates in the frame. */
  HWY_INLINE Triple<V> turn(const Triple<V>& p) const {
    return {dot3(p, u), dot3(p, v), dot3(p, w)};
  }
};

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

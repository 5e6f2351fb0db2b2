// SPDX-License-Identifier: BSD-3-Clause
// Curvatures of the level set of a blended f, from its gradient and Hessian (theory.md,
// "Curvature"; paper, equation 8, left). The guard toggles: Highway compiles a kernel file once per
// instruction set.
#if defined(PCL_SLIM_LEVEL_SET_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_LEVEL_SET_INL
#undef PCL_SLIM_LEVEL_SET_INL
#else
#define PCL_SLIM_LEVEL_SET_INL
#endif

#include "pcl_slim/core/symmetric.h"
#include "pcl_slim/leaf/detail/numbers-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

/** Curvatures from invariants, without a frame; positive where the surface bends away from g. */
template <class V>
struct LevelSetCurvatures {
  V mean, gaussian, k_max, k_min;

  /** \param[in] g gradient, longer than 1e-15 \param[in] h entries of the Hessian */
  HWY_INLINE LevelSetCurvatures(const V* g, const V* h) {
    const V half = number<V>(0.5), two = number<V>(2);
    const V xx = g[0] * g[0], yy = g[1] * g[1], zz = g[2] * g[2];
    const V xy = g[0] * g[1], xz = g[0] * g[2], yz = g[1] * g[2];
    const V norm_sq = Max(xx + (yy + zz), number<V>(1e-30));
    const V ghg = MulAdd(two, dot3(xy, xz, yz, h[kXY], h[kXZ], h[kYZ]),
                         dot3(xx, yy, zz, h[kXX], h[kYY], h[kZZ]));
    const V inverse_sq = number<V>(1) / norm_sq;
    const V trace = h[kXX] + (h[kYY] + h[kZZ]);
    mean = half * NegMulAdd(ghg, inverse_sq, trace) * Sqrt(inverse_sq);
    const auto minor = [&](int a, int b, int c, int e)
                           HWY_ATTR { return MulSub(h[a], h[b], h[c] * h[e]); };
    const V diagonal = dot3(xx, yy, zz, minor(kYY, kZZ, kYZ, kYZ), minor(kXX, kZZ, kXZ, kXZ),
                            minor(kXX, kYY, kXY, kXY));
    const V mixed = dot3(xy, xz, yz, minor(kXZ, kYZ, kXY, kZZ), minor(kXY, kYZ, kXZ, kYY),
                         minor(kXY, kXZ, kYZ, kXX));
    gaussian = MulAdd(two, mixed, diagonal) * (inverse_sq * inverse_sq);
    const V spread = Sqrt(Max(number<V>(0), MulSub(mean, mean, gaussian)));
    k_max = mean + spread;
    k_min = mean - spread;
  }
};

/** Cosine and sine of half the angle of (x, y), a vector of the given length; cosine >= 0. */
template <class V>
HWY_INLINE void halfAngle(V x, V y, V length, V& cosine, V& sine) {
  const V zero = number<V>(0), one = number<V>(1);
  const auto behind = x < zero;
  const V c = IfThenElse(behind, Abs(y), length + x);
  const V s = IfThenElse(behind, CopySign(length - x, y), y);
  const V norm = Sqrt(MulAdd(c, c, s * s));
  const auto any = norm > zero;
  const V divisor = IfThenElse(any, norm, one);
  cosine = IfThenElse(any, c / divisor, one);
  sine = IfThenElseZero(any, s / divisor);
}

/** Principal curvatures and directions: eigenvalues and eigenvectors of the shape operator, the
 * Hessian over |g| restricted to the tangent plane. */
template <class V>
struct PrincipalCurvatures {
  V k1, k2;  ///< k1 >= k2
  Triple<V> direction1, direction2;

  /** \param[in] n unit gradient \param[in] per_length 1 / |g| \param[in] h h(i) is entry i of the
   * Hessian */
  template <class H>
  HWY_INLINE PrincipalCurvatures(const Triple<V>& n, V per_length, const H& h) {
    const FrameLanes<V> frame(n);
    const Triple<V>&u = frame.u, &v = frame.v;
    const auto times = [&](const Triple<V>& a) HWY_ATTR {
      return Triple<V>{dot3(h(kXX), h(kXY), h(kXZ), a.x, a.y, a.z),
                       dot3(h(kXY), h(kYY), h(kYZ), a.x, a.y, a.z),
                       dot3(h(kXZ), h(kYZ), h(kZZ), a.x, a.y, a.z)};
    };
    const Triple<V> hu = times(u), hv = times(v);
    const V uu = dot3(u, hu), uv = dot3(u, hv), vv = dot3(v, hv), half_of = number<V>(0.5);
    const V mean = half_of * (uu + vv), half = half_of * (uu - vv);
    const V spread = Sqrt(MulAdd(half, half, uv * uv));
    V cosine, sine;
    halfAngle(half, uv, spread, cosine, sine);
    k1 = (mean + spread) * per_length;
    k2 = (mean - spread) * per_length;
    direction1 = combined(cosine, u, sine, v);
    direction2 = combined(Neg(sine), u, cosine, v);
  }
};

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

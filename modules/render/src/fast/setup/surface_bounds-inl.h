// SPDX-License-Identifier: BSD-3-Clause
// Bounds on where leaves' own surfaces lie in the picture, many leaves at once. The guard toggles: Highway compiles a kernel file once per instruction set.
#if defined(PCL_SLIM_SURFACE_BOUNDS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_SURFACE_BOUNDS_INL
#undef PCL_SLIM_SURFACE_BOUNDS_INL
#else
#define PCL_SLIM_SURFACE_BOUNDS_INL
#endif

#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/** Norms of the forms of degree 2 to 4 of height polynomials: |form| <= norm |(u, v)|^n (Bombieri's
 * norm). */
struct FormNorms {
  Vec n[3];

  template <typename Coefficient>
  HWY_INLINE FormNorms(int degree, const Coefficient& c)
  {
    constexpr float kShares[3][5] = {{1.0f, 1.0f / 2.0f, 1.0f},
                                     {1.0f, 1.0f / 3.0f, 1.0f / 3.0f, 1.0f},
                                     {1.0f, 1.0f / 4.0f, 1.0f / 6.0f, 1.0f / 4.0f, 1.0f}};
    const Tag d;
    const auto square = [&](int k) HWY_ATTR { return hn::Mul(c(k), c(k)); };
    for (int form = 2, k = 3; form <= 4; ++form) {
      Vec sum = hn::Zero(d);
      for (int j = 0; j <= form && form <= degree; ++j, ++k) {
        sum = hn::MulAdd(hn::Set(d, kShares[form - 2][j]), square(k), sum);
      }
      n[form - 2] = hn::Sqrt(sum);
    }
  }

  /** Bound on |h - its tangent plane at the centre| over a disc. */
  HWY_INLINE Vec bend(float rho) const
  {
    const Tag d;
    const Vec high = hn::MulAdd(hn::Set(d, rho), n[2], n[1]);
    return hn::Mul(hn::Set(d, rho * rho), hn::MulAdd(hn::Set(d, rho), high, n[0]));
  }
};

/** The tangent plane of a leaf at its centre, seen along the ray through the centre. */
struct CentreRay {
  Vec c0, c1, c2;
  Vec uc, vc, wc;  ///< the frame's axes times (x_c, y_c, 1)
  Vec eps;
};

/** A strip of the picture, in pixels from the centre's. */
struct Strip {
  Vec x, y;  ///< its direction
  Vec low, high;
};

/** The strip that holds the picture of a leaf's own surface inside the ball of a share of the
 * radius: across the surface's normal in the picture a slanting leaf is narrow.
 * \param[in] u,v,w the frame's axes as they move in the picture: (a_x - x_c a_z, a_y - y_c a_z) */
HWY_INLINE Strip
stripOf(const Vec u[2], const Vec v[2], const Vec w[2], const CentreRay& ray,
        const FormNorms& norms, Vec per_pixel, float rho)
{
  const Tag d;
  const Vec one = hn::Set(d, 1.0f), share = hn::Set(d, rho);
  const Vec length = hn::Sqrt(hn::MulAdd(w[0], w[0], hn::Mul(w[1], w[1])));
  const Vec inverse = hn::Div(one, hn::Max(length, hn::Set(d, 1e-6f)));
  const Vec nx = hn::Mul(w[0], inverse), ny = hn::Mul(w[1], inverse);
  const Vec by_u = hn::MulAdd(ray.c1, length, hn::MulAdd(u[0], nx, hn::Mul(u[1], ny)));
  const Vec by_v = hn::MulAdd(ray.c2, length, hn::MulAdd(v[0], nx, hn::Mul(v[1], ny)));
  const Vec tilt = hn::Sqrt(hn::MulAdd(by_u, by_u, hn::Mul(by_v, by_v)));
  const Vec half = hn::MulAdd(share, tilt, hn::Mul(norms.bend(rho), length));
  const Vec middle = hn::Mul(ray.c0, length);
  // The near side of the ball looks larger, the far side smaller.
  const Vec reach = hn::Mul(hn::Min(ray.eps, hn::Set(d, 0.7f)), share);
  const Vec pixel = hn::Div(hn::Set(d, 1.001f), per_pixel);
  const Vec near = hn::Div(pixel, hn::Sub(one, reach)), far = hn::Div(pixel, hn::Add(one, reach));
  const Vec low = hn::Sub(middle, half), high = hn::Add(middle, half);
  const Vec margin = hn::Set(d, 0.02f);
  return {nx, hn::Neg(ny), hn::Sub(hn::Min(hn::Mul(low, near), hn::Mul(low, far)), margin),
          hn::Add(hn::Max(hn::Mul(high, near), hn::Mul(high, far)), margin)};
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

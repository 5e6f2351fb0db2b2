// SPDX-License-Identifier: BSD-3-Clause
// Principal curvatures and directions of sixteen blended gradients and Hessians: equation (8), left.
#include "probe/principal_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "probe/principal_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

/** Three coordinates. */
struct Vec3 {
  Vec x, y, z;
};

HWY_INLINE Vec
dot(const Vec3& a, const Vec3& b)
{
  return dot3(a.x, a.y, a.z, b.x, b.y, b.z);
}

HWY_INLINE Vec3
sum(Vec s, const Vec3& a, Vec t, const Vec3& b)
{
  return {hn::MulAdd(s, a.x, hn::Mul(t, b.x)), hn::MulAdd(s, a.y, hn::Mul(t, b.y)),
          hn::MulAdd(s, a.z, hn::Mul(t, b.z))};
}

HWY_INLINE Vec3
load(const float (&columns)[3][16], std::size_t i)
{
  const Tag d;
  return {hn::Load(d, columns[0] + i), hn::Load(d, columns[1] + i), hn::Load(d, columns[2] + i)};
}

HWY_INLINE void
store(const Vec3& a, float (&columns)[3][16], std::size_t i)
{
  const Tag d;
  hn::Store(a.x, d, columns[0] + i);
  hn::Store(a.y, d, columns[1] + i);
  hn::Store(a.z, d, columns[2] + i);
}

/** Two axes across a unit normal, as LocalFrame has them. */
HWY_INLINE void
axesOf(const Vec3& n, Vec3& u, Vec3& v)
{
  const Tag d;
  const Vec one = hn::Set(d, 1.0f), sign = hn::CopySign(one, n.z);
  const Vec a = hn::Neg(hn::Div(one, hn::Add(sign, n.z)));
  const Vec b = hn::Mul(hn::Mul(n.x, n.y), a);
  u = {hn::MulAdd(hn::Mul(sign, hn::Mul(n.x, n.x)), a, one), hn::Mul(sign, b),
       hn::Neg(hn::Mul(sign, n.x))};
  v = {b, hn::MulAdd(hn::Mul(n.y, n.y), a, sign), hn::Neg(n.y)};
}

/** Cosine and sine of half the angle of (x, y), a vector of the given length; cosine >= 0. */
HWY_INLINE void
halfAngle(Vec x, Vec y, Vec length, Vec& cosine, Vec& sine)
{
  const Tag d;
  const Vec zero = hn::Zero(d);
  const Mask behind = hn::Lt(x, zero);
  const Vec c = hn::IfThenElse(behind, hn::Abs(y), hn::Add(length, x));
  const Vec s = hn::IfThenElse(behind, hn::CopySign(hn::Sub(length, x), y), y);
  const Vec norm = hn::Sqrt(hn::MulAdd(c, c, hn::Mul(s, s)));
  const Mask any = hn::Gt(norm, zero);
  const Vec divisor = hn::IfThenElse(any, norm, hn::Set(d, 1.0f));
  cosine = hn::IfThenElse(any, hn::Div(c, divisor), hn::Set(d, 1.0f));
  sine = hn::IfThenElseZero(any, hn::Div(s, divisor));
}

void
findPrincipals(const BlockSums& sums, BlockPrincipals& principals)
{
  const Tag d;
  const Vec one = hn::Set(d, 1.0f), half_of = hn::Set(d, 0.5f), zero = hn::Zero(d);
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    const Vec weight = hn::Load(d, sums.weight + i);
    const Vec per_weight = hn::Div(one, hn::IfThenElse(hn::Gt(weight, zero), weight, one));
    const Vec3 g = load(sums.gradient, i);
    const Vec g_length = hn::Sqrt(dot(g, g));
    const Vec per_length = hn::Div(one, hn::IfThenElse(hn::Gt(g_length, zero), g_length, one));
    const Vec3 n = {hn::Mul(g.x, per_length), hn::Mul(g.y, per_length), hn::Mul(g.z, per_length)};
    Vec3 u, v;
    axesOf(n, u, v);
    // The shape operator is the Hessian over |g|, restricted to the tangent plane: weights cancel.
    const auto times = [&](const Vec3& a) HWY_ATTR {
      const auto h = [&](int row, int column) HWY_ATTR {
        return hn::Load(d, sums.hessian[kSymmetricEntry[row][column]] + i);
      };
      return Vec3{dot3(h(0, 0), h(0, 1), h(0, 2), a.x, a.y, a.z),
                  dot3(h(0, 1), h(1, 1), h(1, 2), a.x, a.y, a.z),
                  dot3(h(0, 2), h(1, 2), h(2, 2), a.x, a.y, a.z)};
    };
    const Vec3 hu = times(u), hv = times(v);
    const Vec uu = dot(u, hu), uv = dot(u, hv), vv = dot(v, hv);
    const Vec mean = hn::Mul(half_of, hn::Add(uu, vv)), half = hn::Mul(half_of, hn::Sub(uu, vv));
    const Vec spread = hn::Sqrt(hn::MulAdd(half, half, hn::Mul(uv, uv)));
    Vec cosine, sine;
    halfAngle(half, uv, spread, cosine, sine);
    hn::Store(hn::Mul(g_length, per_weight), d, principals.length + i);
    store(n, principals.normal, i);
    hn::Store(hn::Mul(hn::Add(mean, spread), per_length), d, principals.k1 + i);
    hn::Store(hn::Mul(hn::Sub(mean, spread), per_length), d, principals.k2 + i);
    store(sum(cosine, u, sine, v), principals.direction1, i);
    store(sum(hn::Neg(sine), u, cosine, v), principals.direction2, i);
  }
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(findPrincipals);
void
findPrincipals(const BlockSums& sums, BlockPrincipals& principals)
{
  HWY_DYNAMIC_DISPATCH(findPrincipals)(sums, principals);
}

}  // namespace pcl_slim::detail::kernels
#endif

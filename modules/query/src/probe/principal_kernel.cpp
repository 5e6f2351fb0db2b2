// SPDX-License-Identifier: BSD-3-Clause
// Principal curvatures and directions of sixteen blended gradients and Hessians: equation (8), left.
#include "probe/probe_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "probe/principal_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

HWY_INLINE Triple<Vec>
sum(Vec s, const Triple<Vec>& a, Vec t, const Triple<Vec>& b)
{
  return {MulAdd(s, a.x, t * b.x), MulAdd(s, a.y, t * b.y), MulAdd(s, a.z, t * b.z)};
}

HWY_INLINE Triple<Vec>
load(const float (&columns)[3][16], std::size_t i)
{
  const Tag d;
  return {Load(d, columns[0] + i), Load(d, columns[1] + i), Load(d, columns[2] + i)};
}

HWY_INLINE void
store(const Triple<Vec>& a, float (&columns)[3][16], std::size_t i)
{
  const Tag d;
  Store(a.x, d, columns[0] + i);
  Store(a.y, d, columns[1] + i);
  Store(a.z, d, columns[2] + i);
}

/** Cosine and sine of half the angle of (x, y), a vector of the given length; cosine >= 0. */
HWY_INLINE void
halfAngle(Vec x, Vec y, Vec length, Vec& cosine, Vec& sine)
{
  const Tag d;
  const Vec zero = Zero(d);
  const Mask behind = x < zero;
  const Vec c = IfThenElse(behind, Abs(y), length + x);
  const Vec s = IfThenElse(behind, CopySign(length - x, y), y);
  const Vec norm = Sqrt(MulAdd(c, c, s * s));
  const Mask any = norm > zero;
  const Vec divisor = IfThenElse(any, norm, set(1.0f));
  cosine = IfThenElse(any, c / divisor, set(1.0f));
  sine = IfThenElseZero(any, s / divisor);
}

void
findPrincipals(const BlockSums& sums, BlockPrincipals& principals)
{
  const Tag d;
  const Vec one = set(1.0f), half_of = set(0.5f), zero = Zero(d);
  for (std::size_t i = 0; i < 16; i += hn::Lanes(d)) {
    const Vec weight = Load(d, sums.weight + i);
    const Vec per_weight = one / IfThenElse(weight > zero, weight, one);
    const Triple<Vec> g = load(sums.gradient, i);
    const Vec g_length = Sqrt(dot3(g, g));
    const Vec per_length = one / IfThenElse(g_length > zero, g_length, one);
    const Triple<Vec> n = {g.x * per_length, g.y * per_length, g.z * per_length};
    const FrameLanes<Vec> frame(n);
    const Triple<Vec>&u = frame.u, &v = frame.v;
    // The shape operator is the Hessian over |g|, restricted to the tangent plane: weights cancel.
    const auto times = [&](const Triple<Vec>& a) HWY_ATTR {
      const auto h = [&](int row, int column) HWY_ATTR {
        return Load(d, sums.hessian[kSymmetricEntry[row][column]] + i);
      };
      const auto row = [&](int r)
                           HWY_ATTR { return dot3(h(r, 0), h(r, 1), h(r, 2), a.x, a.y, a.z); };
      return Triple<Vec>{row(0), row(1), row(2)};
    };
    const Triple<Vec> hu = times(u), hv = times(v);
    const Vec uu = dot3(u, hu), uv = dot3(u, hv), vv = dot3(v, hv);
    const Vec mean = half_of * (uu + vv), half = half_of * (uu - vv);
    const Vec spread = Sqrt(MulAdd(half, half, uv * uv));
    Vec cosine, sine;
    halfAngle(half, uv, spread, cosine, sine);
    Store(g_length * per_weight, d, principals.length + i);
    store(n, principals.normal, i);
    Store((mean + spread) * per_length, d, principals.k1 + i);
    Store((mean - spread) * per_length, d, principals.k2 + i);
    store(sum(cosine, u, sine, v), principals.direction1, i);
    store(sum(Neg(sine), u, cosine, v), principals.direction2, i);
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

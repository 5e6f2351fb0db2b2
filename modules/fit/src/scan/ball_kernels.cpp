// SPDX-License-Identifier: BSD-3-Clause
// The points of one ball once they are gathered: framed, thinned out, compared with a fit.
#include "scan/ball_kernels.h"


#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scan/ball_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void
padBall(BallBuffer& ball)
{
  const Tag d;
  const std::size_t end = ball.count + hn::Lanes(d);
  for (std::size_t i = ball.count; i < end; ++i) {
    ball.u[i] = ball.v[i] = ball.w[i] = 0.0f;
    ball.s_sq[i] = 2.0f;
    if (ball.slope_weight > 0) ball.n_u[i] = ball.n_v[i] = ball.n_w[i] = 0.0f;
  }
}

constexpr float kSlopeCosine = 0.01f;  ///< least cosine with w that a slope is read from in float

/** Slopes h_u = -n_u / n_w of a surface with these normals, and their weights n_w^3: an error of
 * the direction moves the slope s along itself by 1 + s^2 as much, across by its root, n_w^-3 on
 * average of the squares. */
void
toSlopes(const LocalFrame& frame, BallBuffer& ball)
{
  const Tag d;
  const ScaledAxes axes(frame, 1.0);
  for (std::size_t i = 0; i < ball.count; i += hn::Lanes(d)) {
    const auto [u, v, w] = axes.turn(
        {Load(d, ball.n_u.data() + i), Load(d, ball.n_v.data() + i), Load(d, ball.n_w.data() + i)});
    const auto cosine = Max(w, set(kSlopeCosine));
    Store(Neg(u) / cosine, d, ball.n_u.data() + i);
    Store(Neg(v) / cosine, d, ball.n_v.data() + i);
    Store(cosine * (cosine * cosine), d, ball.n_w.data() + i);
  }
}

void
toFrame(const LocalFrame& frame, float radius, BallBuffer& ball)
{
  const Tag d;
  const double scale = 1.0 / radius;
  const ScaledAxes axes(frame, radius);
  const auto scale_sq = set(static_cast<float>(scale * scale));
  for (std::size_t i = 0; i < ball.count; i += hn::Lanes(d)) {
    const auto [u, v, w] = axes.turn(
        {Load(d, ball.u.data() + i), Load(d, ball.v.data() + i), Load(d, ball.w.data() + i)});
    Store(u, d, ball.u.data() + i);
    Store(v, d, ball.v.data() + i);
    Store(w, d, ball.w.data() + i);
    Store(Load(d, ball.s_sq.data() + i) * scale_sq, d, ball.s_sq.data() + i);
  }
  if (ball.slope_weight > 0) toSlopes(frame, ball);
  padBall(ball);
}

template <typename Keep>
HWY_INLINE void
copyWhere(const BallBuffer& ball, const Keep& keep, BallBuffer& out)
{
  const Tag d;
  out.reserve(ball.count);
  out.slope_weight = ball.slope_weight;
  if (out.slope_weight > 0) out.reserveNormals();
  std::size_t count = 0;
  for (std::size_t i = 0; i < ball.count; i += hn::Lanes(d)) {
    const auto s_sq = Load(d, ball.s_sq.data() + i);
    const auto mask = keep(i, s_sq);
    const LanePacking packing(d, mask);
    packing.store(Load(d, ball.u.data() + i), out.u.data() + count);
    packing.store(Load(d, ball.v.data() + i), out.v.data() + count);
    packing.store(Load(d, ball.w.data() + i), out.w.data() + count);
    packing.store(s_sq, out.s_sq.data() + count);
    if (out.slope_weight > 0) {
      packing.store(Load(d, ball.n_u.data() + i), out.n_u.data() + count);
      packing.store(Load(d, ball.n_v.data() + i), out.n_v.data() + count);
      packing.store(Load(d, ball.n_w.data() + i), out.n_w.data() + count);
    }
    count += packing.count();
  }
  out.count = count;
  out.prior.clear();
  padBall(out);
}

void
compactBall(const BallBuffer& ball, float limit_sq, BallBuffer& inner)
{
  const auto limit = set(limit_sq);
  copyWhere(
      ball, [&](std::size_t, Vec s_sq) HWY_ATTR { return s_sq < limit; }, inner);
}

void
selectResiduals(const BallBuffer& ball, const float* residuals, float low, float high,
                BallBuffer& kept)
{
  const Tag d;
  const auto keep = [&](std::size_t i, Vec s_sq) HWY_ATTR {
    const auto r = LoadU(d, residuals + i);
    return And(s_sq < set(1.5f), And(r >= set(low), r <= set(high)));
  };
  copyWhere(ball, keep, kept);
}

template <int D>
void
residualsOfDegree(const BallBuffer& ball, const double* c, float* residuals)
{
  const Tag d;
  const Height<D> height(c);
  for (std::size_t i = 0; i < ball.count; i += hn::Lanes(d)) {
    const auto u = Load(d, ball.u.data() + i), v = Load(d, ball.v.data() + i);
    StoreU(Load(d, ball.w.data() + i) - height(u, v), d, residuals + i);
  }
}

void
ballResiduals(const BallBuffer& ball, int degree, const double* c, float* residuals)
{
  forDegree(degree, [&](auto d) HWY_ATTR { residualsOfDegree<d()>(ball, c, residuals); });
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(toFrame);
HWY_EXPORT(compactBall);
HWY_EXPORT(selectResiduals);
HWY_EXPORT(ballResiduals);

void
toFrame(const LocalFrame& frame, float radius, BallBuffer& ball)
{
  HWY_DYNAMIC_DISPATCH(toFrame)(frame, radius, ball);
}

void
compactBall(const BallBuffer& ball, float limit_sq, BallBuffer& inner)
{
  HWY_DYNAMIC_DISPATCH(compactBall)(ball, limit_sq, inner);
}

void
selectResiduals(const BallBuffer& ball, const float* residuals, float low, float high,
                BallBuffer& kept)
{
  HWY_DYNAMIC_DISPATCH(selectResiduals)(ball, residuals, low, high, kept);
}

void
ballResiduals(const BallBuffer& ball, int degree, const double* c, float* residuals)
{
  HWY_DYNAMIC_DISPATCH(ballResiduals)(ball, degree, c, residuals);
}

}  // namespace pcl_slim::detail::kernels
#endif

// SPDX-License-Identifier: BSD-3-Clause
// Stored points in a ball: gathered, covered by a leaf, or marked; and the points of one ball once
// they are gathered: framed, thinned out, compared with a fit.
#include "scan/ball_kernels.h"

#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scan/ball_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "scan/ball_scan-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

void gatherBall(const PointStore& store, const BlockList& blocks, const BallQuery& query,
                bool with_covariance, BallBuffer& ball, BallSums& sums) {
  const Tag d;
  const auto zero = Zero(d);
  ball.reserve(blocks.size() * PointStore::kBlock);
  if (query.take_normals) ball.reserveNormals();
  const auto inverse_sq = set(1.0f / (query.radius * query.radius));
  const bool with_normals = query.bound_normal != nullptr;
  std::size_t count = 0, inside = 0;
  Vec weight = zero, n[3] = {zero, zero, zero}, first[3] = {zero, zero, zero};
  Vec second[6] = {zero, zero, zero, zero, zero, zero};
  BallScan(store, query).forEach(blocks, [&](std::size_t i, const Lanes& l) HWY_ATTR {
    const auto g = IfThenElseZero(l.kept, kernelWeight<WeightKernel::kPower4>(l.d_sq * inverse_sq));
    weight += g;
    if (with_normals) {
      inside += CountTrue(d, l.in_ball);
      n[0] = MulAdd(g, Load(d, store.nx() + i), n[0]);
      n[1] = MulAdd(g, Load(d, store.ny() + i), n[1]);
      n[2] = MulAdd(g, Load(d, store.nz() + i), n[2]);
    }
    if (with_covariance) {
      // Padding is far away: its weight is 0, its products stay finite.
      const auto gx = g * l.dx, gy = g * l.dy, gz = g * l.dz;
      first[0] += gx;
      first[1] += gy;
      first[2] += gz;
      second[0] = MulAdd(gx, l.dx, second[0]);
      second[1] = MulAdd(gx, l.dy, second[1]);
      second[2] = MulAdd(gx, l.dz, second[2]);
      second[3] = MulAdd(gy, l.dy, second[3]);
      second[4] = MulAdd(gy, l.dz, second[4]);
      second[5] = MulAdd(gz, l.dz, second[5]);
    }
    const LanePacking packing(d, l.kept);
    packing.store(l.dx, ball.u.data() + count);
    packing.store(l.dy, ball.v.data() + count);
    packing.store(l.dz, ball.w.data() + count);
    packing.store(l.d_sq, ball.s_sq.data() + count);
    if (query.take_normals) {
      packing.store(Load(d, store.nx() + i), ball.n_u.data() + count);
      packing.store(Load(d, store.ny() + i), ball.n_v.data() + count);
      packing.store(Load(d, store.nz() + i), ball.n_w.data() + count);
    }
    count += packing.count();
  });
  ball.count = count;
  ball.prior.clear();
  sums.inside = with_normals ? inside : count;
  sums.weight = sumLanes(weight);
  for (int a = 0; a < 3; ++a) sums.normal[a] = sumLanes(n[a]);
  for (int a = 0; a < 3; ++a) sums.first[a] = sumLanes(first[a]);
  for (int a = 0; a < 6; ++a) sums.second[a] = sumLanes(second[a]);
}

template <int D, WeightKernel K>
void coverOfDegree(const PointStore& store, const BlockList& blocks, const CoverLeaf& leaf,
                   float* coverage) {
  const Tag d;
  const double scale = 1.0 / leaf.support_radius;
  const ScaledAxes axes(leaf.frame, leaf.support_radius);
  const Height<D> height(leaf.c);
  const auto limit = set(static_cast<float>(leaf.max_residual * scale));
  const auto radius_sq = set(leaf.to_foot ? leaf.support_radius * leaf.support_radius : 0.0f);
  const auto inverse_sq = set(1.0f / (leaf.ball.radius * leaf.ball.radius));
  BallScan(store, leaf.ball).forEach(blocks, [&](std::size_t i, const Lanes& l) HWY_ATTR {
    const auto [u, v, w] = axes.turn({l.dx, l.dy, l.dz});
    const auto residual = w - height(u, v);
    const auto near = And(l.kept, Abs(residual) <= limit);
    // Distances are measured to the foot point, so that noise does not reduce coverage.
    const auto foot_sq = NegMulAdd(residual * residual, radius_sq, l.d_sq);
    const auto g = kernelWeight<K>(Max(foot_sq, Zero(d)) * inverse_sq);
    addMasked(g, near, coverage + i);
  });
}

template <int D>
void coverWithKernel(const PointStore& store, const BlockList& blocks, const CoverLeaf& leaf,
                     WeightKernel kernel, float* coverage) {
  if (kernel == WeightKernel::kGaussian) {
    coverOfDegree<D, WeightKernel::kGaussian>(store, blocks, leaf, coverage);
  } else {
    coverOfDegree<D, WeightKernel::kPower7>(store, blocks, leaf, coverage);
  }
}

void coverPoints(const PointStore& store, const BlockList& blocks, const CoverLeaf& leaf,
                 WeightKernel kernel, float* coverage) {
  switch (leaf.degree) {
    case 1: return coverWithKernel<1>(store, blocks, leaf, kernel, coverage);
    case 2: return coverWithKernel<2>(store, blocks, leaf, kernel, coverage);
    case 3: return coverWithKernel<3>(store, blocks, leaf, kernel, coverage);
    default: return coverWithKernel<4>(store, blocks, leaf, kernel, coverage);
  }
}

void markPoints(const PointStore& store, const BlockList& blocks, const BallQuery& ball,
                std::uint8_t value, std::uint8_t* marks) {
  const Tag d;
  const std::uint64_t all = value * 0x0101010101010101u;
  const auto unmarked = [&](std::uint32_t b) {
    std::uint64_t halves[2];
    std::memcpy(halves, marks + b * PointStore::kBlock, sizeof(halves));
    return (halves[0] & halves[1] & all) != all;
  };
  BallScan(store, ball).forEachOf(blocks, unmarked, [&](std::size_t i, const Lanes& l) HWY_ATTR {
    HWY_ALIGN std::uint8_t bits[8] = {};
    StoreMaskBits(d, l.kept, bits);
    for (std::uint32_t mask = bits[0] | static_cast<std::uint32_t>(bits[1]) << 8; mask != 0;
         mask &= mask - 1) {
      marks[i + static_cast<std::size_t>(__builtin_ctz(mask))] |= value;
    }
  });
}

void padBall(BallBuffer& ball) {
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
void toSlopes(const LocalFrame& frame, BallBuffer& ball) {
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

void toFrame(const LocalFrame& frame, float radius, BallBuffer& ball) {
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
HWY_INLINE void copyWhere(const BallBuffer& ball, const Keep& keep, BallBuffer& out) {
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

void compactBall(const BallBuffer& ball, float limit_sq, BallBuffer& inner) {
  const auto limit = set(limit_sq);
  copyWhere(
      ball, [&](std::size_t, Vec s_sq) HWY_ATTR { return s_sq < limit; }, inner);
}

void selectResiduals(const BallBuffer& ball, const float* residuals, float low, float high,
                     BallBuffer& kept) {
  const Tag d;
  const auto keep = [&](std::size_t i, Vec s_sq) HWY_ATTR {
    const auto r = LoadU(d, residuals + i);
    return And(s_sq < set(1.5f), And(r >= set(low), r <= set(high)));
  };
  copyWhere(ball, keep, kept);
}

template <int D>
void residualsOfDegree(const BallBuffer& ball, const double* c, float* residuals) {
  const Tag d;
  const Height<D> height(c);
  for (std::size_t i = 0; i < ball.count; i += hn::Lanes(d)) {
    const auto u = Load(d, ball.u.data() + i), v = Load(d, ball.v.data() + i);
    StoreU(Load(d, ball.w.data() + i) - height(u, v), d, residuals + i);
  }
}

void ballResiduals(const BallBuffer& ball, int degree, const double* c, float* residuals) {
  forDegree(degree, [&](auto d) HWY_ATTR { residualsOfDegree<d()>(ball, c, residuals); });
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(gatherBall);
HWY_EXPORT(coverPoints);
HWY_EXPORT(markPoints);
HWY_EXPORT(toFrame);
HWY_EXPORT(compactBall);
HWY_EXPORT(selectResiduals);
HWY_EXPORT(ballResiduals);

void gatherBall(const PointStore& store, const BlockList& blocks, const BallQuery& query,
                bool with_covariance, BallBuffer& ball, BallSums& sums) {
  HWY_DYNAMIC_DISPATCH(gatherBall)(store, blocks, query, with_covariance, ball, sums);
}

void coverPoints(const PointStore& store, const BlockList& blocks, const CoverLeaf& leaf,
                 WeightKernel kernel, float* coverage) {
  HWY_DYNAMIC_DISPATCH(coverPoints)(store, blocks, leaf, kernel, coverage);
}

void markPoints(const PointStore& store, const BlockList& blocks, const BallQuery& ball,
                std::uint8_t value, std::uint8_t* marks) {
  HWY_DYNAMIC_DISPATCH(markPoints)(store, blocks, ball, value, marks);
}

void toFrame(const LocalFrame& frame, float radius, BallBuffer& ball) {
  HWY_DYNAMIC_DISPATCH(toFrame)(frame, radius, ball);
}

void compactBall(const BallBuffer& ball, float limit_sq, BallBuffer& inner) {
  HWY_DYNAMIC_DISPATCH(compactBall)(ball, limit_sq, inner);
}

void selectResiduals(const BallBuffer& ball, const float* residuals, float low, float high,
                     BallBuffer& kept) {
  HWY_DYNAMIC_DISPATCH(selectResiduals)(ball, residuals, low, high, kept);
}

void ballResiduals(const BallBuffer& ball, int degree, const double* c, float* residuals) {
  HWY_DYNAMIC_DISPATCH(ballResiduals)(ball, degree, c, residuals);
}

}  // namespace pcl_slim::detail::kernels
#endif

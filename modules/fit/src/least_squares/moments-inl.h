// SPDX-License-Identifier: BSD-3-Clause
// Sums over the weighted points of a ball. The guard toggles: Highway compiles a kernel file once
// per instruction set.
#if defined(PCL_SLIM_MOMENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_MOMENTS_INL
#undef PCL_SLIM_MOMENTS_INL
#else
#define PCL_SLIM_MOMENTS_INL
#endif

#include "least_squares/mean_slope.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"
#include "scan/ball_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/** Moments sum W u^i v^j (rows of fixed i), sum W z u^i v^j, sum W z^2, sum W^2. */
struct Moments {
  double uv[LocalFit::kMaxMoments];
  double z[kMaxCoefficients];
  double zz;
  double weight_sq;
};

template <WeightKernel K>
class WeightedBall {
 public:
  WeightedBall(const BallBuffer& ball, float rho)
      : ball_(ball), values_(ball.w.data()), inverse_sq_(hn::Set(Tag(), 1.0f / (rho * rho)))
  {
  }

  const BallBuffer& points() const { return ball_; }

  /** Slopes along u or v in place of heights, with the weights of slopes. */
  WeightedBall slopes(bool along_u) const
  {
    WeightedBall other = *this;
    other.values_ = along_u ? ball_.n_u.data() : ball_.n_v.data();
    other.factors_ = ball_.n_w.data();
    return other;
  }

  /** Calls body(weight, u, v, w) for every group of lanes. */
  template <typename Body>
  HWY_INLINE void forEach(const Body& body) const
  {
    const Tag d;
    for (std::size_t i = 0; i < ball_.count; i += hn::Lanes(d)) {
      auto weight = kernelWeight<K>(hn::Mul(hn::Load(d, ball_.s_sq.data() + i), inverse_sq_));
      if (!ball_.prior.empty()) weight = hn::Mul(weight, hn::Load(d, ball_.prior.data() + i));
      if (factors_ != nullptr) weight = hn::Mul(weight, hn::Load(d, factors_ + i));
      body(weight, hn::Load(d, ball_.u.data() + i), hn::Load(d, ball_.v.data() + i),
           hn::Load(d, values_ + i));
    }
  }

 private:
  const BallBuffer& ball_;
  const float* values_;
  const float* factors_ = nullptr;
  Vec inverse_sq_;
};

/** Rows First .. Last of the moments; few enough at a time that the sums stay in registers. */
template <int D, int First, int Last, WeightKernel K>
HWY_NOINLINE void
momentRows(const WeightedBall<K>& ball, Moments& m)
{
  constexpr int kBegin = momentIndex(D, First, 0);
  constexpr int kCount = momentIndex(D, Last, 2 * D - Last) + 1 - kBegin;
  Vec sums[kCount];
  Vec weight_sq = hn::Zero(Tag());
  for (auto& sum : sums) sum = hn::Zero(Tag());
  ball.forEach([&](Vec weight, Vec u, Vec v, Vec) HWY_ATTR {
    if constexpr (First == 0) weight_sq = hn::MulAdd(weight, weight, weight_sq);
    Vec base = weight;
    unrolled<First>([&](auto) HWY_ATTR { base = hn::Mul(base, u); });
    unrolled<Last - First + 1>([&](auto step) HWY_ATTR {
      constexpr int kRow = First + step();
      Vec term = base;
      unrolled<2 * D - kRow + 1>([&](auto j) HWY_ATTR {
        constexpr int kAt = momentIndex(D, kRow, j()) - kBegin;
        sums[kAt] = hn::Add(sums[kAt], term);
        if constexpr (j() < 2 * D - kRow) term = hn::Mul(term, v);
      });
      if constexpr (kRow < Last) base = hn::Mul(base, u);
    });
  });
  for (int k = 0; k < kCount; ++k) m.uv[kBegin + k] = sumLanes(sums[k]);
  if constexpr (First == 0) m.weight_sq = sumLanes(weight_sq);
}

/** Sums W z u^i v^j over all terms of degree D, and W z^2, for z = value(u, v, w). */
template <int D, WeightKernel K, typename Value>
HWY_INLINE void
heightSums(const WeightedBall<K>& ball, const Value& value, double z_sums[], double& zz_sum)
{
  constexpr int kTerms = numCoefficients(D);
  Vec sums[kTerms];
  Vec zz = hn::Zero(Tag());
  for (auto& sum : sums) sum = hn::Zero(Tag());
  ball.forEach([&](Vec weight, Vec u, Vec v, Vec w) HWY_ATTR {
    const Vec z = value(u, v, w);
    Vec base = hn::Mul(weight, z);
    zz = hn::MulAdd(base, z, zz);
    unrolled<D + 1>([&](auto i) HWY_ATTR {
      Vec term = base;
      unrolled<D - i() + 1>([&](auto j) HWY_ATTR {
        constexpr int kAt = termIndex(i(), j());
        sums[kAt] = hn::Add(sums[kAt], term);
        if constexpr (j() < D - i()) term = hn::Mul(term, v);
      });
      if constexpr (i() < D) base = hn::Mul(base, u);
    });
  });
  for (int k = 0; k < kTerms; ++k) z_sums[k] = sumLanes(sums[k]);
  zz_sum = sumLanes(zz);
}

template <int D, WeightKernel K>
void
weightMoments(const WeightedBall<K>& ball, Moments& m)
{
  if constexpr (D <= 2) {
    momentRows<D, 0, 2 * D>(ball, m);
  } else if constexpr (D == 3) {
    momentRows<D, 0, 2>(ball, m);
    momentRows<D, 3, 6>(ball, m);
  } else {
    momentRows<D, 0, 1>(ball, m);
    momentRows<D, 2, 4>(ball, m);
    momentRows<D, 5, 8>(ball, m);
  }
}

template <int D, WeightKernel K>
void
computeMoments(const WeightedBall<K>& ball, Moments& m)
{
  weightMoments<D, K>(ball, m);
  heightSums<D>(
      ball, [](Vec, Vec, Vec w) HWY_ATTR { return w; }, m.z, m.zz);
}

/** Moments of the slopes' weights, times slope_weight. */
template <int D, WeightKernel K>
HWY_NOINLINE void
slopeMoments(const WeightedBall<K>& ball, Moments& m)
{
  weightMoments<D - 1, K>(ball.slopes(true), m);
  for (int k = 0; k <= momentIndex(D - 1, 2 * D - 2, 0); ++k) m.uv[k] *= ball.points().slope_weight;
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

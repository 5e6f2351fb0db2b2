// SPDX-License-Identifier: BSD-3-Clause
// Weighted least squares of a ball: moments in float SIMD, the normal equations in double.
#include <algorithm>
#include <cmath>

#include "least_squares/least_squares.h"
#include "scan/ball_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "least_squares/local_fit.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "least_squares/normal_equations-inl.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Share of sum w z^2 that differences of sums in float keep (docs/theory.md, "One ball").
constexpr double kResidual = 1e-3;

/** Moments sum W u^i v^j (rows of fixed i), sum W z u^i v^j, sum W z^2, sum W^2. */
struct Moments {
  double uv[LocalFit::kMaxMoments];
  double z[kMaxCoefficients];
  double zz;
  double weight_sq;
};

constexpr std::size_t kRun = 256;  ///< points whose weights are at hand; no result depends on it

/** The weights of points [begin, end) of a ball, up to whole vectors. */
template <WeightKernel K>
HWY_NOINLINE void weigh(const BallBuffer& ball, Vec inverse_sq, std::size_t begin, std::size_t end,
                        float* weights) {
  const Tag d;
  for (std::size_t i = begin; i < end; i += hn::Lanes(d), weights += hn::Lanes(d)) {
    auto weight = kernelWeight<K>(Load(d, ball.s_sq.data() + i) * inverse_sq);
    if (!ball.prior.empty()) weight *= Load(d, ball.prior.data() + i);
    Store(weight, d, weights);
  }
}

/** A ball's points with the weights G(s / rho). Weights are made a run of points at a time, before
 * the loops over points, which so are the same for all kernels; of few points they are made once
 * for all loops. */
class WeightedBall {
 public:
  WeightedBall(const BallBuffer& ball, float rho, WeightKernel kernel)
      : ball_(ball),
        values_(ball.w.data()),
        kernel_(kernel),
        inverse_sq_(set(1.0f / (rho * rho))) {}

  const BallBuffer& points() const { return ball_; }

  /** Slopes along u or v in place of heights, with the weights of slopes. */
  WeightedBall slopes(bool along_u) const {
    WeightedBall other = *this;
    other.values_ = along_u ? ball_.n_u.data() : ball_.n_v.data();
    other.factors_ = ball_.n_w.data();
    return other;
  }

  /** Calls body(weight, u, v, w) for every group of lanes. */
  template <typename Body>
  HWY_INLINE void forEach(const Body& body) const {
    const Tag d;
    for (std::size_t begin = 0; begin < ball_.count; begin += kRun) {
      const std::size_t end = std::min(begin + kRun, ball_.count);
      if (begin != at_hand_) weighRun(begin, end);
      for (std::size_t i = begin; i < end; i += hn::Lanes(d)) {
        auto weight = Load(d, weights_ + (i - begin));
        if (factors_ != nullptr) weight *= Load(d, factors_ + i);
        body(weight, Load(d, ball_.u.data() + i), Load(d, ball_.v.data() + i),
             Load(d, values_ + i));
      }
    }
  }

 private:
  void weighRun(std::size_t begin, std::size_t end) const {
    at_hand_ = begin;
    switch (kernel_) {
      case WeightKernel::kPower2:
        return weigh<WeightKernel::kPower2>(ball_, inverse_sq_, begin, end, weights_);
      case WeightKernel::kPower4:
        return weigh<WeightKernel::kPower4>(ball_, inverse_sq_, begin, end, weights_);
      default: return weigh<WeightKernel::kGaussian>(ball_, inverse_sq_, begin, end, weights_);
    }
  }

  const BallBuffer& ball_;
  const float* values_;
  const float* factors_ = nullptr;
  WeightKernel kernel_;
  Vec inverse_sq_;
  mutable std::size_t at_hand_ =
      ~std::size_t{0};  ///< where the run begins whose weights are at hand
  HWY_ALIGN mutable float weights_[kRun];
};

/** Rows First .. Last of the moments; few enough at a time that the sums stay in registers. */
template <int D, int First, int Last>
HWY_NOINLINE void momentRows(const WeightedBall& ball, Moments& m) {
  constexpr int kBegin = momentIndex(D, First, 0);
  constexpr int kCount = momentIndex(D, Last, 2 * D - Last) + 1 - kBegin;
  Vec sums[kCount];
  Vec weight_sq = Zero(Tag());
  for (auto& sum : sums) sum = Zero(Tag());
  ball.forEach([&](Vec weight, Vec u, Vec v, Vec) HWY_ATTR {
    if constexpr (First == 0) weight_sq = MulAdd(weight, weight, weight_sq);
    Vec base = weight;
    unrolled<First>([&](auto) HWY_ATTR { base *= u; });
    unrolled<Last - First + 1>([&](auto step) HWY_ATTR {
      constexpr int kRow = First + step();
      Vec term = base;
      unrolled<2 * D - kRow + 1>([&](auto j) HWY_ATTR {
        constexpr int kAt = momentIndex(D, kRow, j()) - kBegin;
        sums[kAt] += term;
        if constexpr (j() < 2 * D - kRow) term *= v;
      });
      if constexpr (kRow < Last) base *= u;
    });
  });
  for (int k = 0; k < kCount; ++k) m.uv[kBegin + k] = sumLanes(sums[k]);
  if constexpr (First == 0) m.weight_sq = sumLanes(weight_sq);
}

/** Sums W z u^i v^j over all terms of degree D, and W z^2, for z = value(u, v, w). */
template <int D, typename Value>
HWY_INLINE void heightSums(const WeightedBall& ball, const Value& value, double z_sums[],
                           double& zz_sum) {
  constexpr int kTerms = numCoefficients(D);
  Vec sums[kTerms];
  Vec zz = Zero(Tag());
  for (auto& sum : sums) sum = Zero(Tag());
  ball.forEach([&](Vec weight, Vec u, Vec v, Vec w) HWY_ATTR {
    const Vec z = value(u, v, w);
    Vec base = weight * z;
    zz = MulAdd(base, z, zz);
    unrolled<D + 1>([&](auto i) HWY_ATTR {
      Vec term = base;
      unrolled<D - i() + 1>([&](auto j) HWY_ATTR {
        constexpr int kAt = termIndex(i(), j());
        sums[kAt] += term;
        if constexpr (j() < D - i()) term *= v;
      });
      if constexpr (i() < D) base *= u;
    });
  });
  for (int k = 0; k < kTerms; ++k) z_sums[k] = sumLanes(sums[k]);
  zz_sum = sumLanes(zz);
}

template <int D>
void weightMoments(const WeightedBall& ball, Moments& m) {
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

template <int D>
void computeMoments(const WeightedBall& ball, Moments& m) {
  weightMoments<D>(ball, m);
  heightSums<D>(
      ball, [](Vec, Vec, Vec w) HWY_ATTR { return w; }, m.z, m.zz);
}

/** Moments of the slopes' weights, times slope_weight. */
template <int D>
HWY_NOINLINE void slopeMoments(const WeightedBall& ball, Moments& m) {
  weightMoments<D - 1>(ball.slopes(true), m);
  for (int k = 0; k <= momentIndex(D - 1, 2 * D - 2, 0); ++k) m.uv[k] *= ball.points().slope_weight;
}

/** Residual sums of a solution: b = sum W f m_k and sum W f^2, from the points themselves. */
template <int D>
HWY_NOINLINE void residualSums(const WeightedBall& ball, const double* c, double* b, double& ff) {
  const Height<D> height(c);
  heightSums<D>(
      ball, [&](Vec u, Vec v, Vec w) HWY_ATTR { return w - height(u, v); }, b, ff);
}

template <int D>
HWY_NOINLINE double residualSum(const WeightedBall& ball, const double* c) {
  const Height<D> height(c);
  Vec sum = Zero(Tag());
  ball.forEach([&](Vec weight, Vec u, Vec v, Vec w) HWY_ATTR {
    const Vec f = w - height(u, v);
    sum = MulAdd(weight * f, f, sum);
  });
  return sumLanes(sum);
}

/** Adds the slopes' residuals against those of c to the right-hand side: slope_weight times
 * sum W (s_u - h_u) d_u m_k + W (s_v - h_v) d_v m_k. \return their weighted sum of squares. */
template <int D>
HWY_NOINLINE double addSlopeSums(const WeightedBall& ball, const double* c, double* b) {
  constexpr int kTermsOfSlope = numCoefficients(D - 1);
  const double weight = ball.points().slope_weight;
  double missed = 0;
  for (const bool along_u : {true, false}) {
    double slope[kTermsOfSlope] = {}, sums[kTermsOfSlope], squares;
    const auto eachTerm = [&](const auto& body) {
      for (int k = 1; k < numCoefficients(D); ++k) {
        const auto [i, j] = kTerms[k];
        if (along_u && i > 0) body(k, termIndex(i - 1, j), i);
        if (!along_u && j > 0) body(k, termIndex(i, j - 1), j);
      }
    };
    eachTerm([&](int k, int derived, int power) { slope[derived] = power * c[k]; });
    const Height<D - 1> known(slope);
    heightSums<D - 1>(
        ball.slopes(along_u), [&](Vec u, Vec v, Vec s) HWY_ATTR { return s - known(u, v); }, sums,
        squares);
    eachTerm([&](int k, int derived, int power) { b[k] += weight * power * sums[derived]; });
    missed += weight * squares;
  }
  return missed;
}

/** Highest degree with all its pivots and enough support; 0 if not even a plane has. */
int supportedDegree(int degree, int pivots, double n_eff, double support) {
  while (degree > 0 &&
         (numCoefficients(degree) > pivots || n_eff < support * numCoefficients(degree))) {
    --degree;
  }
  return degree;
}

template <int D>
LocalFit fitOfDegree(const BallBuffer& points, float rho, WeightKernel kernel, double support,
                     bool refine) {
  LocalFit fit;
  fit.kernel = kernel;
  const WeightedBall ball(points, rho, kernel);
  Moments m;
  computeMoments<D>(ball, m);
  const double weight = m.uv[0];
  const bool slopes = points.slope_weight > 0;
  Moments of_slopes;
  if (slopes) {
    slopeMoments<D>(ball, of_slopes);
    addSlopeSums<D>(ball, fit.c.data(), m.z);
  }
  if (!(weight > 0.0) || !(m.weight_sq > 0.0)) return fit;
  fit.n_eff = weight * weight / m.weight_sq;
  fit.moment_degree = D;
  std::copy_n(m.uv, momentIndex(D, 2 * D, 0) + 1, fit.moments.begin());
  NormalEquations<D> equations;
  const int pivots = equations.factor(m.uv, m.z, slopes ? of_slopes.uv : nullptr);
  fit.degree = supportedDegree(D, pivots, fit.n_eff, support);
  fit.fell_by_pivot = fit.degree < D && fit.n_eff >= support * numCoefficients(fit.degree + 1);
  if (fit.degree == 0) return fit;
  const int size = numCoefficients(fit.degree);
  double rss = m.zz;
  for (int p = 0; p < size; ++p) rss -= equations.explained(p);
  equations.solve(size, fit.c.data());
  if (refine) {
    double b[kMaxCoefficients] = {}, ff;
    residualSums<D>(ball, fit.c.data(), b, ff);
    if (slopes) addSlopeSums<D>(ball, fit.c.data(), b);
    equations.solveAndAdd(size, b, fit.c.data());
    fit.least_pivot = equations.leastPivot(size);
  }
  if (refine || slopes || rss < kResidual * m.zz) rss = residualSum<D>(ball, fit.c.data());
  fit.residual_sq = std::max(0.0, rss / weight);
  fit.terms = slopes ? equations.heightTerms(size, m.uv) : size;
  if (slopes) {
    double unused[kMaxCoefficients] = {};
    fit.slope_misfit = addSlopeSums<D>(ball, fit.c.data(), unused) / weight;
  }
  fit.slope_sq = meanSlopeSq<D>(m.uv, fit.c.data());
  return fit;
}

double effectiveCount(const BallBuffer& ball, float rho, WeightKernel kernel) {
  Vec sum = Zero(Tag()), squares = sum;
  WeightedBall(ball, rho, kernel).forEach([&](Vec weight, Vec, Vec, Vec) HWY_ATTR {
    sum += weight;
    squares = MulAdd(weight, weight, squares);
  });
  const double weight = sumLanes(sum), weight_sq = sumLanes(squares);
  return weight_sq > 0.0 ? weight * weight / weight_sq : 0.0;
}

LocalFit fitBall(const BallBuffer& ball, int degree, float rho, WeightKernel kernel, double support,
                 bool refine) {
  return forDegree(degree, [&](auto d) HWY_ATTR {
    return fitOfDegree<d()>(ball, rho, kernel, support, refine);
  });
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(fitBall);
HWY_EXPORT(effectiveCount);

double effectiveCount(const BallBuffer& ball, float rho, WeightKernel kernel) {
  return HWY_DYNAMIC_DISPATCH(effectiveCount)(ball, rho, kernel);
}

LocalFit fitBall(const BallBuffer& ball, int degree, float rho, WeightKernel kernel, double support,
                 bool refine) {
  return HWY_DYNAMIC_DISPATCH(fitBall)(ball, degree, rho, kernel, support, refine);
}

}  // namespace pcl_slim::detail::kernels
#endif

// SPDX-License-Identifier: BSD-3-Clause
// Weighted least squares of a ball: moments in float SIMD, Cholesky in double.
#include <algorithm>
#include <cmath>

#include "fit_constants.h"
#include "least_squares/mean_slope.h"
#include "scan/ball_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "least_squares/fit_kernel.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "least_squares/moments-inl.h"
#include "least_squares/normal_equations-inl.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/** Residual sums of a solution: b = sum W f m_k and sum W f^2, from the points themselves. */
template <int D, WeightKernel K>
HWY_NOINLINE void
residualSums(const WeightedBall<K>& ball, const double* c, double* b, double& ff)
{
  const Height<D> height(c);
  heightSums<D>(
      ball, [&](Vec u, Vec v, Vec w) HWY_ATTR { return hn::Sub(w, height(u, v)); }, b, ff);
}

template <int D, WeightKernel K>
HWY_NOINLINE double
residualSum(const WeightedBall<K>& ball, const double* c)
{
  const Height<D> height(c);
  Vec sum = hn::Zero(Tag());
  ball.forEach([&](Vec weight, Vec u, Vec v, Vec w) HWY_ATTR {
    const Vec f = hn::Sub(w, height(u, v));
    sum = hn::MulAdd(hn::Mul(weight, f), f, sum);
  });
  return sumLanes(sum);
}

/** Adds what the slopes ask for beyond those of c to the right-hand side: slope_weight times
 * sum W (s_u - h_u) d_u m_k + W (s_v - h_v) d_v m_k. \return their weighted sum of squares. */
template <int D, WeightKernel K>
HWY_NOINLINE double
addSlopeSums(const WeightedBall<K>& ball, const double* c, double* b)
{
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
        ball.slopes(along_u), [&](Vec u, Vec v, Vec s) HWY_ATTR { return hn::Sub(s, known(u, v)); },
        sums, squares);
    eachTerm([&](int k, int derived, int power) { b[k] += weight * power * sums[derived]; });
    missed += weight * squares;
  }
  return missed;
}

/** Highest degree with all its pivots and enough support; 0 if not even a plane has. */
int
supportedDegree(int degree, int pivots, double n_eff, double support)
{
  while (degree > 0 &&
         (numCoefficients(degree) > pivots || n_eff < support * numCoefficients(degree))) {
    --degree;
  }
  return degree;
}

template <int D, WeightKernel K>
LocalFit
fitWith(const BallBuffer& points, float rho, double support, bool refine)
{
  LocalFit fit;
  fit.kernel = K;
  const WeightedBall<K> ball(points, rho);
  Moments m;
  computeMoments<D, K>(ball, m);
  const double weight = m.uv[0];
  const bool slopes = points.slope_weight > 0;
  Moments of_slopes;
  if (slopes) {
    slopeMoments<D, K>(ball, of_slopes);
    addSlopeSums<D, K>(ball, fit.c.data(), m.z);
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
    residualSums<D, K>(ball, fit.c.data(), b, ff);
    if (slopes) addSlopeSums<D, K>(ball, fit.c.data(), b);
    equations.solveAndAdd(size, b, fit.c.data());
    fit.least_pivot = equations.leastPivot(size);
  }
  if (refine || slopes || rss < FloatLimits::kResidual * m.zz)
    rss = residualSum<D, K>(ball, fit.c.data());
  fit.residual_sq = std::max(0.0, rss / weight);
  fit.terms = slopes ? equations.heightTerms(size, m.uv) : size;
  if (slopes) {
    double unused[kMaxCoefficients] = {};
    fit.slope_misfit = addSlopeSums<D, K>(ball, fit.c.data(), unused) / weight;
  }
  fit.slope_sq = meanSlopeSq<D>(m.uv, fit.c.data());
  return fit;
}

template <WeightKernel K>
double
effectiveCountOf(const BallBuffer& points, float rho)
{
  Vec sum = hn::Zero(Tag()), squares = sum;
  WeightedBall<K>(points, rho).forEach([&](Vec weight, Vec, Vec, Vec) HWY_ATTR {
    sum = hn::Add(sum, weight);
    squares = hn::MulAdd(weight, weight, squares);
  });
  const double weight = sumLanes(sum), weight_sq = sumLanes(squares);
  return weight_sq > 0.0 ? weight * weight / weight_sq : 0.0;
}

double
effectiveCount(const BallBuffer& ball, float rho, WeightKernel kernel)
{
  switch (kernel) {
    case WeightKernel::kPower2: return effectiveCountOf<WeightKernel::kPower2>(ball, rho);
    case WeightKernel::kPower4: return effectiveCountOf<WeightKernel::kPower4>(ball, rho);
    default: return effectiveCountOf<WeightKernel::kGaussian>(ball, rho);
  }
}

template <WeightKernel K>
LocalFit
fitWithKernel(const BallBuffer& ball, int degree, float rho, double support, bool refine)
{
  switch (degree) {
    case 1: return fitWith<1, K>(ball, rho, support, refine);
    case 2: return fitWith<2, K>(ball, rho, support, refine);
    case 3: return fitWith<3, K>(ball, rho, support, refine);
    default: return fitWith<4, K>(ball, rho, support, refine);
  }
}

LocalFit
fitBall(const BallBuffer& ball, int degree, float rho, WeightKernel kernel, double support,
        bool refine)
{
  switch (kernel) {
    case WeightKernel::kPower2:
      return fitWithKernel<WeightKernel::kPower2>(ball, degree, rho, support, refine);
    case WeightKernel::kPower4:
      return fitWithKernel<WeightKernel::kPower4>(ball, degree, rho, support, refine);
    default: return fitWithKernel<WeightKernel::kGaussian>(ball, degree, rho, support, refine);
  }
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(fitBall);
HWY_EXPORT(effectiveCount);

double
effectiveCount(const BallBuffer& ball, float rho, WeightKernel kernel)
{
  return HWY_DYNAMIC_DISPATCH(effectiveCount)(ball, rho, kernel);
}

LocalFit
fitBall(const BallBuffer& ball, int degree, float rho, WeightKernel kernel, double support,
        bool refine)
{
  return HWY_DYNAMIC_DISPATCH(fitBall)(ball, degree, rho, kernel, support, refine);
}

}  // namespace pcl_slim::detail::kernels
#endif

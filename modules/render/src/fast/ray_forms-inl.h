// SPDX-License-Identifier: BSD-3-Clause
// A leaf's polynomial in the coordinates of a frame's rays (FrameLeaf), many leaves at once. The
// guard toggles: Highway compiles a kernel file once per instruction set.
#if defined(PCL_SLIM_RAY_FORMS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_RAY_FORMS_INL
#undef PCL_SLIM_RAY_FORMS_INL
#else
#define PCL_SLIM_RAY_FORMS_INL
#endif

#include <array>

#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/** F = m^D f / r as sum_i sigma^i A_i(X, Y). */
template <int D>
class RayForm {
 public:
  using Axis = std::array<Vec, 3>;

  RayForm(const Axis& u, const Axis& v, const Axis& w, Vec xc, Vec yc, Vec eps)
      : u_(u), v_(v), w_(w), eps_(eps)
  {
    uc_ = slope(u, xc, yc);
    vc_ = slope(v, xc, yc);
    wc_ = slope(w, xc, yc);
  }

  /** \param[in] c coefficient k of the height polynomial. */
  template <typename Coefficient>
  HWY_INLINE void build(const Coefficient& c)
  {
    // f = w - c0 - c1 u - c2 v - ..., times m: every point of the ball divides by m once.
    const Vec c0 = c(0), c1 = c(1), c2 = c(2);
    a_[0][0] = hn::Neg(c0);
    a_[0][1] = hn::NegMulAdd(c1, u_[0], hn::NegMulAdd(c2, v_[0], w_[0]));
    a_[0][2] = hn::NegMulAdd(c1, u_[1], hn::NegMulAdd(c2, v_[1], w_[1]));
    a_[1][0] = hn::MulAdd(c0, eps_, hn::NegMulAdd(c1, uc_, hn::NegMulAdd(c2, vc_, wc_)));
    unrolled<D - 1>([&](auto step) HWY_ATTR {
      multiplyByM<2 + step()>();
      subtractForm<2 + step()>(c);
    });
  }

  /** The k-th coefficient, A_0's first. */
  HWY_INLINE Vec coefficient(int k) const
  {
    int i = 0;
    for (int n = numCoefficients(D); k >= n; n = numCoefficients(D - i)) {
      k -= n;
      ++i;
    }
    return a_[i][k];
  }

 private:
  HWY_INLINE Vec slope(const Axis& a, Vec xc, Vec yc) const
  {
    return hn::MulAdd(a[0], xc, hn::MulAdd(a[1], yc, a[2]));
  }

  /** Raises the degree to N: F <- (1 - eps sigma) F. */
  template <int N>
  HWY_INLINE void multiplyByM()
  {
    // From the highest power down, so that each step reads what is still unchanged.
    for (int i = N; i >= 0; --i) {
      const int old = i <= N - 1 ? numCoefficients(N - 1 - i) : 0;
      const int size = numCoefficients(N - i);
      for (int k = 0; k < size; ++k) {
        const Vec kept = k < old ? a_[i][k] : hn::Zero(Tag());
        a_[i][k] = i > 0 ? hn::NegMulAdd(eps_, a_[i - 1][k], kept) : kept;
      }
    }
  }

  /** F <- F - h_N(U, V), the form of degree N, by its polar forms. */
  template <int N, typename Coefficient>
  HWY_INLINE void subtractForm(const Coefficient& c)
  {
    Vec g[N + 1];
    for (int j = 0; j <= N; ++j) g[j] = c(numCoefficients(N - 1) + j);
    unrolled<N + 1>([&](auto step) HWY_ATTR {
      constexpr int kDegree = N - step();
      subtractTurned<kDegree>(g, a_[step()]);
      if constexpr (kDegree > 0) {
        const Vec share = hn::Set(Tag(), 1.0f / static_cast<float>(step() + 1));
        for (int j = 0; j < kDegree; ++j) {
          const Vec by_u = hn::Mul(hn::Set(Tag(), static_cast<float>(kDegree - j)), g[j]);
          const Vec by_v = hn::Mul(hn::Set(Tag(), static_cast<float>(j + 1)), g[j + 1]);
          g[j] = hn::Mul(share, hn::MulAdd(uc_, by_u, hn::Mul(vc_, by_v)));
        }
      }
    });
  }

  /** Subtracts the form g of degree E in (u_x X + u_y Y, v_x X + v_y Y) from target. */
  template <int E>
  HWY_INLINE void subtractTurned(const Vec* g, Vec* target) const
  {
    constexpr int kFirst = E * (E + 1) / 2;
    Vec sum[E + 1], power[E + 1];
    sum[0] = g[0];
    power[0] = hn::Set(Tag(), 1.0f);
    for (int s = 1; s <= E; ++s) {
      timesLine(u_, s, sum);
      timesLine(v_, s, power);
      for (int j = 0; j <= s; ++j) sum[j] = hn::MulAdd(g[s], power[j], sum[j]);
    }
    for (int j = 0; j <= E; ++j) target[kFirst + j] = hn::Sub(target[kFirst + j], sum[j]);
  }

  /** p <- (a_x X + a_y Y) p for a form p of degree s - 1. */
  HWY_INLINE void timesLine(const Axis& a, int s, Vec* p) const
  {
    p[s] = hn::Mul(a[1], p[s - 1]);
    for (int j = s - 1; j > 0; --j) p[j] = hn::MulAdd(a[0], p[j], hn::Mul(a[1], p[j - 1]));
    p[0] = hn::Mul(a[0], p[0]);
  }

  Axis u_, v_, w_;
  Vec eps_, uc_, vc_, wc_;
  Vec a_[D + 1][numCoefficients(D)];
};

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

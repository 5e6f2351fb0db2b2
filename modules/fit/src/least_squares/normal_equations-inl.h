// SPDX-License-Identifier: BSD-3-Clause
// The normal equations of a least-squares polynomial, by Cholesky in double. The guard toggles:
// Highway compiles a kernel file once per instruction set.
#if defined(PCL_SLIM_NORMAL_EQUATIONS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_NORMAL_EQUATIONS_INL
#undef PCL_SLIM_NORMAL_EQUATIONS_INL
#else
#define PCL_SLIM_NORMAL_EQUATIONS_INL
#endif

#include <algorithm>
#include <cmath>
#include <utility>

#include "least_squares/least_squares.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

/// Least relative pivot that sums in float can resolve (docs/theory.md, "One ball"). No tuning: it
/// follows from the format of the numbers.
constexpr double kPivot = 3e-6;

/** The factor U of the normal equations A = U^T U of degree D, with U^-T b as last column.
 *
 * Everything is unrolled, so that rows stay in registers where there are enough of them, and the
 * next pivot is brought up to date ahead of its row: square root and division follow one another
 * and little else waits for them. */
template <int D>
class NormalEquations {
 public:
  static constexpr int kSize = numCoefficients(D);

  /** Factors column by column in order of degree.
   * \param[in] uv moments u^i v^j in rows of fixed i; \param[in] z right-hand side;
   * \param[in] slopes where slopes are data, the moments up to degree 2D - 2 of their weights.
   * \return coefficients whose pivots are large enough. */
  int factor(const double* uv, const double* z, const double* slopes) {
    WideVec rows[kSize * kVectors];
    load(uv, z, slopes, rows);
    return countPivots(rows, std::make_integer_sequence<int, kSize>());
  }

  /** z^2 explained by coefficient p: residuals of nested degrees cost nothing. */
  double explained(int p) const { return rows_[p][kLast] * rows_[p][kLast]; }

  /** Solves for the first size coefficients. */
  void solve(int size, double* c) const {
    double y[kSize];
    for (int p = 0; p < size; ++p) y[p] = rows_[p][kLast];
    backSubstitute(size, y, c);
  }

  /** Adds the solution for another right-hand side b to c. */
  void solveAndAdd(int size, const double* b, double* c) const {
    double y[kSize], delta[kSize] = {};
    for (int p = 0; p < size; ++p) {
      double sum = b[p];
      for (int q = 0; q < p; ++q) sum -= rows_[q][p] * y[q];
      y[p] = sum * inverse_[p];
    }
    backSubstitute(size, y, delta);
    for (int p = 0; p < size; ++p) c[p] += delta[p];
  }

  /** The smallest of the first size pivots over its diagonal entry: about 1 over the condition of
   * the equations, scaled to a unit diagonal. */
  double leastPivot(int size) const {
    double least = 1.0;
    for (int p = 0; p < size; ++p) {
      least = std::min(least, kPivot / (inverse_[p] * inverse_[p] * least_[p]));
    }
    return least;
  }

  /** tr(M A^-1) for the moments M of heights alone: the coefficients that they decide. */
  double heightTerms(int size, const double* uv) const {
    double trace = 0;
    for (int p = 0; p < size; ++p) {
      double column[kSize], solution[kSize] = {};
      for (int q = 0; q < size; ++q) {
        column[q] = uv[momentIndex(D, kTerms[p].i + kTerms[q].i, kTerms[p].j + kTerms[q].j)];
      }
      solveAndAdd(size, column, solution);
      trace += solution[p];
    }
    return trace;
  }

 private:
  using Wide = hn::CappedTag<double, 8>;
  using WideVec = hn::Vec<Wide>;
  using One = hn::CappedTag<double, 1>;
  static constexpr int kLanes = hn::MaxLanes(Wide());
  static constexpr int kStride = 16;  ///< row length: up to 15 coefficients and the right-hand side
  static constexpr int kLast = kStride - 1;
  static constexpr int kVectors = kStride / kLanes;

  /** Whether vector k of a row has lanes on or right of its diagonal. */
  static constexpr bool holds(int row, int k) { return (k + 1) * kLanes > row; }

  HWY_INLINE void load(const double* uv, const double* z, const double* slopes, WideVec* rows) {
    const Wide d;
    unrolled<kSize * kVectors>([&](auto at) HWY_ATTR {
      constexpr int kRow = at() / kVectors, kVector = at() % kVectors;
      if constexpr (holds(kRow, kVector)) {
        Store(Zero(d), d, rows_[kRow] + kVector * kLanes);
      }
    });
    unrolled<kSize>([&](auto p) HWY_ATTR {
      unrolled<kSize - p()>([&](auto step) HWY_ATTR {
        constexpr Term kA = kTerms[p()], kB = kTerms[p() + step()];
        rows_[p()][p() + step()] = uv[momentIndex(D, kA.i + kB.i, kA.j + kB.j)];
      });
      rows_[p()][kLast] = z[p()];
    });
    if (slopes != nullptr) addSlopes(slopes);
    for (int p = 0; p < kSize; ++p) least_[p] = kPivot * rows_[p][p];
    // Once all are written: single values do not pass on to vectors before they reach the cache.
    unrolled<kSize * kVectors>([&](auto at) HWY_ATTR {
      constexpr int kRow = at() / kVectors, kVector = at() % kVectors;
      if constexpr (holds(kRow, kVector)) {
        rows[at()] = Load(d, rows_[kRow] + kVector * kLanes);
      }
    });
    pivot_ = uv[0];
  }

  /** Adds the weighted sum of d_u m_p d_u m_q + d_v m_p d_v m_q to the entry of terms p and q. */
  void addSlopes(const double* slopes) {
    for (int p = 1; p < kSize; ++p) {
      for (int q = p; q < kSize; ++q) {
        const Term a = kTerms[p], b = kTerms[q];
        const int i = a.i + b.i, j = a.j + b.j;
        if (a.i * b.i > 0) rows_[p][q] += a.i * b.i * slopes[momentIndex(D - 1, i - 2, j)];
        if (a.j * b.j > 0) rows_[p][q] += a.j * b.j * slopes[momentIndex(D - 1, i, j - 2)];
      }
    }
  }

  template <int... P>
  HWY_INLINE int countPivots(WideVec* rows, std::integer_sequence<int, P...>) {
    int count = 0;
    static_cast<void>(((eliminate<P>(rows) && ++count != 0) && ...));
    return count;
  }

  /** Scales row P and takes it off the rows below. \return false, and nothing done, for no pivot.
   */
  template <int P>
  HWY_INLINE bool eliminate(WideVec* rows) {
    const Wide d;
    if (!(pivot_ > least_[P])) return false;
    inverse_[P] = 1.0 / std::sqrt(pivot_);
    if constexpr (P + 1 < kSize) {
      // The next pivot, by the operations that its row sees below.
      const One one;
      const auto scaled = Set(one, rows_[P][P + 1]) * Set(one, inverse_[P]);
      pivot_ = GetLane(NegMulAdd(scaled, scaled, Set(one, rows_[P + 1][P + 1])));
    }
    const WideVec scale = Set(d, inverse_[P]);
    unrolled<kVectors>([&](auto k) HWY_ATTR {
      if constexpr (holds(P, k())) {
        WideVec& v = rows[P * kVectors + k()];
        v *= scale;
        Store(v, d, rows_[P] + k() * kLanes);
      }
    });
    unrolled<kSize - P - 1>([&](auto step) HWY_ATTR {
      constexpr int kRow = P + 1 + step();
      const WideVec factor = Set(d, rows_[P][kRow]);
      unrolled<kVectors>([&](auto k) HWY_ATTR {
        if constexpr (holds(kRow, k())) {
          WideVec& v = rows[kRow * kVectors + k()];
          v = NegMulAdd(factor, rows[P * kVectors + k()], v);
          // What the next two pivots are made of is read one by one when their turn comes.
          if constexpr (kRow <= P + 2) Store(v, d, rows_[kRow] + k() * kLanes);
        }
      });
    });
    return true;
  }

  HWY_INLINE void backSubstitute(int size, const double* y, double* c) const {
    if (size == kSize) {
      unrolled<kSize>([&](auto step) HWY_ATTR {
        constexpr int kRow = kSize - 1 - step();
        double sum = y[kRow];
        unrolled<step()>([&](auto q)
                             HWY_ATTR { sum -= rows_[kRow][kRow + 1 + q()] * c[kRow + 1 + q()]; });
        c[kRow] = sum * inverse_[kRow];
      });
      return;
    }
    for (int p = size - 1; p >= 0; --p) {
      double sum = y[p];
      for (int q = p + 1; q < size; ++q) sum -= rows_[p][q] * c[q];
      c[p] = sum * inverse_[p];
    }
  }

  HWY_ALIGN double rows_[kSize][kStride];
  double least_[kSize], inverse_[kSize];
  double pivot_;
};

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // PCL_SLIM_NORMAL_EQUATIONS_INL

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>

#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

/** \brief Coefficients of polynomials that are orthonormal under the weight (1 - s^2)^2 over the unit disc:
 * moving one of them moves the surface by the same RMS, whichever it is. */
class OrthonormalBasis {
 public:
  using Coefficients = std::array<double, kMaxCoefficients>;

  OrthonormalBasis()
  {
    std::array<std::array<int, 2>, kMaxCoefficients> powers{};
    std::size_t count = 0;
    for (int d = 0; d <= kMaxDegree; ++d) {
      for (int v = 0; v <= d; ++v) powers[count++] = {d - v, v};
    }
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        double sum = moment(powers[i][0] + powers[j][0], powers[i][1] + powers[j][1]);
        for (std::size_t k = 0; k < j; ++k) sum -= root_[i][k] * root_[j][k];
        root_[i][j] = i == j ? std::sqrt(sum) : sum / root_[j][j];
      }
    }
  }

  /** \brief From powers of u and v. The first n of either kind depend on each other alone. */
  Coefficients from(const Coefficients& c, std::size_t n) const
  {
    Coefficients a{};
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t i = k; i < n; ++i) a[k] += root_[i][k] * c[i];
    }
    return a;
  }

  /** \brief To powers of u and v. */
  Coefficients to(const Coefficients& a, std::size_t n) const
  {
    Coefficients c{};
    for (std::size_t k = n; k-- > 0;) {
      c[k] = a[k];
      for (std::size_t i = k + 1; i < n; ++i) c[k] -= root_[i][k] * c[i];
      c[k] /= root_[k][k];
    }
    return c;
  }

 private:
  /** Weighted mean of u^a v^b. */
  static double moment(int a, int b)
  {
    if (a % 2 != 0 || b % 2 != 0) return 0.0;
    const double n = 0.5 * (a + b);
    double mean = 6.0 / ((n + 1.0) * (n + 2.0) * (n + 3.0));
    for (int k = 1; k < a; k += 2) mean *= k;
    for (int k = 1; k < b; k += 2) mean *= k;
    for (int k = 2; k <= a + b; k += 2) mean /= k;
    return mean;
  }

  std::array<std::array<double, kMaxCoefficients>, kMaxCoefficients>
      root_{};  ///< Cholesky's, of moments
};

/** \brief A positive number as a whole number of shares of an octave; 0 has the code of kLeast octaves. */
struct LogCode {
  static constexpr double kLeast = -80.0;
  double steps;  ///< an octave

  std::int64_t code(double value) const
  {
    return value > 0.0 ? std::llround(steps * std::max(kLeast, std::log2(value)))
                       : std::llround(steps * kLeast);
  }

  double value(std::int64_t code) const
  {
    const double octaves = static_cast<double>(code) / steps;
    return octaves > kLeast ? std::exp2(octaves) : 0.0;
  }
};

}  // namespace pcl_slim::detail

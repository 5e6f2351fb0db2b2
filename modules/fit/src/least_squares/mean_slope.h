// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>

#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail::kernels {

/** \brief u^i v^j. */
struct Term {
  int i, j;
};

constexpr Term kTerms[kMaxCoefficients] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1},
                                           {0, 2}, {3, 0}, {2, 1}, {1, 2}, {0, 3},
                                           {4, 0}, {3, 1}, {2, 2}, {1, 3}, {0, 4}};

/** \brief Place of u^i v^j among a polynomial's coefficients. */
constexpr int
termIndex(int i, int j)
{
  return (i + j) * (i + j + 1) / 2 + j;
}

/** \brief Place of u^i v^j among the moments up to degree 2D: rows of fixed i. */
constexpr int
momentIndex(int degree, int i, int j)
{
  return i * (2 * degree + 1) - i * (i - 1) / 2 + j;
}

/** Moments that the products of two terms of degree below D meet, the upper triangle by rows. */
template <int D>
constexpr auto
slopeMoments()
{
  constexpr int kTermsOfSlope = numCoefficients(D - 1);
  std::array<int, kTermsOfSlope*(kTermsOfSlope + 1) / 2> at{};
  int next = 0;
  for (int p = 0; p < kTermsOfSlope; ++p) {
    for (int q = p; q < kTermsOfSlope; ++q) {
      at[next++] = momentIndex(D, kTerms[p].i + kTerms[q].i, kTerms[p].j + kTerms[q].j);
    }
  }
  return at;
}

/** \brief Weighted mean of |grad h|^2 over a ball: the slope's square is a polynomial of degree
 * 2D - 2, so the moments of the normal equations give its mean. moments[0] is the sum of weights.
 */
template <int D>
double
meanSlopeSq(const double* moments, const double* c)
{
  constexpr int kTermsOfSlope = numCoefficients(D - 1);
  static constexpr auto kAt = slopeMoments<D>();
  double du[kTermsOfSlope] = {}, dv[kTermsOfSlope] = {};
  for (int k = 1; k < numCoefficients(D); ++k) {
    const auto [i, j] = kTerms[k];
    if (i > 0) du[termIndex(i - 1, j)] = i * c[k];
    if (j > 0) dv[termIndex(i, j - 1)] = j * c[k];
  }
  double sum = 0;
  for (int p = 0, k = 0; p < kTermsOfSlope; ++p) {
    double row = 0.5 * (du[p] * du[p] + dv[p] * dv[p]) * moments[kAt[k++]];
    for (int q = p + 1; q < kTermsOfSlope; ++q) {
      row += (du[p] * du[q] + dv[p] * dv[q]) * moments[kAt[k++]];
    }
    sum += 2.0 * row;
  }
  return std::max(0.0, sum / moments[0]);
}

/** \brief The same for a degree known at run time. */
inline double
meanSlopeSq(int degree, const double* moments, const double* c)
{
  switch (degree) {
    case 1: return meanSlopeSq<1>(moments, c);
    case 2: return meanSlopeSq<2>(moments, c);
    case 3: return meanSlopeSq<3>(moments, c);
    default: return meanSlopeSq<4>(moments, c);
  }
}

/** \brief Weighted mean of h^2 over a ball, likewise, for moments up to degree 2 * degree and as
 * many coefficients as a polynomial of that degree has. */
inline double
meanSquare(int degree, const double* moments, const double* c)
{
  double sum = 0;
  for (int p = 0; p < numCoefficients(degree); ++p) {
    double row = 0;
    for (int q = 0; q < numCoefficients(degree); ++q) {
      row +=
          c[q] * moments[momentIndex(degree, kTerms[p].i + kTerms[q].i, kTerms[p].j + kTerms[q].j)];
    }
    sum += c[p] * row;
  }
  return std::max(0.0, sum / moments[0]);
}

}  // namespace pcl_slim::detail::kernels

// SPDX-License-Identifier: BSD-3-Clause
// Weighted least squares of a ball's points: the fit, what follows from its moments without the
// points, and what noise adds to it on average.
#pragma once

#include <algorithm>
#include <array>

#include "pcl_slim/surface/polynomial.h"
#include "pcl_slim/surface/weight_kernel.h"

namespace pcl_slim::detail {

struct BallBuffer;
struct BiasConstants;

/** \brief A weighted least-squares polynomial and the measures the radius search needs. */
struct LocalFit {
  static constexpr int kMaxMoments = 45;

  int degree = 0;                               ///< 0: nothing could be fitted
  WeightKernel kernel = WeightKernel::kPower4;  ///< the weights it was made with
  std::array<double, kMaxCoefficients> c{};     ///< in units of the gather radius
  double residual_sq = 0;                       ///< e^2 = sum w f^2 / sum w, gather radius squared
  double n_eff = 0;                             ///< (sum w)^2 / sum w^2
  double slope_sq = 0;                          ///< mean of |grad h|^2, weights w
  double terms = 0;  ///< coefficients that the heights decide: their number, fewer with slopes
  double slope_misfit = 0;  ///< slope_weight times the mean square slope missed, like residual_sq
  bool fell_by_pivot = false;  ///< the points, not the pivots, allowed the requested degree
  double least_pivot = 1;      ///< over its diagonal entry; set for refined fits
  int moment_degree = 0;       ///< the requested degree; moments go up to twice that
  std::array<double, kMaxMoments> moments{};  ///< sum w u^i v^j, in rows of fixed i (momentIndex)
};

/** \brief The fit of a lower degree to the same points with the same weights.
 *
 * No point is looked at: its normal equations are part of the higher degree's, whose moments and
 * solution are at hand, and the least residual grows by the mean square of the two fits'
 * difference. For heights alone: slopes as data have moments of their own, which are not kept.
 * \param[in] degree below fit.degree. \return a fit of degree 0 where it cannot be solved. O(P^3).
 */
LocalFit nestedFit(const LocalFit& fit, int degree);

namespace kernels {

/** \brief Fits heights w over (u, v) with weights G(s / rho) to the points within rho.
 *
 * Minimises sum w (f^2 + slope_weight n_w |grad h - slope|^2): where normals are data, positions
 * and normals are combined by their variances (Nehab et al. 2005). Falls back to the highest lower
 * degree whose n_eff and pivots allow it. \param[in] support points n_eff needed per coefficient.
 * \param[in] refine one step of iterative refinement, for the fit that is kept. */
LocalFit fitBall(const BallBuffer& ball, int degree, float rho, WeightKernel kernel, double support,
                 bool refine);

/** \brief n_eff = (sum w)^2 / sum w^2 of the weights G(s / rho); 0 for an empty ball. */
double effectiveCount(const BallBuffer& ball, float rho, WeightKernel kernel);

/** \brief u^i v^j. */
struct Term {
  int i, j;
};

constexpr Term kTerms[kMaxCoefficients] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1},
                                           {0, 2}, {3, 0}, {2, 1}, {1, 2}, {0, 3},
                                           {4, 0}, {3, 1}, {2, 2}, {1, 3}, {0, 4}};

/** \brief Place of u^i v^j among a polynomial's coefficients. */
constexpr int termIndex(int i, int j) {
  return (i + j) * (i + j + 1) / 2 + j;
}

/** \brief Place of u^i v^j among the moments up to degree 2D: rows of fixed i. */
constexpr int momentIndex(int degree, int i, int j) {
  return i * (2 * degree + 1) - i * (i - 1) / 2 + j;
}

/** Moments that the products of two terms of degree below D meet, the upper triangle by rows. */
template <int D>
constexpr auto slopeMoments() {
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
double meanSlopeSq(const double* moments, const double* c) {
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
inline double meanSlopeSq(int degree, const double* moments, const double* c) {
  switch (degree) {
    case 1: return meanSlopeSq<1>(moments, c);
    case 2: return meanSlopeSq<2>(moments, c);
    case 3: return meanSlopeSq<3>(moments, c);
    default: return meanSlopeSq<4>(moments, c);
  }
}

/** \brief Weighted mean of h^2 over a ball, likewise, for moments up to degree 2 * degree and as
 * many coefficients as a polynomial of that degree has. */
inline double meanSquare(int degree, const double* moments, const double* c) {
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

}  // namespace kernels

/** \brief How fast weights G(s) that fall with the distance in space fall with a point's height.
 *
 * Over a plane they fall by 1 - a/2 (height / r)^2 to second order, so that noise of variance
 * lambda is seen as lambda / (1 + a lambda / r^2). \return a = 2 G(0) / (the integral of G over
 * s^2): 2 (m + 1) for (1 - s^2)^m. */
double heightTruncation(WeightKernel kernel);

/** \brief Takes back what noise does to the heights of a least-squares fit, on average.
 *
 * Points are off sideways as well: the mean height of those that end up at (u, v) is h + lambda/2
 * (h_uu + h_vv) for isotropic noise (errors in variables; waves are worn down, spheres shrink). And
 * weights fall with a point's distance in space, which favours heights near the centre's: they are
 * drawn to it by 1 / (1 + a lambda / r^2), a from heightTruncation(). O(P).
 *
 * \param[in] kernel the weights of the fit
 * \param[in] share lambda / r^2, the noise variance in units of the ball; balls that the noise
 * fills would amplify it, so no more than constants.most_share is taken back
 * \param[in,out] c numCoefficients(degree) values in units of r
 */
void undoNoiseBias(const BiasConstants& constants, WeightKernel kernel, int degree, double share,
                   float* c);

/** \brief The same for coefficients in another unit of length. \param[in] rho r in that unit */
void undoNoiseBias(const BiasConstants& constants, WeightKernel kernel, int degree, double share,
                   double rho, double* c);

}  // namespace pcl_slim::detail

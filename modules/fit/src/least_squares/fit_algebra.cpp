// SPDX-License-Identifier: BSD-3-Clause
// What follows from a fit without another look at its points: fits of lower degree, and heights
// without bias.
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>

#include "fit_constants.h"
#include "least_squares/least_squares.h"

namespace pcl_slim::detail {

namespace {

template <int Columns>
using Small = Eigen::Matrix<double, Eigen::Dynamic, Columns, 0, kMaxCoefficients,
                            Columns == 1 ? 1 : kMaxCoefficients>;

}  // namespace

LocalFit nestedFit(const LocalFit& fit, int degree) {
  const int size = numCoefficients(degree), all = numCoefficients(fit.degree);
  Small<Eigen::Dynamic> products(size, all);
  for (int p = 0; p < size; ++p) {
    for (int q = 0; q < all; ++q) {
      const auto a = kernels::kTerms[p], b = kernels::kTerms[q];
      products(p, q) = fit.moments[static_cast<std::size_t>(
          kernels::momentIndex(fit.moment_degree, a.i + b.i, a.j + b.j))];
    }
  }
  const Small<1> heights = products * Eigen::Map<const Small<1>>(fit.c.data(), all);
  const Eigen::LLT<Small<Eigen::Dynamic>> factor(products.leftCols(size));
  LocalFit low;
  if (factor.info() != Eigen::Success) return low;
  low = fit;
  low.degree = degree;
  low.terms = size;
  low.c.fill(0.0);
  Eigen::Map<Small<1>>(low.c.data(), size) = factor.solve(heights);
  auto difference = fit.c;
  for (std::size_t k = 0; k < difference.size(); ++k) difference[k] -= low.c[k];
  low.residual_sq += kernels::meanSquare(fit.moment_degree, fit.moments.data(), difference.data());
  low.slope_sq = kernels::meanSlopeSq(fit.moment_degree, fit.moments.data(), low.c.data());
  return low;
}

namespace {

/** h_uu + h_vv, a polynomial of a degree lower by two, in the same order of coefficients. */
template <typename Real>
std::array<double, kMaxCoefficients> laplacian(int degree, const Real* c) {
  std::array<double, kMaxCoefficients> sum{};
  for (int d = 2, k = numCoefficients(1); d <= degree; ++d) {
    double* low = sum.data() + (d - 2) * (d - 1) / 2;
    for (int j = 0; j <= d; ++j, ++k) {  // u^i v^j
      const int i = d - j;
      if (i >= 2) low[j] += i * (i - 1) * static_cast<double>(c[k]);
      if (j >= 2) low[j - 2] += j * (j - 1) * static_cast<double>(c[k]);
    }
  }
  return sum;
}

/** \param[in] unit_sq the square of r over the unit of c */
template <typename Real>
void undo(const BiasConstants& constants, WeightKernel kernel, int degree, double share,
          double unit_sq, Real* c) {
  share = std::min(share, constants.most_share);
  const double truncation = heightTruncation(kernel);
  const auto bend = laplacian(degree, c);
  for (int k = 0; k < numCoefficients(degree); ++k) {
    c[k] = static_cast<Real>(c[k] * (1.0 + truncation * share) - 0.5 * share * unit_sq * bend[k]);
  }
}

}  // namespace

double heightTruncation(WeightKernel kernel) {
  switch (kernel) {
    case WeightKernel::kPower2: return 6.0;
    case WeightKernel::kPower4: return 10.0;
    case WeightKernel::kPower7: return 16.0;
    // The integral is (1 - e^-2) / 8 + 32 e^-2 (1 / 160 - 1 / 384).
    default: return 16.1457;
  }
}

void undoNoiseBias(const BiasConstants& constants, WeightKernel kernel, int degree, double share,
                   float* c) {
  undo(constants, kernel, degree, share, 1.0, c);
}

void undoNoiseBias(const BiasConstants& constants, WeightKernel kernel, int degree, double share,
                   double rho, double* c) {
  undo(constants, kernel, degree, share, rho * rho, c);
}

}  // namespace pcl_slim::detail

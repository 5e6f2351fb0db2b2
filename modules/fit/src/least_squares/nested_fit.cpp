// SPDX-License-Identifier: BSD-3-Clause
#include "least_squares/nested_fit.h"

#include <Eigen/Cholesky>

#include "least_squares/mean_slope.h"

namespace pcl_slim::detail {

namespace {

template <int Columns>
using Small = Eigen::Matrix<double, Eigen::Dynamic, Columns, 0, kMaxCoefficients,
                            Columns == 1 ? 1 : kMaxCoefficients>;

}  // namespace

LocalFit
nestedFit(const LocalFit& fit, int degree)
{
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

}  // namespace pcl_slim::detail

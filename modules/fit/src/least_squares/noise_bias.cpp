// SPDX-License-Identifier: BSD-3-Clause
#include "least_squares/noise_bias.h"

#include <algorithm>
#include <array>

#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

namespace {

/** h_uu + h_vv, a polynomial of a degree lower by two, in the same order of coefficients. */
template <typename Real>
std::array<double, kMaxCoefficients>
laplacian(int degree, const Real* c)
{
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
void
undo(const BiasConstants& constants, WeightKernel kernel, int degree, double share, double unit_sq,
     Real* c)
{
  share = std::min(share, constants.most_share);
  const double truncation = heightTruncation(kernel);
  const auto bend = laplacian(degree, c);
  for (int k = 0; k < numCoefficients(degree); ++k) {
    c[k] = static_cast<Real>(c[k] * (1.0 + truncation * share) - 0.5 * share * unit_sq * bend[k]);
  }
}

}  // namespace

double
heightTruncation(WeightKernel kernel)
{
  switch (kernel) {
    case WeightKernel::kPower2: return 6.0;
    case WeightKernel::kPower4: return 10.0;
    case WeightKernel::kPower7: return 16.0;
    // The integral is (1 - e^-2) / 8 + 32 e^-2 (1 / 160 - 1 / 384).
    default: return 16.1457;
  }
}

void
undoNoiseBias(const BiasConstants& constants, WeightKernel kernel, int degree, double share,
              float* c)
{
  undo(constants, kernel, degree, share, 1.0, c);
}

void
undoNoiseBias(const BiasConstants& constants, WeightKernel kernel, int degree, double share,
              double rho, double* c)
{
  undo(constants, kernel, degree, share, rho * rho, c);
}

}  // namespace pcl_slim::detail

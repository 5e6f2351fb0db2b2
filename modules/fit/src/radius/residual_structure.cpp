// SPDX-License-Identifier: BSD-3-Clause
#include "radius/residual_structure.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

constexpr double kPerCell = 8.0;                 ///< points in a cell; more would hide fine detail
constexpr int kLeastCells = 2, kMostCells = 32;  ///< along a side
constexpr double kDiscPerSquare = 0.785;
constexpr double kTaken = 0.4;  ///< of P / n_eff: what a fit takes along, in its inner part

}  // namespace

ResidualStructure::Finding
ResidualStructure::measure(const BallBuffer& points, const LocalFit& fit, double rho,
                           double least_cell)
{
  const double squares_wanted = static_cast<double>(points.count) / (kDiscPerSquare * kPerCell);
  double cells = std::min(std::sqrt(squares_wanted), static_cast<double>(kMostCells));
  if (least_cell > 0) cells = std::min(cells, 2.0 * rho / least_cell);
  const int side = static_cast<int>(cells);
  if (side < kLeastCells) return {};
  residuals_.resize(points.count + BallBuffer::kPadding);
  kernels::ballResiduals(points, fit, residuals_.data());
  cells_.assign(static_cast<std::size_t>(side) * side, Cell{0.0f, 0.0f});

  const auto radius = static_cast<float>(rho);
  const float limit_sq = radius * radius, per_length = 0.4999f * static_cast<float>(side) / radius;
  double squares = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    if (points.s_sq[i] >= limit_sq) continue;
    const int x = static_cast<int>((points.u[i] + radius) * per_length);
    const int y = static_cast<int>((points.v[i] + radius) * per_length);
    const float f = residuals_[i];
    Cell& cell = cells_[static_cast<std::size_t>(y * side + x)];
    cell.count += 1.0f;
    cell.sum += f;
    squares += f * f;
  }
  double inside = 0, pairs = 0, products = -squares;
  for (const Cell& cell : cells_) {
    inside += cell.count;
    pairs += static_cast<double>(cell.count) * (cell.count - 1.0f);
    products += static_cast<double>(cell.sum) * cell.sum;
  }
  if (!(pairs > 0.0) || !(squares > 0.0)) return {};
  // A fit follows its points' noise, which leaves neighbouring residuals opposed.
  const double taken = kTaken * numCoefficients(fit.degree) / fit.n_eff;
  return {products / pairs * inside / squares + taken, std::sqrt(2.0 / pairs)};
}

}  // namespace pcl_slim::detail

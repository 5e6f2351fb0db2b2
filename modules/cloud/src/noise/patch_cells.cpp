// SPDX-License-Identifier: BSD-3-Clause
// docs/theory.md, "Noise that neighbours share": how many points share their errors.
#include "noise/patch_cells.h"

#include <algorithm>
#include <cmath>

#include "noise/patch_noise.h"
#include "pcl_slim/cloud/detail/noise_measurement.h"

namespace pcl_slim::detail {

namespace {

/** Sums over square cells of a patch's plane. */
class PatchCells {
 public:
  /** Cells of such a width that a disc of radius 1 contains this number. */
  explicit PatchCells(double cells)
      : side_(static_cast<int>(std::ceil(2 / std::sqrt(kDisc / cells)))),
        per_width_(1 / std::sqrt(kDisc / cells)),
        cells_(static_cast<std::size_t>(side_ * side_))
  {
  }

  void add(double u, double v, double residual)
  {
    Cell& cell = cells_[static_cast<std::size_t>(place(v) * side_ + place(u))];
    cell.count += 1;
    cell.sum += residual;
    squares_ += residual * residual;
  }

  /** The sum of products over all pairs of a cell, each with itself too, over that of squares; and
   * how many partners a point has on average. */
  double shared(double& partners) const
  {
    double products = 0, pairs = 0, points = 0;
    for (const Cell& cell : cells_) {
      products += cell.sum * cell.sum;
      pairs += cell.count * (cell.count - 1);
      points += cell.count;
    }
    partners = pairs / points;
    return products / squares_;
  }

  bool empty() const { return !(squares_ > 0); }

 private:
  static constexpr double kDisc = M_PI;

  struct Cell {
    double count = 0, sum = 0;
  };

  int place(double coordinate) const
  {
    return std::clamp(static_cast<int>((coordinate + 1) * per_width_), 0, side_ - 1);
  }

  int side_;
  double per_width_;
  std::vector<Cell> cells_;
  double squares_ = 0;
};

}  // namespace

// A cell of c x c points sees w - (w^2 - 1) / 3 c along each side of a square of w x w.
double
squareThatShares(double shared, double points)
{
  const double third = 1 / (3 * std::sqrt(points)), side = std::sqrt(std::max(1.0, shared));
  const double root = std::max(0.0, 1 - 4 * third * (side - third));
  const double width = (1 - std::sqrt(root)) / (2 * third);
  return width * width;
}

double
sharedInPatch(const PatchCubic& cubic, double num_cells)
{
  PatchCells cells(num_cells);
  const std::size_t n = cubic.places.size();
  for (std::size_t i = 0; i < n; ++i)
    cells.add(cubic.places[2][i], cubic.places[1][i], cubic.residuals[i]);
  if (cells.empty()) return -1;
  double partners;
  const double shared = cells.shared(partners);
  // The cubic follows its points, which reduces the covariance of neighbours' residuals by this share.
  const double lost = kCubicTerms * partners / static_cast<double>(n);
  return lost < 1 ? shared / (1 - lost) : -1.0;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "sides/cell_sheet.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kMost = SideConstants::kMostNeighbors;

/** A cell's neighbours: offsets of their means, numbers and covariances of their points. */
struct Neighbors {
  std::size_t count = 0;
  std::array<std::uint32_t, kMost> cells;
  std::array<Vector3, kMost> offsets;
};

/** Sums over points of cells: moments about the middle cell's mean. */
struct CellSums {
  double count = 0;
  Vector3 first{};
  std::array<double, 6> second{};

  void add(const CellMoments& cell, const Vector3& offset)
  {
    count += cell.count;
    for (std::size_t a = 0, k = 0; a < 3; ++a) {
      first[a] += cell.count * offset[a];
      for (std::size_t b = a; b < 3; ++b, ++k)
        second[k] += cell.count * (cell.covariance[k] + offset[a] * offset[b]);
    }
  }
};

/** Sets a sheet's normal and spread. \return the spread over the lesser one across the normal. */
double
setNormal(const CellSums& sums, CellSheet& sheet)
{
  const auto& s = sums.second;
  const Eigen::Vector3d mean =
      Eigen::Vector3d(sums.first[0], sums.first[1], sums.first[2]) / sums.count;
  Eigen::Matrix3d covariance;
  covariance << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
  covariance = covariance / sums.count - mean * mean.transpose();
  const double scale = std::max(covariance.trace(), std::numeric_limits<double>::min());
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
  axes.computeDirect(covariance / scale);
  const Eigen::Vector3d n = axes.eigenvectors().col(0), spreads = axes.eigenvalues().cwiseMax(0.0);
  const bool usable = n.allFinite() && n.squaredNorm() > 0.5;
  sheet.normal = usable ? Vector3{n[0], n[1], n[2]} : Vector3{0, 0, 1};
  sheet.spread = scale * spreads[0];
  return spreads[1] > 0 ? spreads[0] / spreads[1] : 1;
}

double
varianceAlong(const CellMoments& cell, const Vector3& n)
{
  const auto& s = cell.covariance;
  return n[0] * (s[0] * n[0] + 2 * (s[1] * n[1] + s[2] * n[2])) +
         n[1] * (s[3] * n[1] + 2 * s[4] * n[2]) + n[2] * s[5] * n[2];
}

/** Two-means on heights about their mean. */
struct TwoSheets {
  double above = 0, gap = 0;  ///< points above the middle, distance of the two means
  double middle = 0;
};

TwoSheets
twoMeans(const std::array<double, kMost>& heights, const std::array<double, kMost>& counts,
         std::size_t n, double total, int passes)
{
  TwoSheets two;
  for (int pass = 0; pass < passes; ++pass) {
    double above = 0, sum = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const double share = heights[k] > two.middle ? counts[k] : 0.0;
      above += share;
      sum += share * heights[k];
    }
    two.above = above;
    if (!(above > 0 && above < total)) return {};
    two.gap = sum / above + sum / (total - above);
    if (pass + 1 < passes) two.middle = 0.5 * (sum / above - sum / (total - above));
  }
  return two;
}

/** Whether one sheet is above the other, and not side by side as the faces of an edge are: their
 * middles are no farther apart across the normal than each is wide. */
bool
overlap(const SideCells& cut, const Neighbors& near, const CellSheet& sheet)
{
  CellSums sums[2];
  for (std::size_t k = 0; k < sheet.count; ++k)
    sums[sheet.isOther(k)].add(cut.cells[near.cells[k]], near.offsets[k]);
  const Vector3 between =
      subtract(scaled(sums[1].first, 1 / sums[1].count), scaled(sums[0].first, 1 / sums[0].count));
  const Vector3 across = along(between, -dot(between, sheet.normal), sheet.normal);
  double variance = 0;
  for (const CellSums& side : sums) {
    const Vector3 n = normalized(across);
    const double mean = dot(side.first, n) / side.count;
    CellMoments all;
    all.covariance = side.second;
    variance += 0.5 * (varianceAlong(all, n) / side.count - mean * mean);
  }
  return dot(across, across) < variance;
}

/** Marks the cells of another sheet, if two are apart along the normal. */
void
findOther(const SideCells& cut, const Neighbors& near, const CellSums& sums,
          const SideConstants& constants, CellSheet& sheet)
{
  std::array<double, kMost> heights, counts;
  const double mean = dot(sums.first, sheet.normal) / sums.count;
  double square = 0;
  for (std::size_t k = 0; k < sheet.count; ++k) {
    const CellMoments& cell = cut.cells[near.cells[k]];
    heights[k] = dot(near.offsets[k], sheet.normal) - mean;
    counts[k] = cell.count;
    square += cell.count * (heights[k] * heights[k] + varianceAlong(cell, sheet.normal));
  }
  const double total = sums.count;
  const TwoSheets two = twoMeans(heights, counts, sheet.count, total, constants.passes);
  const double between = two.above * (total - two.above) / total * two.gap * two.gap;
  const double within = std::max(0.0, square - between) / total;
  const double least = constants.least_side * total;
  if (!(two.above > least && total - two.above > least)) return;
  if (!(two.gap * two.gap > constants.apart * constants.apart * within)) return;
  for (std::size_t k = 1; k < sheet.count; ++k) {
    const bool other = (heights[k] > two.middle) != (heights[0] > two.middle);
    sheet.other |= static_cast<std::uint64_t>(other) << k;
  }
  if (sheet.other != 0 && !overlap(cut, near, sheet)) sheet.other = 0;
}

/** The nearest cells by their means, the cell itself first and the nearest of each neighbourhood before
 * the others. */
Neighbors
nearestCells(const SideCells& cut, std::uint32_t cell, const SideConstants& constants)
{
  std::array<std::uint32_t, SideCells::kWindow> found;
  std::array<std::uint64_t, SideCells::kWindow> order;  // squared distance, number
  const std::size_t count = cut.cellsAbout(cell, found);
  for (std::size_t k = 0; k < count; ++k) {
    const Vector3 d = subtract(cut.cells[found[k]].mean, cut.cells[cell].mean);
    const auto square = static_cast<float>(found[k] == cell ? 0.0 : dot(d, d));
    std::uint32_t bits;
    std::memcpy(&bits, &square, sizeof bits);
    order[k] = static_cast<std::uint64_t>(bits) << 32 | found[k];
  }
  std::size_t end = count;
  for (std::size_t s = constants.neighbors.size(); s-- > 0;) {
    const std::size_t nearest = constants.neighbors[s];
    if (nearest >= end) continue;
    std::nth_element(order.begin(), order.begin() + nearest, order.begin() + end);
    end = nearest;
  }
  std::nth_element(order.begin(), order.begin(), order.begin() + end);
  Neighbors near;
  near.count = std::min({count, constants.neighbors.back(), kMost});
  for (std::size_t k = 0; k < near.count; ++k) {
    near.cells[k] = static_cast<std::uint32_t>(order[k]);
    near.offsets[k] = subtract(cut.cells[near.cells[k]].mean, cut.cells[cell].mean);
  }
  return near;
}

}  // namespace

CellSheet
sheetOf(const SideCells& cut, std::uint32_t cell, const SideConstants& constants)
{
  const Neighbors near = nearestCells(cut, cell, constants);
  CellSheet best;
  double flattest = std::numeric_limits<double>::infinity();
  CellSums sums;
  std::size_t summed = 0;
  for (const std::size_t size : constants.neighbors) {
    CellSheet sheet;
    sheet.count = std::min(size, near.count);
    for (; summed < sheet.count; ++summed)
      sums.add(cut.cells[near.cells[summed]], near.offsets[summed]);
    double flatness = setNormal(sums, sheet);
    findOther(cut, near, sums, constants, sheet);
    if (sheet.other != 0) {
      CellSums sides[2];
      for (std::size_t k = 0; k < sheet.count; ++k)
        sides[sheet.isOther(k)].add(cut.cells[near.cells[k]], near.offsets[k]);
      flatness = setNormal(sides[0], sheet);
      sheet.middle = 0.5 * (dot(sides[0].first, sheet.normal) / sides[0].count +
                            dot(sides[1].first, sheet.normal) / sides[1].count);
    }
    if (flatness >= flattest) continue;
    flattest = flatness;
    best = sheet;
  }
  best.cells = near.cells;
  return best;
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include "trim/known_region.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

KnownRegion::KnownRegion(int degree, const float* c, double radius)
    : degree_(degree), c_(c), radius_(radius), highest_(0.0)
{
  double power = 1.0;
  for (int order = 0, k = 0; order <= degree; ++order, power *= radius) {
    double largest = 0.0;  // of |u^i v^j| on the circle: 1 where one of i and j is 0
    for (int j = 0; j <= order; ++j, ++k) largest += std::abs(c[k]);
    highest_ += largest * power;
  }
}

KnownRegion::Row
KnownRegion::rowAt(double v) const
{
  // Coefficients of u^0, u^1 ... in the row: those of u^i v^j times v^j.
  Row row{};
  for (int order = 0, k = 0; order <= degree_; ++order) {
    double power = 1.0;
    for (int j = 0; j <= order; ++j, ++k, power *= v) row[order - j] += c_[k] * power;
  }
  return row;
}

bool
KnownRegion::holds(const Row& row, double u, double v) const
{
  const double h = row[0] + u * (row[1] + u * (row[2] + u * (row[3] + u * row[4])));
  return u * u + v * v + h * h < radius_ * radius_;
}

/** Moves both ends of a row's cells to where the surface is in the ball: by halving, where it is so in
 * the middle of them. */
void
KnownRegion::shrink(const Row& row, double v, double cell, double middle, int& first,
                    int& last) const
{
  const auto within = [&](int x) { return holds(row, cell * (x - middle), v); };
  const int inner = (first + last) / 2;
  if (first > last || !within(inner)) {
    while (first <= last && !within(first)) ++first;
    while (first < last && !within(last)) --last;
    return;
  }
  const auto outermost = [&](int from, int end) {  // from is within
    if (within(end)) return end;
    while (std::abs(end - from) > 1) {
      const int half = (from + end) / 2;
      (within(half) ? from : end) = half;
    }
    return from;
  };
  first = outermost(inner, first);
  last = outermost(inner, last);
}

void
KnownRegion::markBeyond(double cell, double middle, BitRows& rows) const
{
  const int end = rows.side() - 1;
  const double least_sq = radius_ * radius_ - highest_ * highest_;
  const bool flat = least_sq > 0.0 && radius_ - std::sqrt(least_sq) < 0.5 * cell;
  for (int y = 0; y <= end; ++y) {
    const double v = cell * (y - middle), half_sq = radius_ * radius_ - v * v;
    if (half_sq < 0.0) {
      rows.setRun(y, 0, end);
      continue;
    }
    const double half = std::sqrt(half_sq) / cell;
    int first = std::max(0, static_cast<int>(std::ceil(middle - half)));
    int last = std::min(end, static_cast<int>(middle + half));
    if (!flat) shrink(rowAt(v), v, cell, middle, first, last);
    if (first > 0) rows.setRun(y, 0, std::min(first, end + 1) - 1);
    if (last < end) rows.setRun(y, last + 1, end);
  }
}

}  // namespace pcl_slim::detail

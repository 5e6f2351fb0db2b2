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

bool
KnownRegion::holds(double u, double v) const
{
  const double h = evaluateHeight(degree_, c_, u, v);
  return u * u + v * v + h * h < radius_ * radius_;
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
    while (!flat && first <= last && !holds(cell * (first - middle), v)) ++first;
    while (!flat && first < last && !holds(cell * (last - middle), v)) --last;
    if (first > 0) rows.setRun(y, 0, std::min(first, end + 1) - 1);
    if (last < end) rows.setRun(y, last + 1, end);
  }
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "pcl_slim/surface/polynomial.h"
#include "trim/trim.h"

namespace pcl_slim::detail {

KnownRegion::KnownRegion(int degree, const float* c, double radius)
    : degree_(degree), c_(c), radius_(radius), highest_(0.0) {
  double power = 1.0;
  for (int order = 0, k = 0; order <= degree; ++order, power *= radius) {
    double largest = 0.0;  // of |u^i v^j| on the circle: 1 where one of i and j is 0
    for (int j = 0; j <= order; ++j, ++k) largest += std::abs(c[k]);
    highest_ += largest * power;
  }
}

/** The cells of a row in the ball's middle section. */
KnownRegion::Run KnownRegion::circleRun(double v, double cell, double middle, int end) const {
  const double half_sq = radius_ * radius_ - v * v;
  if (half_sq < 0.0) return {0, -1};
  const double half = std::sqrt(half_sq) / cell;
  return {std::max(0, static_cast<int>(std::ceil(middle - half))),
          std::min(end, static_cast<int>(middle + half))};
}

namespace {

/** The first cell from a place on, in steps of one, that is in: on the way back if the place is.
 * \return beyond last if none is. */
template <typename IsIn>
int firstIn(int place, int step, int begin, int last, const IsIn& is_in) {
  if (is_in(place)) {
    while (place != begin && is_in(place - step)) place -= step;
    return place;
  }
  do {
    place += step;
  } while (place != last + step && !is_in(place));
  return place;
}

}  // namespace

/** The part of a row's run whose surface is in the ball: its ends are searched for from those of
 * the row before, nearer to the middle. */
KnownRegion::Run KnownRegion::narrowed(Run circle, Run from, double cell, double middle,
                                       double v) const {
  double row[kMaxDegree + 1] = {};  // h of this row, by powers of u
  double power = 1.0;
  for (int j = 0; j <= degree_; ++j, power *= v)
    for (int i = 0; i + j <= degree_; ++i) row[i] += c_[(i + j) * (i + j + 1) / 2 + j] * power;
  const double room_sq = radius_ * radius_ - v * v;
  const auto is_in = [&](int x) {
    const double u = cell * (x - middle);
    double h = row[degree_];
    for (int i = degree_ - 1; i >= 0; --i) h = h * u + row[i];
    return u * u + h * h < room_sq;
  };
  const int from_first = std::clamp(from.first, circle.first, circle.last);
  const int first = firstIn(from_first, 1, circle.first, circle.last, is_in);
  if (first > circle.last) return {0, -1};
  const int from_last = std::clamp(from.last, first, circle.last);
  return {first, firstIn(from_last, -1, circle.last, first, is_in)};
}

void KnownRegion::markBeyond(double cell, int middle, BitRows& rows) const {
  const double least_sq = radius_ * radius_ - highest_ * highest_;
  if (least_sq > 0.0 && radius_ - std::sqrt(least_sq) < 0.5 * cell) {
    markBeyondCircle(cell, middle, rows);
    return;
  }
  const int end = rows.side() - 1;
  for (const int step : {1, -1}) {
    Run run{middle, middle};
    for (int y = middle; y >= 0 && y <= end; y += step) {
      const double v = cell * (y - middle);
      const Run circle = circleRun(v, cell, middle, end);
      const bool none = run.last < run.first || circle.last < circle.first;
      run = none ? Run{0, -1} : narrowed(circle, run, cell, middle, v);
      rows.setAllBut(y, run.first, run.last);
    }
  }
}

void KnownRegion::markBeyondCircle(double cell, int middle, BitRows& rows) const {
  for (int y = 0; y < rows.side(); ++y) {
    const Run run = circleRun(cell * (y - middle), cell, middle, rows.side() - 1);
    rows.setAllBut(y, run.first, run.last);
  }
}

}  // namespace pcl_slim::detail

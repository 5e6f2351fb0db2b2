// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "pcl_slim/core/symmetric.h"
#include "points/point_window.h"
#include "points/splat_kernels.h"

namespace pcl_slim::detail {

/** m m. */
inline Symmetric3<double>
squared(const Symmetric3<double>& m)
{
  const auto [a, b, c, d, e, f] = m;
  return {a * a + b * b + c * c, a * b + b * d + c * e, a * c + b * e + c * f,
          b * b + d * d + e * e, b * c + d * e + e * f, c * c + e * e + f * f};
}

/** The octree's sums over a cell's points: they add up over children. */
struct CellSums {
  double count = 0;
  double position[3] = {}, position_sq = 0;  ///< sum of p, of |p|^2
  double normal[3] = {};                     ///< sum of n
  Symmetric3<double> product{};              ///< sum of n n^T
  double lab[3] = {}, lab_sq = 0;            ///< sum of Lab, of |Lab|^2

  /** The points [begin, end) of a cloud. */
  void add(const PointWindow& window, std::size_t begin, std::size_t end);

  void add(const CellSums& other)
  {
    count += other.count;
    position_sq += other.position_sq;
    lab_sq += other.lab_sq;
    for (int a = 0; a < 3; ++a) {
      position[a] += other.position[a];
      normal[a] += other.normal[a];
      lab[a] += other.lab[a];
    }
    for (std::size_t k = 0; k < 6; ++k) product[k] += other.product[k];
  }

  /** Number of points that have a normal, up to rounding. */
  double normals() const { return product[kXX] + product[kYY] + product[kZZ]; }

  /** Squared standard deviation of the colour, in squared Delta E. */
  double colorVariance() const
  {
    const double mean_sq = (lab[0] * lab[0] + lab[1] * lab[1] + lab[2] * lab[2]) / count;
    return std::max(0.0, (lab_sq - mean_sq) / count);
  }

  /** 1 - |mean normal|^2: the squared deviation of normals that share one side. */
  double orientedVariance() const
  {
    const double total = normals();
    if (!(total > 0.0)) return 0.0;
    const double sq = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
    return std::max(0.0, 1.0 - sq / (total * total));
  }

  /** det(t I - sum n n^T), times the sign that makes it positive above the largest eigenvalue. */
  double characteristic(double t) const
  {
    const double a = t - product[kXX], b = t - product[kYY], c = t - product[kZZ];
    const double d = product[kXY], e = product[kXZ], f = product[kYZ];
    return a * (b * c - f * f) - d * (d * c + f * e) - e * (d * f + b * e);
  }

  /** Largest eigenvalue of sum n n^T: Newton's steps fall towards it from the eighth root of the
   * eighth powers' sum, which is close to it already where normals agree. */
  double largestEigenvalue() const
  {
    const double total = normals();
    Symmetric3<double> m;
    for (std::size_t k = 0; k < 6; ++k) m[k] = product[k] / total;
    m = squared(squared(m));
    const double eighth = m[kXX] * m[kXX] + m[kYY] * m[kYY] + m[kZZ] * m[kZZ] +
                          2.0 * (m[kXY] * m[kXY] + m[kXZ] * m[kXZ] + m[kYZ] * m[kYZ]);
    double t = total * std::sqrt(std::sqrt(std::sqrt(eighth))) * (1.0 + 1e-15);
    for (int step = 0; step < 40; ++step) {
      const double a = t - product[kXX], b = t - product[kYY], c = t - product[kZZ];
      const double slope = a * b + b * c + a * c - product[kXY] * product[kXY] -
                           product[kXZ] * product[kXZ] - product[kYZ] * product[kYZ];
      if (!(slope > 0.0)) break;
      const double next = t - characteristic(t) / slope;
      const bool still = !(next < t - 1e-10 * t);
      t = std::min(t, next);
      if (still) break;
    }
    return t;
  }

  /** 1 - largest eigenvalue of the mean of n n^T: the same deviation whatever the signs. */
  double unorientedVariance() const
  {
    const double total = normals();
    return total > 0.0 ? std::max(0.0, 1.0 - largestEigenvalue() / total) : 0.0;
  }

  /** Whether unorientedVariance() > limit, without the eigenvalue where limit < 1/2: no other
   * eigenvalue is that large, so one value of the characteristic polynomial decides. */
  bool unorientedAbove(double limit) const
  {
    const double total = normals();
    if (limit >= 0.5) return unorientedVariance() > limit;
    return characteristic(total * (1.0 - limit)) > 1e-13 * total * total * total;
  }

  /** Mean distance between neighbours if the points spread evenly over a disc. */
  double spacing() const
  {
    const double mean_sq =
        (position[0] * position[0] + position[1] * position[1] + position[2] * position[2]) / count;
    const double trace = std::max(0.0, (position_sq - mean_sq) / count);
    return std::sqrt(2.0 * M_PI * trace / count);
  }
};

inline CellSums
sumsOf(const PointWindow& window, std::size_t begin, std::size_t end)
{
  const float* columns[PointWindow::kNumColumns];
  for (int c = 0; c < PointWindow::kNumColumns; ++c) columns[c] = window.column(c, begin);
  double s[splat_kernels::kNumSums];
  splat_kernels::sumPoints(columns, end - begin, s);
  return {static_cast<double>(end - begin),        {s[0], s[1], s[2]},    s[3], {s[4], s[5], s[6]},
          {s[7], s[8], s[9], s[10], s[11], s[12]}, {s[13], s[14], s[15]}, s[16]};
}

static_assert(sizeof(CellSums) == splat_kernels::kCellNumbers * sizeof(double));

inline void
CellSums::add(const PointWindow& window, std::size_t begin, std::size_t end)
{
  add(sumsOf(window, begin, end));
}

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "point_window.h"

namespace pcl_slim {

/** What the octree asks of a cell's points: sums that add up over children. */
struct CellSums {
  double count = 0;
  double position[3] = {}, position_sq = 0;  ///< sum of p, of |p|^2
  double normal[3] = {};                     ///< sum of n
  double product[6] = {};                    ///< sum of n n^T: xx xy xz yy yz zz
  double lab[3] = {}, lab_sq = 0;            ///< sum of Lab, of |Lab|^2

  void add(const OctreePoint& q)
  {
    count += 1;
    for (int a = 0; a < 3; ++a) position[a] += q.position[a];
    const double x = q.position[0], y = q.position[1], z = q.position[2];
    position_sq += x * x + y * y + z * z;
    const double u = q.normal[0], v = q.normal[1], w = q.normal[2];
    normal[0] += u;
    normal[1] += v;
    normal[2] += w;
    product[0] += u * u;
    product[1] += u * v;
    product[2] += u * w;
    product[3] += v * v;
    product[4] += v * w;
    product[5] += w * w;
    const double l = q.lab[0], a = q.lab[1], b = q.lab[2];
    lab[0] += l;
    lab[1] += a;
    lab[2] += b;
    lab_sq += l * l + a * a + b * b;
  }

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
    for (int k = 0; k < 6; ++k) product[k] += other.product[k];
  }

  /** Number of points that have a normal, up to rounding. */
  double normals() const { return product[0] + product[3] + product[5]; }

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
    const double a = t - product[0], b = t - product[3], c = t - product[5];
    const double d = product[1], e = product[2], f = product[4];
    return a * (b * c - f * f) - d * (d * c + f * e) - e * (d * f + b * e);
  }

  /** Largest eigenvalue of sum n n^T: Newton's steps from the trace fall towards it. */
  double largestEigenvalue() const
  {
    double t = normals();
    for (int step = 0; step < 60; ++step) {
      const double a = t - product[0], b = t - product[3], c = t - product[5];
      const double slope = a * b + b * c + a * c - product[1] * product[1] -
                           product[2] * product[2] - product[4] * product[4];
      if (!(slope > 0.0)) break;
      const double next = t - characteristic(t) / slope;
      if (!(next < t - 1e-14 * t)) break;
      t = next;
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
   * eigenvalue lies that high, so one value of the characteristic polynomial tells. */
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
    return std::sqrt(2.0 * 3.14159265358979323846 * trace / count);
  }
};

inline CellSums
sumsOf(const OctreePoint* points, std::size_t n)
{
  CellSums sums;
  for (std::size_t i = 0; i < n; ++i) sums.add(points[i]);
  return sums;
}

}  // namespace pcl_slim

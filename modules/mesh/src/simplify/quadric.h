// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "pcl_slim/core/symmetric.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** Sum of squared distances to planes, weighed: p^T A p + 2 b p + c. */
struct Quadric {
  Symmetric3<double> a{};
  Vector3 b{};
  double c = 0;

  /** Adds the plane through a place across a unit normal. */
  void addPlane(const Vector3& normal, const Vector3& place, double weight)
  {
    const double d = -dot(normal, place);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = i; j < 3; ++j) {
        a[kSymmetricEntry[i][j]] += weight * normal[i] * normal[j];
      }
      b[i] += weight * d * normal[i];
    }
    c += weight * d * d;
  }

  void add(const Quadric& other)
  {
    for (std::size_t k = 0; k < a.size(); ++k) a[k] += other.a[k];
    for (std::size_t i = 0; i < 3; ++i) b[i] += other.b[i];
    c += other.c;
  }

  double at(const Vector3& p) const
  {
    return std::max(0.0, dot(p, multiplied(a, p)) + 2 * dot(b, p) + c);
  }

  /** The place of least value. \return false where the planes do not tell one. */
  bool least(Vector3& p) const
  {
    const Vector3 x = {a[kXX], a[kXY], a[kXZ]}, y = {a[kXY], a[kYY], a[kYZ]},
                  z = {a[kXZ], a[kYZ], a[kZZ]};
    const Vector3 yz = cross(y, z), zx = cross(z, x), xy = cross(x, y);
    const double determinant = dot(x, yz), trace = a[kXX] + a[kYY] + a[kZZ];
    if (!(std::abs(determinant) > 1e-6 * trace * trace * trace)) return false;
    for (std::size_t i = 0; i < 3; ++i) {
      p[i] = -(b[0] * yz[i] + b[1] * zx[i] + b[2] * xy[i]) / determinant;
    }
    return true;
  }
};

}  // namespace pcl_slim::detail

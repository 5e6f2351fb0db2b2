// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/export.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/query/detail/polynomial_roots.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief A half line; direction has unit length. */
struct Ray {
  Vector3 origin, direction;
};

/** \brief A surfel unpacked for intersection with many rays. */
struct RaySurfel {
  Vector3 center;
  LocalFrame frame;
  double radius, inverse_radius;
  int degree;
  const float* coefficients;
  double variance_weight;  ///< factor of its weight in a blend
  TrimMap trim;            ///< where it has data

  RaySurfel(const SLIMSurface& surface, std::size_t i)
      : center{surface.cx[i], surface.cy[i], surface.cz[i]},
        frame(Vector3{surface.nx[i], surface.ny[i], surface.nz[i]}),
        radius(surface.radius[i]),
        inverse_radius(1.0 / radius),
        degree(surface.degree[i]),
        coefficients(surface.coefficientsOf(i)),
        variance_weight(surface.info.paper_mode ? 1.0 : surface.varianceWeight(i)),
        trim(surface.trimMap(i))
  {
  }
};

/** \brief Where a ray comes closest to a surfel's centre.
 *
 * Along the ray s counts in ball radii from there: t = depth + s * radius, and the ray is inside
 * the ball of relative radius rho where s^2 < rho^2 - distance_sq.
 */
struct Approach {
  double depth;        ///< t of the closest point, local units
  Vector3 point;       ///< closest point relative to the centre, in radii, world axes
  double distance_sq;  ///< its squared length

  Approach(const RaySurfel& surfel, const Ray& ray)
  {
    const Vector3 to_center = subtract(surfel.center, ray.origin);
    depth = dot(to_center, ray.direction);
    point = scaled(subtract(scaled(ray.direction, depth), to_center), surfel.inverse_radius);
    distance_sq = dot(point, point);
  }
};

/** \brief f / r along a ray as a polynomial in s of the surfel's degree.
 *
 * Its derivative is grad f . d, so a falling polynomial means the ray enters the surface from
 * the side the normal points to.
 */
struct PCL_SLIM_EXPORT RayPolynomial {
  double a[5];

  RayPolynomial(const RaySurfel& surfel, const Approach& approach, const Vector3& direction)
  {
    const LocalFrame& f = surfel.frame;
    const double u = dot(approach.point, f.u), v = dot(approach.point, f.v);
    const double du = dot(direction, f.u), dv = dot(direction, f.v);
    const float* c = surfel.coefficients;
    // Heights first: h(u + s du, v + s dv) = a0 + a1 s + ...
    a[0] = c[0] + c[1] * u + c[2] * v;
    a[1] = c[1] * du + c[2] * dv;
    a[2] = a[3] = a[4] = 0.0;
    if (surfel.degree >= 2) addQuadratic(c + 3, u, v, du, dv);
    if (surfel.degree >= 3) addCubic(c + 6, u, v, du, dv);
    if (surfel.degree >= 4) addQuartic(c + 10, u, v, du, dv);
    a[0] = dot(approach.point, f.w) - a[0];
    a[1] = dot(direction, f.w) - a[1];
    for (int i = 2; i < 5; ++i) a[i] = -a[i];
  }

  double slope(double s) const { return evaluateDerivative<4>(a, s); }

 private:
  // A form F of degree k along p + s d is sum_i s^i F_i, where F_i is its polar form with i of
  // its k arguments equal to d, counted with multiplicity.
  void addQuadratic(const float* c, double u, double v, double du, double dv)
  {
    const double gu = 2.0 * c[0] * u + c[1] * v, gv = c[1] * u + 2.0 * c[2] * v;
    a[0] += 0.5 * (gu * u + gv * v);
    a[1] += gu * du + gv * dv;
    a[2] += c[0] * du * du + c[1] * du * dv + c[2] * dv * dv;
  }

  void addCubic(const float* c, double u, double v, double du, double dv)
  {
    const auto gradient_u = [c](double x, double y) {
      return 3.0 * c[0] * x * x + 2.0 * c[1] * x * y + c[2] * y * y;
    };
    const auto gradient_v = [c](double x, double y) {
      return c[1] * x * x + 2.0 * c[2] * x * y + 3.0 * c[3] * y * y;
    };
    const double pu = gradient_u(u, v), pv = gradient_v(u, v);
    const double qu = gradient_u(du, dv), qv = gradient_v(du, dv);
    a[0] += (pu * u + pv * v) / 3.0;
    a[1] += pu * du + pv * dv;
    a[2] += qu * u + qv * v;
    a[3] += (qu * du + qv * dv) / 3.0;
  }

  void addQuartic(const float* c, double u, double v, double du, double dv)
  {
    const auto gradient_u = [c](double x, double y) {
      return 4.0 * c[0] * x * x * x + 3.0 * c[1] * x * x * y + 2.0 * c[2] * x * y * y +
             c[3] * y * y * y;
    };
    const auto gradient_v = [c](double x, double y) {
      return c[1] * x * x * x + 2.0 * c[2] * x * x * y + 3.0 * c[3] * x * y * y +
             4.0 * c[4] * y * y * y;
    };
    const double pu = gradient_u(u, v), pv = gradient_v(u, v);
    const double qu = gradient_u(du, dv), qv = gradient_v(du, dv);
    const double huu = 12.0 * c[0] * u * u + 6.0 * c[1] * u * v + 2.0 * c[2] * v * v;
    const double huv = 3.0 * c[1] * u * u + 4.0 * c[2] * u * v + 3.0 * c[3] * v * v;
    const double hvv = 2.0 * c[2] * u * u + 6.0 * c[3] * u * v + 12.0 * c[4] * v * v;
    a[0] += 0.25 * (pu * u + pv * v);
    a[1] += pu * du + pv * dv;
    a[2] += 0.5 * (huu * du * du + 2.0 * huv * du * dv + hvv * dv * dv);
    a[3] += qu * u + qv * v;
    a[4] += 0.25 * (qu * du + qv * dv);
  }
};

}  // namespace pcl_slim::detail

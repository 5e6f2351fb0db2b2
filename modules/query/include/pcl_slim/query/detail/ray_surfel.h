// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/core/export.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/leaf/detail/roots.h"
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
        trim(surface.trimMap(i)) {}
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

  Approach(const RaySurfel& surfel, const Ray& ray) {
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

  RayPolynomial(const RaySurfel& surfel, const Approach& approach, const Vector3& direction);

  double slope(double s) const { return evaluateDerivative<4>(a, s); }
};

}  // namespace pcl_slim::detail

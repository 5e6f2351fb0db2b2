// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "pcl_slim/surface/surface.h"

namespace pcl_slim::test {

/** \brief Leaves on a sphere of local radius R about a local centre, evenly spread (Fibonacci).
 *
 * Each contains the Taylor polynomial of the sphere up to the degree: in units of the ball's radius r
 * h = -(r / 2R) (u^2 + v^2) - (r^3 / 8R^3) (u^2 + v^2)^2.
 */
inline SLIMSurface sphereSurface(int degree, double sphere_radius, int count, double ball_radius,
                                 std::array<double, 3> center = {0.0, 0.0, 0.0}) {
  SLIMSurface surface;
  surface.info.degree = degree;
  surface.info.oriented = true;
  surface.resize(static_cast<std::size_t>(count));
  const double golden = 2.39996322972865332;
  for (int i = 0; i < count; ++i) {
    const auto s = static_cast<std::size_t>(i);
    const double z = 1.0 - 2.0 * (i + 0.5) / count, rho = std::sqrt(1.0 - z * z);
    const double n[3] = {rho * std::cos(golden * i), rho * std::sin(golden * i), z};
    surface.cx[s] = static_cast<float>(center[0] + sphere_radius * n[0]);
    surface.cy[s] = static_cast<float>(center[1] + sphere_radius * n[1]);
    surface.cz[s] = static_cast<float>(center[2] + sphere_radius * n[2]);
    surface.nx[s] = static_cast<float>(n[0]);
    surface.ny[s] = static_cast<float>(n[1]);
    surface.nz[s] = static_cast<float>(n[2]);
    surface.radius[s] = static_cast<float>(ball_radius);
    surface.degree[s] = static_cast<std::uint8_t>(degree);
    surface.level[s] = static_cast<std::uint8_t>(1 + i % 3);
    surface.flags[s] = kSurfelLeaf;
    float* c = surface.coefficients.data() + s * static_cast<std::size_t>(surface.stride());
    const double q = ball_radius / (2.0 * sphere_radius);
    if (degree >= 2) c[3] = c[5] = static_cast<float>(-q);
    if (degree >= 4) {
      c[10] = c[14] = static_cast<float>(-q * q * q);
      c[12] = static_cast<float>(-2.0 * q * q * q);
    }
  }
  return surface;
}

}  // namespace pcl_slim::test

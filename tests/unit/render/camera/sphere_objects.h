// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "pcl_slim/render/bounding_spheres.h"
#include "unit/render/test_surfaces.h"

/** \brief Objects of few spheres, for cameras. */
namespace pcl_slim::test {

/** \brief The sphere's leaves stretched along each axis (their polynomials do not matter here). */
inline SLIMSurface stretched(double x, double y, double z) {
  SLIMSurface surface = sphereSurface(2, 1.0, 500, 0.05);
  for (std::size_t i = 0; i < surface.size(); ++i) {
    surface.cx[i] *= static_cast<float>(x);
    surface.cy[i] *= static_cast<float>(y);
    surface.cz[i] *= static_cast<float>(z);
  }
  return surface;
}

/** The faces of a box as spheres, a point each, with outward normals; sides of it turn these
 * inward. */
inline void addBox(const std::array<double, 3>& low, const std::array<double, 3>& high,
                   double spacing, BoundingSpheres& object, float side = 1.0f) {
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
    for (const double end : {low[a], high[a]}) {
      for (double u = low[b] + 0.5 * spacing; u < high[b]; u += spacing) {
        for (double v = low[c] + 0.5 * spacing; v < high[c]; v += spacing) {
          BoundingSphere sphere{{}, static_cast<float>(spacing), {}};
          sphere.center[a] = static_cast<float>(end);
          sphere.center[b] = static_cast<float>(u);
          sphere.center[c] = static_cast<float>(v);
          sphere.normal[a] = end == low[a] ? -side : side;
          object.spheres.push_back(sphere);
        }
      }
    }
  }
}

/** Turns an object about an axis. */
inline BoundingSpheres turned(BoundingSpheres object, std::size_t axis, double degrees) {
  const auto c = static_cast<float>(std::cos(degrees * M_PI / 180)),
             s = static_cast<float>(std::sin(degrees * M_PI / 180));
  const std::size_t b = (axis + 1) % 3, d = (axis + 2) % 3;
  for (BoundingSphere& sphere : object.spheres) {
    for (auto* v : {&sphere.center, &sphere.normal}) {
      const float x = (*v)[b], y = (*v)[d];
      (*v)[b] = c * x - s * y;
      (*v)[d] = s * x + c * y;
    }
  }
  return object;
}

}  // namespace pcl_slim::test

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "pcl_slim/render/ray_tracer.h"
#include "pcl_slim/surface/surface.h"

/** \brief Surfaces of exact shapes for rays, and rays for them. */
namespace pcl_slim::test {

using Point = std::array<double, 3>;

/** \brief An oriented surface of a degree without leaves; local units are the world's. */
inline SLIMSurface emptySurface(int degree) {
  SLIMSurface surface;
  surface.info.degree = degree;
  surface.info.oriented = true;
  return surface;
}

/** \brief Adds a leaf, coefficients all 0. \return them. */
inline float* addLeaf(SLIMSurface& surface, const Point& center, const Point& normal,
                      double radius) {
  const std::size_t i = surface.size();
  surface.resize(i + 1);
  surface.cx[i] = static_cast<float>(center[0]);
  surface.cy[i] = static_cast<float>(center[1]);
  surface.cz[i] = static_cast<float>(center[2]);
  surface.nx[i] = static_cast<float>(normal[0]);
  surface.ny[i] = static_cast<float>(normal[1]);
  surface.nz[i] = static_cast<float>(normal[2]);
  surface.radius[i] = static_cast<float>(radius);
  surface.degree[i] = static_cast<std::uint8_t>(surface.info.degree);
  surface.level[i] = 1;
  surface.flags[i] = kSurfelLeaf;
  return surface.coefficients.data() + i * static_cast<std::size_t>(surface.stride());
}

/** \brief Adds flat leaves a step apart over a rectangle with a corner and two orthogonal sides. */
inline void addRectangle(SLIMSurface& surface, const Point& corner, const Point& side_a,
                         const Point& side_b, const Point& normal, double step, double radius) {
  const auto length = [](const Point& p) { return std::hypot(p[0], p[1], p[2]); };
  const int na = static_cast<int>(std::lround(length(side_a) / step));
  const int nb = static_cast<int>(std::lround(length(side_b) / step));
  for (int a = 0; a <= na; ++a) {
    for (int b = 0; b <= nb; ++b) {
      Point p = corner;
      for (std::size_t k = 0; k < 3; ++k) p[k] += side_a[k] * a / na + side_b[k] * b / nb;
      addLeaf(surface, p, normal, radius);
    }
  }
}

/** \brief A torus about the z axis as quadratic Taylor polynomials. */
inline SLIMSurface torusSurface(double major, double minor, int around, int across, double radius) {
  SLIMSurface surface = emptySurface(2);
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double phi = 2.0 * std::acos(-1.0) * (i + 0.5 * (j % 2)) / around;
      const double theta = 2.0 * std::acos(-1.0) * j / across;
      const Point n{std::cos(theta) * std::cos(phi), std::cos(theta) * std::sin(phi),
                    std::sin(theta)};
      const double rho = major + minor * std::cos(theta);
      const Point center{rho * std::cos(phi), rho * std::sin(phi), minor * std::sin(theta)};
      float* c = addLeaf(surface, center, n, radius);
      // h = -(k_theta a^2 + k_phi b^2) / 2 along the two principal directions.
      const double k_phi = std::cos(theta) / rho, k_theta = 1.0 / minor;
      const LocalFrame frame(n);
      const Point t{-std::sin(phi), std::cos(phi), 0.0};
      const double tu = t[0] * frame.u[0] + t[1] * frame.u[1] + t[2] * frame.u[2];
      const double tv = t[0] * frame.v[0] + t[1] * frame.v[1] + t[2] * frame.v[2];
      c[3] = static_cast<float>(-0.5 * radius * (k_phi * tu * tu + k_theta * tv * tv));
      c[4] = static_cast<float>(-radius * (k_phi - k_theta) * tu * tv);
      c[5] = static_cast<float>(-0.5 * radius * (k_phi * tv * tv + k_theta * tu * tu));
    }
  }
  return surface;
}

inline Point randomDirection(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Point p{normal(random), normal(random), normal(random)};
  const double l = std::hypot(p[0], p[1], p[2]);
  return {p[0] / l, p[1] / l, p[2] / l};
}

/** \brief Parameters of a frame under one white light. */
inline TraceParams litFrom(const Point& towards, double spread = 0.0) {
  TraceParams params;
  params.lights.resize(1);
  params.lights.front().towards = towards;
  params.lights.front().spread = spread;
  return params;
}

inline std::vector<WorldHit> cast(const RayTracer& tracer, const std::vector<WorldRay>& rays,
                                  VisibleSides sides = VisibleSides::kAuto) {
  std::vector<WorldHit> hits;
  const Error error = tracer.cast(rays, sides, hits);
  EXPECT_FALSE(error) << error.message;
  return hits;
}

}  // namespace pcl_slim::test

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "pcl_slim/render/camera.h"
#include "pcl_slim/splat/splat_set.h"

namespace pcl_slim::test {

using Vector = std::array<double, 3>;

inline double dotOf(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline Vector unitOf(const Vector& a) {
  const double l = std::sqrt(dotOf(a, a));
  return {a[0] / l, a[1] / l, a[2] / l};
}

inline void addDisc(SplatSet& set, const Vector& center, const Vector& normal, double radius,
                    std::uint32_t rgb) {
  const Vector n = unitOf(normal);
  float* const out[3] = {&set.x.emplace_back(), &set.y.emplace_back(), &set.z.emplace_back()};
  for (std::size_t a = 0; a < 3; ++a) *out[a] = static_cast<float>(center[a]);
  set.nx.push_back(static_cast<float>(n[0]));
  set.ny.push_back(static_cast<float>(n[1]));
  set.nz.push_back(static_cast<float>(n[2]));
  set.radius.push_back(static_cast<float>(radius));
  set.rgb.push_back(rgb);
  set.confidence.push_back(1.0f);
  set.normal_variance.push_back(0.0f);
  set.kept.push_back(static_cast<std::uint32_t>(set.kept.size()));
}

/** Discs evenly spread over a sphere about the origin (Fibonacci), of fixed random colours. */
inline SplatSet discSphere(double sphere_radius, int count, double disc_radius) {
  SplatSet set;
  std::mt19937 random(7);
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / count, rho = std::sqrt(1.0 - z * z);
    const Vector n{rho * std::cos(2.39996322972865332 * i), rho * std::sin(2.39996322972865332 * i),
                   z};
    addDisc(set, {sphere_radius * n[0], sphere_radius * n[1], sphere_radius * n[2]}, n, disc_radius,
            static_cast<std::uint32_t>(random()) & 0xffffffu);
  }
  return set;
}

/** A camera at (0, 0, 2) that looks down z; pixels are square. */
inline Camera discCamera(int width, int height, double fov = 40.0) {
  Camera camera;
  camera.position = {0.0, 0.0, 2.0};
  camera.size = {width, height};
  camera.fov = fov;
  return camera;
}

/** Unit direction of a pixel's ray of discCamera(). */
inline Vector discRay(const Camera& c, int x, int y) {
  const double half = std::tan(c.fov * std::acos(-1.0) / 360.0);
  return unitOf({(2.0 * (x + 0.5) / c.size.width - 1.0) * half * c.size.width / c.size.height,
                 (1.0 - 2.0 * (y + 0.5) / c.size.height) * half, -1.0});
}

/** Where a ray of discCamera() meets disc i's plane, relative to its centre, and how far away. */
inline Vector planeHit(const SplatSet& set, std::size_t i, const Camera& c, int x, int y,
                       double& depth) {
  const Vector d = discRay(c, x, y), n{set.nx[i], set.ny[i], set.nz[i]};
  const Vector to{set.x[i] - c.position[0], set.y[i] - c.position[1], set.z[i] - c.position[2]};
  depth = dotOf(n, to) / dotOf(n, d);
  return {depth * d[0] - to[0], depth * d[1] - to[1], depth * d[2] - to[2]};
}

}  // namespace pcl_slim::test

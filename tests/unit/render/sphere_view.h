// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pcl_slim/render/surface_renderer.h"
#include "support/lab/reference/reference_renderer.h"
#include "unit/render/test_surfaces.h"

/** \brief A camera before a sphere, and what its picture must show. */
namespace pcl_slim::test {

constexpr double kSphere = 0.25;

inline Camera frontCamera(int width = 80, int height = 60) {
  Camera camera;
  camera.position = {0.0, 0.0, 1.2};
  camera.size = {width, height};
  return camera;
}

struct Deviation {
  std::size_t covered = 0, missed = 0, extra = 0;
  double depth = 0.0, normal = 0.0, mean = 0.0, gaussian = 0.0;
};

/** \brief Unit direction of a pixel's ray, computed here on its own. */
inline std::array<double, 3> rayDirection(const Camera& c, int x, int y) {
  const auto cross = [](const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return std::array<double, 3>{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                                 a[0] * b[1] - a[1] * b[0]};
  };
  const auto unit = [](std::array<double, 3> a) {
    const double l = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    return std::array<double, 3>{a[0] / l, a[1] / l, a[2] / l};
  };
  const auto f = unit(
      {c.look_at[0] - c.position[0], c.look_at[1] - c.position[1], c.look_at[2] - c.position[2]});
  const auto r = unit(cross(f, c.up)), u = cross(r, f);
  const double half = std::tan(c.fov * std::acos(-1.0) / 360.0);
  const double px = (2.0 * (x + 0.5) / c.size.width - 1.0) * half * c.size.width / c.size.height;
  const double py = (1.0 - 2.0 * (y + 0.5) / c.size.height) * half;
  return unit(
      {f[0] + px * r[0] + py * u[0], f[1] + px * r[1] + py * u[1], f[2] + px * r[2] + py * u[2]});
}

/** \brief Compares a buffer with the analytic sphere of world radius R about the world's origin.
 * Rays that pass within 4 % of the silhouette count as neither hit nor miss. */
inline Deviation compareWithSphere(const GBuffer& buffer, const Camera& camera, double radius,
                                   double scale = 1.0) {
  Deviation worst;
  const auto& o = camera.position;
  for (int y = 0; y < buffer.height; ++y) {
    for (int x = 0; x < buffer.width; ++x) {
      const std::size_t i = buffer.index(x, y);
      const auto d = rayDirection(camera, x, y);
      const double b = o[0] * d[0] + o[1] * d[1] + o[2] * d[2];
      const double distance_sq = o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - b * b;
      const double relative = std::sqrt(distance_sq) / radius;
      if (relative > 1.04) worst.extra += buffer.covered(i);
      if (relative > 0.96) continue;
      if (!buffer.covered(i)) {
        ++worst.missed;
        continue;
      }
      ++worst.covered;
      const double t = -b - std::sqrt(radius * radius - distance_sq);
      worst.depth = std::max(worst.depth, std::abs(buffer.depth[i] * scale - t));
      double cosine = 0.0;
      for (std::size_t k = 0; k < 3; ++k)
        cosine += buffer.normal[i][k] * (o[k] + t * d[k]) / radius;
      worst.normal = std::max(worst.normal, std::acos(std::min(1.0, cosine)));
      worst.mean = std::max(worst.mean, std::abs(buffer.mean_curvature[i] / scale * radius - 1.0));
      worst.gaussian =
          std::max(worst.gaussian,
                   std::abs(buffer.gaussian_curvature[i] / scale / scale * radius * radius - 1.0));
    }
  }
  return worst;
}

inline GBuffer rendered(const SLIMSurface& surface, const Camera& camera,
                        const RenderParams& params = {}, RenderStatistics* statistics = nullptr) {
  GBuffer buffer;
  const Error error = renderSurface(surface, camera, params, buffer, statistics);
  EXPECT_FALSE(error) << error.message;
  return buffer;
}

/** \brief The same in double, leaf by leaf and ray by ray. */
inline GBuffer referenceFrame(const SLIMSurface& surface, const Camera& camera,
                              const RenderParams& params = {},
                              RenderStatistics* statistics = nullptr) {
  GBuffer buffer;
  const Error error = lab::renderReference(surface, camera, params, buffer, statistics);
  EXPECT_FALSE(error) << error.message;
  return buffer;
}

}  // namespace pcl_slim::test

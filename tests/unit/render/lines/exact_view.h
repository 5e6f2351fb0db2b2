// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "camera/camera_rays.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/picture_lines.h"
#include "support/lab/line_truth.h"

/** \brief Exact G-buffers of analytic surfaces: what lines in pictures are measured against. */
namespace pcl_slim::test {

/** \brief An analytic surface within 1.2 of the origin, seen by a camera. */
struct ExactView {
  measure::LineSurface truth;
  Camera camera;
  GBuffer buffer;
  SLIMSurface surface;  ///< one leaf; its radius and count give the error of curvature

  explicit ExactView(const std::string& name, int width = 240, int height = 200) {
    EXPECT_TRUE(measure::parseLineSurface(name, truth));
    camera.position = {0.7, -3.0, 1.9};
    camera.up = {0, 0, 1};
    camera.fov = 36;
    camera.size = {width, height};
    surface.info.diagonal = 2.8;
    surface.info.lambda = 1e-14;
    surface.resize(1);
    surface.radius[0] = 0.1f;
    surface.effective_count[0] = 100;
  }

  measure::Jet at(const Vector3& p) const {
    using measure::Jet;
    return truth.implicit(Jet::variable(p[0], 0), Jet::variable(p[1], 1), Jet::variable(p[2], 2));
  }

  void render() {
    const detail::CameraRays rays(camera, surface.info.origin, surface.info.scale);
    buffer.resize(camera.size.width, camera.size.height);
    for (int y = 0; y < buffer.height; ++y) {
      for (int x = 0; x < buffer.width; ++x) cast(rays.ray(x, y), buffer.index(x, y));
    }
  }

 private:
  /** Steps along the ray up to the first change of sign, then bisects. */
  void cast(const detail::Ray& ray, std::size_t pixel) {
    constexpr double kStep = 0.03, kReach = 1.2;
    const double middle = -dot(ray.origin, ray.direction);
    const double half_sq = kReach * kReach - dot(ray.origin, ray.origin) + middle * middle;
    if (half_sq <= 0) return;
    const auto value = [&](double t) { return at(along(ray.origin, t, ray.direction)).value; };
    const double end = middle + std::sqrt(half_sq);
    double t = middle - std::sqrt(half_sq);
    while (t < end && value(t) > 0) t += kStep;
    if (t >= end) return;
    double near = t - kStep, far = t;
    for (int i = 0; i < 32; ++i) (value(0.5 * (near + far)) > 0 ? near : far) = 0.5 * (near + far);
    const measure::Jet jet = at(along(ray.origin, near, ray.direction));
    const double length = pcl_slim::length(jet.g);
    buffer.depth[pixel] = static_cast<float>(near);
    buffer.surfel[pixel] = 0;
    buffer.radius[pixel] = surface.radius[0];
    for (std::size_t a = 0; a < 3; ++a) {
      buffer.normal[pixel][a] = static_cast<float>(jet.g[a] / length);
      buffer.gradient[pixel][a] = static_cast<float>(jet.g[a]);
    }
    for (std::size_t k = 0; k < 6; ++k) buffer.hessian[pixel][k] = static_cast<float>(jet.h[k]);
  }
};

}  // namespace pcl_slim::test

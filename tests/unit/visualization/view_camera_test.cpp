// SPDX-License-Identifier: BSD-3-Clause
#include "frame/frame.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera/camera_rays.h"

namespace pcl_slim::test {
namespace {

using namespace detail;

Vector3 apply(const Matrix4& m, const Vector3& p, double w) {
  Vector3 out{};
  for (std::size_t i = 0; i < 3; ++i) {
    out[i] = m[4 * i] * p[0] + m[4 * i + 1] * p[1] + m[4 * i + 2] * p[2] + m[4 * i + 3] * w;
  }
  return out;
}

/** \brief A view turned about z by 30 degrees, scaled by 2 and moved; off the axis. */
GLView testView(bool parallel) {
  GLView view;
  const double c = 2.0 * std::cos(0.5236), s = 2.0 * std::sin(0.5236);
  view.model_to_view = {c, -s, 0, 0.3, s, c, 0, -0.2, 0, 0, 2, -7.0, 0, 0, 0, 1};
  view.projection = parallel
                        ? Matrix4{0.3, 0, 0, 0.1, 0, 0.4, 0, -0.05, 0, 0, -0.2, -1, 0, 0, 0, 1}
                        : Matrix4{1.5, 0, 0.1, 0, 0, 2.0, -0.05, 0, 0, 0, -1.1, -1, 0, 0, -1, 0};
  view.width = 120;
  view.height = 90;
  return view;
}

/** \brief Where a model point lands in the viewport, pixels from its upper left corner. */
std::array<double, 2> project(const GLView& view, const Vector3& point) {
  const Vector3 at = apply(view.model_to_view, point, 1.0);
  const Matrix4& p = view.projection;
  const double w = p[12] * at[0] + p[13] * at[1] + p[14] * at[2] + p[15];
  const Vector3 clip = apply(p, at, 1.0);
  return {0.5 * (clip[0] / w + 1.0) * view.width, 0.5 * (1.0 - clip[1] / w) * view.height};
}

TEST(ViewCameraTest, RaysPassThroughThePixelsOpenGLPutsTheirPointsIn) {
  for (const bool parallel : {false, true}) {
    for (const double coarseness : {1.0, 2.0, 4.0, 0.5}) {
      const GLView view = testView(parallel);
      ViewCamera result;
      ASSERT_FALSE(translateView(view, 0.5, coarseness, result));
      const CameraRays rays(result.camera, {0.0, 0.0, 0.0}, 1.0);
      for (const auto& [x, y] : {std::pair{0, 0}, std::pair{7, 11}, std::pair{20, 3}}) {
        const Ray ray = rays.ray(x, y);
        const Vector3 point = along(ray.origin, 3.7, ray.direction);
        const auto at = project(view, point);
        EXPECT_NEAR(at[0] * result.texels_x, x + 0.5, 1e-9) << parallel << coarseness;
        EXPECT_NEAR(at[1] * result.texels_y, y + 0.5, 1e-9) << parallel << coarseness;
        const Camera one = cameraOfPixel(result.camera, x, y);
        const Ray alone = CameraRays(one, {0.0, 0.0, 0.0}, 1.0).ray(0, 0);
        EXPECT_LT(length(subtract(alone.direction, ray.direction)), 1e-12);
        EXPECT_LT(length(subtract(alone.origin, ray.origin)), 1e-12);
      }
    }
  }
}

TEST(ViewCameraTest, DepthsComeBackAsViewCoordinates) {
  for (const bool parallel : {false, true}) {
    const GLView view = testView(parallel);
    ViewCamera v;
    ASSERT_FALSE(translateView(view, 0.5, 1, v));
    const Ray ray = CameraRays(v.camera, {0.0, 0.0, 0.0}, 1.0).ray(17, 23);
    const double t = 3.7;
    const Vector3 expected = apply(view.model_to_view, along(ray.origin, t, ray.direction), 1.0);
    const double x = v.x_scale * (2.0 * 17.5 / 120.0 - 1.0) + v.x_shift;
    const double y = v.y_scale * (1.0 - 2.0 * 23.5 / 90.0) + v.y_shift;
    const Vector3 direction = normalized({x, y, -1.0});
    const Vector3 at =
        parallel ? Vector3{x, y, -v.start - v.view_scale * t} : scaled(direction, v.view_scale * t);
    EXPECT_LT(length(subtract(at, expected)), 1e-9) << parallel;
  }
}

TEST(ViewCameraTest, RefusesWhatNoCameraSees) {
  ViewCamera result;
  GLView view = testView(false);
  view.model_to_view[0] *= 1.01;  // shears
  EXPECT_TRUE(translateView(view, 0.5, 1, result));
  view = testView(false);
  for (std::size_t k = 0; k < 3; ++k) view.model_to_view[k] *= -1.0;  // mirrors
  EXPECT_TRUE(translateView(view, 0.5, 1, result));
  view = testView(false);
  view.height = 0;
  EXPECT_TRUE(translateView(view, 0.5, 1, result));
}

}  // namespace
}  // namespace pcl_slim::test

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/query/detail/ray_surfel.h"
#include "pcl_slim/render/camera.h"

namespace pcl_slim::detail {

/** \brief A camera in a surface's local units, for kernels in single precision.
 *
 * A ray is p(z) = (x z, y z, z) in the camera's axes (perspective) or (x, y, z) (parallel); x and y
 * are linear in the pixel. Its points differ in their depth value D, which grows with z:
 * D = -1/z (perspective) or z (parallel).
 */
struct FrameView {
  float eye[3], eye_rest[3];  ///< the camera's position is their sum
  float right[3], up[3], forward[3];
  float pixel;               ///< length of a pixel on the plane z = 1, or anywhere if parallel
  float center_x, center_y;  ///< pixel coordinates of the optical axis
  bool perspective;
  int width, height;

  FrameView(const Camera& camera, const Vector3& origin, double scale);

  float depthValue(float z) const { return perspective ? -1.0f / z : z; }
};

/** \brief Right, up and forward axes of a valid camera, orthonormal, world axes. */
struct CameraAxes {
  Vector3 right, up, forward;

  explicit CameraAxes(const Camera& camera);
};

/** \brief Pixels [x0, x1] x [y0, y1], both ends included; empty when x0 > x1 or y0 > y1. */
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = -1, y1 = -1;

  bool empty() const { return x0 > x1 || y0 > y1; }
};

/** \brief A camera's rays in a surface's local units, and where balls land in its picture. */
class CameraRays {
 public:
  /** \brief \param[in] origin, scale of the surface: local = (world - origin) / scale */
  CameraRays(const Camera& camera, const Vector3& origin, double scale);

  Ray ray(int x, int y) const;

  /** \brief A pixel's coordinates along right and up, in the plane at depth 1 in front of a
   * perspective camera, and in any plane of another one; and a pixel's length there. */
  std::array<double, 2> inPlane(int x, int y) const {
    return {(x - center_x_) * pixel_, (center_y_ - y) * pixel_};
  }
  double pixel() const { return pixel_; }

  /** \brief Length of a pixel at a point's depth; 0 for a point behind a perspective camera. */
  double pixelLength(const Vector3& point) const;

  /** \brief pixelAtEye() + pixelPerDepth() times the distance is never less than pixelLength(). */
  double pixelAtEye() const { return perspective_ ? 0.0 : pixel_; }
  double pixelPerDepth() const { return perspective_ ? pixel_ : 0.0; }

  /** \brief Smallest depth at which a ray through the ball can meet it (negative: behind). */
  double nearestDepth(const Vector3& center, double radius) const;

  /** \brief Direction from the camera to a point, unit length, and the half angle a ball there
   * spans (0 when orthographic, pi/2 when the camera is inside). */
  Vector3 directionTo(const Vector3& point) const;
  double halfAngle(const Vector3& center, double radius) const;

  /** \brief A rectangle that contains every pixel whose ray meets the ball. Exact but for half a
   * pixel of rounding; empty when the ball is outside the picture or behind the camera. */
  PixelRect pixelsOfBall(const Vector3& center, double radius) const;

 private:
  /** \brief Range of image-plane coordinates of a disc at (offset, depth), plane at depth 1. */
  std::array<double, 2> planeRange(double offset, double depth, double radius) const;

  CameraAxes axes_;
  Vector3 eye_;
  bool perspective_;
  int width_, height_;
  double pixel_;                ///< image-plane length of a pixel
  double center_x_, center_y_;  ///< pixel coordinates of the optical axis
};

}  // namespace pcl_slim::detail

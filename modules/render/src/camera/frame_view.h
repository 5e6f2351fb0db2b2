// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/core/vector3.h"
#include "pcl_slim/render/camera.h"

namespace pcl_slim::detail {

/** \brief A camera in a surface's local units, for kernels in single precision.
 *
 * A ray is p(z) = (x z, y z, z) in the camera's axes (perspective) or (x, y, z) (parallel); x and y
 * are linear in the pixel. Its points are told apart by their depth value D, which grows with z:
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

}  // namespace pcl_slim::detail

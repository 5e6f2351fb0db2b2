// SPDX-License-Identifier: BSD-3-Clause
#include "camera/frame_view.h"

#include <cmath>

#include "camera/camera_rays.h"

namespace pcl_slim::detail {

FrameView::FrameView(const Camera& camera, const Vector3& origin, double scale)
    : perspective(camera.projection == Camera::Projection::kPerspective),
      width(camera.size.width),
      height(camera.size.height)
{
  const CameraAxes axes(camera);
  for (std::size_t a = 0; a < 3; ++a) {
    const double position = (camera.position[a] - origin[a]) / scale;
    eye[a] = static_cast<float>(position);
    eye_rest[a] = static_cast<float>(position - eye[a]);
    right[a] = static_cast<float>(axes.right[a]);
    up[a] = static_cast<float>(axes.up[a]);
    forward[a] = static_cast<float>(axes.forward[a]);
  }
  const double view_height =
      perspective ? 2.0 * std::tan(camera.fov * M_PI / 360.0) : camera.view_height / scale;
  pixel = static_cast<float>(view_height / height);
  center_x = static_cast<float>(0.5 * (width - 1) - camera.pixel_offset[0]);
  center_y = static_cast<float>(0.5 * (height - 1) - camera.pixel_offset[1]);
}

}  // namespace pcl_slim::detail

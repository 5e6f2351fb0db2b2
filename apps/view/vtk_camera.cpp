// SPDX-License-Identifier: BSD-3-Clause
#include "view/vtk_camera.h"

#include <vtkCamera.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <vector>

namespace pcl_slim {

void
setCamera(const Camera& from, vtkRenderer* renderer)
{
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->SetPosition(from.position.data());
  camera->SetFocalPoint(from.look_at.data());
  camera->SetViewUp(from.up.data());
  const bool parallel = from.projection == Camera::Projection::kOrthographic;
  camera->SetParallelProjection(parallel);
  if (parallel) {
    camera->SetParallelScale(0.5 * from.view_height);
  } else {
    camera->SetViewAngle(from.fov);
  }
  renderer->ResetCameraClippingRange();
}

void
setTurningPoint(const BoundingSpheres& object, vtkCamera* camera)
{
  std::vector<double> depths;
  const double *eye = camera->GetPosition(), *forward = camera->GetDirectionOfProjection();
  for (const BoundingSphere& sphere : object.spheres) {
    double depth = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = object.origin[k] + object.scale * double{sphere.center[k]};
      depth += (x - eye[k]) * forward[k];
    }
    depths.push_back(depth);
  }
  if (depths.empty()) return;
  // The middle of the bulk: a few strays far away do not count.
  std::sort(depths.begin(), depths.end());
  const std::size_t n = depths.size() - 1;
  const double middle = 0.5 * (depths[n / 50] + depths[n - n / 50]);
  if (middle > 0.0) camera->SetDistance(middle);
}

Camera
cameraOf(vtkRenderer* renderer)
{
  vtkCamera* from = renderer->GetActiveCamera();
  Camera camera;
  from->GetPosition(camera.position.data());
  from->GetFocalPoint(camera.look_at.data());
  from->GetViewUp(camera.up.data());
  camera.fov = from->GetViewAngle();
  if (from->GetParallelProjection()) {
    camera.projection = Camera::Projection::kOrthographic;
    camera.view_height = 2.0 * from->GetParallelScale();
  }
  return camera;
}

}  // namespace pcl_slim

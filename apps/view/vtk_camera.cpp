// SPDX-License-Identifier: BSD-3-Clause
#include "view/vtk_camera.h"

#include <vtkCamera.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <vector>

#include "render/view_request.h"

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

std::string
describeCamera(vtkRenderer* renderer)
{
  vtkCamera* camera = renderer->GetActiveCamera();
  double fov = camera->GetViewAngle();
  if (camera->GetParallelProjection()) {
    constexpr double kDegrees = 180.0 / 3.14159265358979323846;
    fov = 2.0 * kDegrees * std::atan(camera->GetParallelScale() / camera->GetDistance());
  }
  std::array<double, 10> numbers{};
  camera->GetPosition(numbers.data());
  camera->GetFocalPoint(numbers.data() + 3);
  camera->GetViewUp(numbers.data() + 6);
  numbers[9] = fov;
  std::string text;
  for (const double number : numbers) {
    char digits[32];
    std::snprintf(digits, sizeof(digits), "%.12g", number);
    text += (text.empty() ? "" : ",") + std::string(digits);
  }
  return text;
}

Error
saveCamera(const std::string& path, vtkRenderer* renderer)
{
  std::ofstream file(path);
  file << describeCamera(renderer) << "\n";
  file.close();
  if (file) return {};
  return {ErrorCode::kIo, "'" + path + "' cannot be written; give -camera_file another path"};
}

Error
loadCamera(const std::string& path, vtkRenderer* renderer)
{
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) {
    return {ErrorCode::kIo, "'" + path + "' cannot be read; save a camera with c first"};
  }
  ViewRequest request;
  request.camera = line;
  if (request.parse() || request.pose.empty()) {
    return {ErrorCode::kBadInput, "'" + path + "' holds no camera; save one with c"};
  }
  setCamera(request.cameraFor({}), renderer);
  return {};
}

}  // namespace pcl_slim

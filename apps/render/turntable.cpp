// SPDX-License-Identifier: BSD-3-Clause
#include "render/turntable.h"

#include <cstdio>

#include "pcl_slim/render/turning.h"

namespace pcl_slim {

Turntable::Turntable(const ViewRequest& request, const BoundingSpheres& object, int count)
    : count_(count)
{
  if (count == 1) {
    first_ = request.cameraFor(object);
    return;
  }
  axis_ = request.upwards(object);
  const BoundingSpheres swept = sweptAbout(object, axis_);
  pivot_ = swept.origin;
  first_ = request.cameraFor(object, swept);
}

Camera
Turntable::camera(int turn) const
{
  return turnedCamera(first_, pivot_, axis_, turn, count_);
}

std::string
Turntable::path(const std::string& path, int turn, int count)
{
  if (count == 1) return path;
  char number[16];
  std::snprintf(number, sizeof number, "_%03d", turn);
  const std::size_t dot = path.rfind('.');
  return path.substr(0, dot) + number + path.substr(dot);
}

}  // namespace pcl_slim

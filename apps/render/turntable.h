// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/render/bounding_spheres.h"
#include "pcl_slim/render/camera.h"

namespace pcl_slim {

/** \brief A camera turned about its upward axis through the object's middle by turn / count of a
 * full circle, to the right. */
Camera
turnedCamera(const Camera& camera, const BoundingSpheres& object, int turn, int count);

/** \brief OUT_000.png, OUT_001.png ... for OUT.png; OUT.png itself if there is but one. */
std::string
turntablePath(const std::string& path, int turn, int count);

}  // namespace pcl_slim

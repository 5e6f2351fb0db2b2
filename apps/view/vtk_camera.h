// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/core/error.h"
#include "pcl_slim/render/bounding_spheres.h"
#include "pcl_slim/render/camera.h"

class vtkCamera;
class vtkRenderer;

namespace pcl_slim {

/** \brief Gives a renderer's camera the place and opening of another. */
void
setCamera(const Camera& camera, vtkRenderer* renderer);

/** \brief Moves a camera's focal point along its axis to the depth of an object's middle, so that the
 * object turns in its place. O(spheres). */
void
setTurningPoint(const BoundingSpheres& object, vtkCamera* camera);

/** \brief A renderer's camera as pcl_slim_render -camera takes it: position, target, upward
 * direction and field of view, with commas between. A parallel one is given as the pinhole that
 * sees as much at its target. */
std::string
describeCamera(vtkRenderer* renderer);

Error
saveCamera(const std::string& path, vtkRenderer* renderer);

Error
loadCamera(const std::string& path, vtkRenderer* renderer);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

/** \brief A renderer's camera, but for the picture's size. */
Camera
cameraOf(vtkRenderer* renderer);

}  // namespace pcl_slim

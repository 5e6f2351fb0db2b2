// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "pcl_slim/core/error.h"
#include "view/scene/scene.h"

class vtkCamera;
class vtkRenderWindow;

namespace pcl_slim {

/** \brief "5000 leaves, mean curvature within 12.3": the status line. */
std::string
describeScene(const Scene& scene);

/** \brief The readout at the mouse: surfel, curvatures, error; empty outside of the model. */
std::string
describeUnder(const Scene& scene, vtkRenderer* renderer, int x, int y);

/** \brief Saves a window that has been drawn as a PNG file. */
Error
savePicture(vtkRenderWindow* window, const std::string& path);

/** \brief pcl_slim_view_001.png, or the first number that no file has. */
std::string
freePictureName();

/** \brief Changes between parallel and perspective projection; what is at the camera's target
 * keeps its size. */
void
toggleParallel(vtkCamera* camera);

}  // namespace pcl_slim

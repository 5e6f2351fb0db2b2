// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

class vtkRenderer;

namespace pcl_slim {

class Scene;

/** \brief "5000 leaves   mean curvature within 12.3 1/mm   h: help": the status line. */
std::string describeScene(const Scene& scene);

/** \brief The readout at a pixel of the window: leaf, curvatures, error and place, or the splat;
 * empty outside of the model. Coordinates and lengths have the decimals of decimalsFor(), curvatures
 * four significant digits. O(leaves or splats). */
std::string describeUnder(const Scene& scene, vtkRenderer* renderer, int x, int y);

}  // namespace pcl_slim

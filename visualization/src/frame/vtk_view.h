// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "frame/view_camera.h"
#include "pcl_slim/visualization/g_buffer_mapper.h"

class vtkActor;
class vtkMapper;
class vtkRenderer;

namespace pcl_slim::detail {

/** \brief An object's view in a renderer, and the distance of the near plane where it matters. */
struct VtkView {
  GLView gl;
  double near_distance = 0.0;  ///< view-space distance at which rays may begin
};

/** \brief What the renderer's camera sees of an actor through a viewport of some size.
 * \param[in] bounds of the object in its own coordinates: an object behind the near plane as a
 * whole is not cut by it, however the plane moves. */
VtkView
viewOf(vtkRenderer* renderer, vtkActor* actor, const std::array<double, 6>& bounds, int width,
       int height);

/** \brief A mapper's clipping planes (world coordinates of the scene) in the actor's own. */
std::vector<HalfSpace>
clipPlanesOf(vtkMapper* mapper, vtkActor* actor);

/** \brief Whether the window's user is moving something with the mouse just now. */
bool
isInteracting(vtkRenderer* renderer);

}  // namespace pcl_slim::detail

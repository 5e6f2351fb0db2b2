// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/core/export.h"

class vtkProperty;
class vtkRenderer;

/** \file
 * The look of pcl_slim_render's pictures for what VTK draws. GBufferMapper::setLight(kStudio) gives
 * surfaces and splats the pictures' very light; these functions give the rest of a scene what VTK's
 * lights and backgrounds have next to it.
 */
namespace pcl_slim {

/** \brief The clay of the pictures: colour and highlight. */
PCL_SLIM_EXPORT void setClayLook(vtkProperty* property);

/** \brief Lights that move with the camera: one at the viewer and a key light from the upper left.
 * Replaces the renderer's lights. */
PCL_SLIM_EXPORT void setStudioLights(vtkRenderer* renderer);

/** \brief The background of the pictures: a grey that grows lighter upwards. */
PCL_SLIM_EXPORT void setStudioBackground(vtkRenderer* renderer);

}  // namespace pcl_slim

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/render_params.h"
#include "pcl_slim/surface/surface.h"
#include "tiles/frame_rules.h"

namespace pcl_slim::detail {

/** \brief Renders a frame in double, leaf by leaf and ray by ray, in tiles of 32 x 32 pixels.
 *
 * \param[in,out] buffer of the camera's size, marked as met by nothing
 * Cost: O(leaves + sum of visible balls' pixels).
 */
void
renderReference(const SLIMSurface& surface, const Camera& camera, const FrameRules& rules,
                GBuffer& buffer, RenderStatistics& statistics);

}  // namespace pcl_slim::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/render/shading.h"

namespace pcl_slim {

/** \brief Medians over warm frames of one ray a pixel. */
struct FrameSeconds {
  double frame = 0.0;  ///< from the camera to a G-buffer with what the mode needs
  double shade = 0.0;  ///< from there to a picture
};

/** \brief Times frames after a first one that does not count; each camera is shifted by a part of a
 * pixel against the last, so that nothing repeats. \param[in] repeat at least 1 */
Result<FrameSeconds>
timeFrames(SurfaceRenderer& renderer, const Camera& camera, const RenderParams& params,
           const ShadingParams& shading, int repeat);

}  // namespace pcl_slim

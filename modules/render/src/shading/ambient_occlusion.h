// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/render/g_buffer.h"

namespace pcl_slim::detail {

/** \brief How open each covered pixel's surroundings are: 1 open, towards 0 in a hollow.
 *
 * Looks at neighbouring pixels on a fixed spiral up to a fixed share of the picture and measures
 * how far they rise over the pixel's tangent plane; neighbours much nearer to the viewer belong
 * to other parts and fade out. A depth cue, not a light simulation. O(pixels).
 */
std::vector<float>
ambientOcclusion(const GBuffer& buffer, int threads);

}  // namespace pcl_slim::detail

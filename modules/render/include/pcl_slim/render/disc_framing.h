// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/splat/splat_set.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Discs as a surface of plane leaves, one a disc: what chooseView() and fitCamera() look
 * at. Not made to be rendered as such. Normals count as oriented, so that discs which face one
 * way are seen from there. Discs must be valid (validateDiscs). O(discs). */
SLIMSurface
framingOf(const SplatSet& splats);

}  // namespace pcl_slim

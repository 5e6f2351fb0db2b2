// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/core/export.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/surface/slim_blocks.h"

namespace pcl_slim {

/** \brief Which blocks of a surface a frame with level of detail needs: not those all of whose
 * surfels are seen so small that surfels above them are drawn in their place (RenderParams::lod).
 *
 * \param[in] coarse the surfels of the block above the tiles (SlimBlock::isCoarse), with links
 * \return one value a block; true for every block where the coarse levels do not decide. O(blocks *
 * surfels of coarse). */
PCL_SLIM_EXPORT std::vector<bool> blocksOfFrame(const SlimDirectory& directory,
                                                const SLIMSurface& coarse, const Camera& camera,
                                                double lod);

}  // namespace pcl_slim
